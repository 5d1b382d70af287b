#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "core/brightness/captured_photos.h"
#include "core/page/curve_chart.h"
#include "evaluate/control/tag_positions.h"
#include "evaluate/page/geo_section.h"
#include "evaluate/page/page_parts.h"
#include "evaluate/page/time_axis.h"

namespace skyquilt::evaluate::page {

namespace {

using Tags = std::vector<std::optional<control::TagPosition>>;
using Range = std::pair<double, double>;

constexpr const char* kBeyond = "Points beyond the chart are drawn on its edge.";

TimeAxis AxisOf(const survey::Survey& survey) {
  if (!brightness::AllTimed(survey)) return AxisOfNames(survey.photos.size());
  std::vector<double> times_s;
  times_s.reserve(survey.photos.size());
  for (const survey::Photo& photo : survey.photos) times_s.push_back(*photo.time_s);
  return AxisOfTimes(times_s);
}

// The range that the chart shows: of what is used, so that one wrong tag does not squeeze all else.
struct Shown {
  double low = std::numeric_limits<double>::infinity(), high = -low;

  void Include(double value) {
    if (!std::isfinite(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  Range Padded() const {
    const double pad = std::max(0.08 * (high - low), 0.05);
    return {low - pad, high + pad};
  }
  bool Empty() const { return !(high >= low); }
};

bool AnyBeyond(const std::vector<Curve>& curves, const Range& range) {
  return std::any_of(curves.begin(), curves.end(), [&](const Curve& curve) {
    return std::any_of(curve.points.begin(), curve.points.end(), [&](const auto& p) { return p.second < range.first || p.second > range.second; });
  });
}

std::string ResidualChart(const survey::Survey& survey, const Tags& tags, const TimeAxis& axis) {
  constexpr std::array<const char*, 3> kNames = {"east", "north", "up"};
  constexpr std::array<int, 3> kColors = {1, 2, 7};
  std::vector<Curve> curves(4);
  for (size_t k = 0; k < 3; ++k) curves[k] = {.name = kNames[k], .dots = true, .color = kColors[k]};
  curves[3] = {.name = "tag not used", .dots = true, .hollow = true, .color = 6};
  Shown used, all;
  for (size_t i = 0; i < tags.size(); ++i) {
    if (!tags[i]) continue;
    for (size_t k = 0; k < 3; ++k) {
      const double value_m = tags[i]->residual[static_cast<Eigen::Index>(k)];
      curves[survey.photos[i].gps_inlier ? k : 3].points.emplace_back(axis.x[i], value_m);
      if (survey.photos[i].gps_inlier) used.Include(value_m);
      all.Include(value_m);
    }
  }
  used = used.Empty() ? all : used;
  used.Include(0.0);
  const Range range = used.Padded();
  return CurveChart(curves, {.title = "Residuals: fitted position minus corrected tag",
                             .x_label = axis.label,
                             .y_label = "residual (m)",
                             .y_range = range,
                             .zero_stands_out = true,
                             .note = AnyBeyond(curves, range) ? kBeyond : ""});
}

std::string HeightChart(const survey::Survey& survey, const Tags& tags, const TimeAxis& axis) {
  Curve recorded{.name = "tags as recorded", .dots = true, .color = 6}, corrected{.name = "corrected tags", .dots = true, .color = 2},
      unused{.name = "tag not used, as recorded", .dots = true, .hollow = true, .color = 6};
  bool any_correction = false;
  Shown shown;
  for (size_t i = 0; i < tags.size(); ++i) {
    if (!tags[i]) continue;
    if (!survey.photos[i].gps_inlier) {
      unused.points.emplace_back(axis.x[i], tags[i]->recorded.z());
      continue;
    }
    recorded.points.emplace_back(axis.x[i], tags[i]->recorded.z());
    corrected.points.emplace_back(axis.x[i], tags[i]->corrected.z());
    shown.Include(tags[i]->recorded.z());
    shown.Include(tags[i]->corrected.z());
    any_correction = any_correction || survey.photos[i].gps_correction_m.z() != 0.0;
  }
  std::vector<Curve> curves = {std::move(unused), std::move(recorded)};
  if (any_correction) curves.push_back(std::move(corrected));
  bool first = true;
  for (const auto& [flight, photos] : control::PhotosByFlight(survey)) {
    Curve cameras{.name = "fitted cameras", .color = 0, .in_legend = std::exchange(first, false)};
    for (const size_t i : photos) {
      const double up_m = survey.photos[i].cam_from_enu.OriginInSource().z();
      cameras.points.emplace_back(axis.x[i], up_m);
      shown.Include(up_m);
    }
    curves.push_back(std::move(cameras));
  }
  const Range range = shown.Padded();
  return CurveChart(curves, {.title = "Heights of tags and cameras",
                             .x_label = axis.label,
                             .y_label = "height above the origin (m)",
                             .y_range = range,
                             .note = AnyBeyond(curves, range) ? kBeyond : ""});
}

}  // namespace

std::string GeoCharts(const survey::Survey& survey) {
  const Tags tags = control::TagPositions(survey);
  if (std::none_of(tags.begin(), tags.end(), [](const auto& tag) { return tag.has_value(); })) return "";
  const TimeAxis axis = AxisOf(survey);
  return "<div class=\"chart-grid\">" + ResidualChart(survey, tags, axis) + HeightChart(survey, tags, axis) + "</div>\n";
}

}  // namespace skyquilt::evaluate::page
