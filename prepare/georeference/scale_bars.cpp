#include "prepare/georeference/scale_bars.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/base/text.h"
#include "prepare/bundle/entry_term.h"
#include "prepare/bundle/triangulate.h"
#include "prepare/control/fit/control_bundle.h"
#include "prepare/control/fit/mark_reading.h"
#include "prepare/georeference/number_list.h"
#include "prepare/georeference/place_by_control.h"
#include "prepare/georeference/place_problems.h"
#include "prepare/tables/text_table.h"

namespace skyquilt::prepare::georeference {
namespace {

using Eigen::Vector3d;

constexpr double kMarksAgree_px = 6.0;  // pixels of a photo of 1600 pixels width

[[noreturn]] void FailBar(const std::string& text, const std::string& found) {
  throw base::UsageError("prepare.scale_bars (--scale-bar): '" + text + "' " + found +
                         ". Give A,B,LENGTH: two labels of marks in photos, or two points x;y;z of the model, and their distance in metres, such as "
                         "door_left,door_right,0.98");
}

ScaleBar ParseBar(const std::string& text) {
  const std::vector<std::string> parts = SplitOption(text, ',');
  if (parts.size() != 3 || parts[0].empty() || parts[1].empty()) FailBar(text, "does not have the three parts A,B,LENGTH");
  ScaleBar bar{.a = parts[0], .b = parts[1]};
  const std::optional<double> length_m = tables::ParseTableNumber(parts[2], false);
  if (!length_m || !(*length_m > 0.0)) FailBar(text, "has no length above 0");
  bar.length_m = *length_m;
  if (bar.a == bar.b) FailBar(text, "has the same place twice");
  const bool points = bar.a.find(';') != std::string::npos;
  if (points != (bar.b.find(';') != std::string::npos)) FailBar(text, "has a label and a point");
  if (!points) return bar;
  bar.at_a = ParseVector(bar.a, ';');
  bar.at_b = ParseVector(bar.b, ';');
  if (!bar.at_a || !bar.at_b) FailBar(text, "has a point that is not three numbers x;y;z");
  if (!((*bar.at_a - *bar.at_b).norm() > 0.0)) FailBar(text, "has the same point twice");
  return bar;
}

const control::ControlPoint* FindLabel(const control::ControlPoints& marks, const std::string& label) {
  const auto found = std::find_if(marks.points.begin(), marks.points.end(), [&](const control::ControlPoint& point) { return point.label == label; });
  return found == marks.points.end() ? nullptr : &*found;
}

// Places of the marked points in the model's frame, in their order; nothing where fewer than two marks agree.
std::vector<std::optional<Vector3d>> PlacesOf(control::ControlPoints marks, survey::ColmapModel& model,
                                              const std::vector<input::PreparedPhoto>& photos) {
  const survey::ColmapObservations no_ties;
  const control::ControlJob as_read{.model = model, .observations = no_ties, .photos = photos, .control = marks};
  const control::MarkReading reading = control::CountReadings(as_read).Reading();
  control::Settle(reading, marks);
  control::ControlBundle marked = control::MakeControlBundle({.model = model, .observations = no_ties, .photos = photos, .control = marks});
  std::vector<std::optional<Vector3d>> places;
  for (size_t i = 0; i < marks.points.size(); ++i) {
    const uint32_t track = marked.TrackOfPoint(i);
    bundle::TriangulateTrack(marked.bundle, track, kMarksAgree_px);
    if (marked.bundle.has_point[track] != 0) bundle::RefineByMarks(marked.bundle, track);
    places.push_back(marked.bundle.has_point[track] != 0 ? std::optional(marked.bundle.point[track]) : std::nullopt);
  }
  return places;
}

double DifferenceOf(const survey::ScaleBarFit& bar) {
  return 100.0 * (bar.measured_m / bar.length_m - 1.0);
}

// Metres per unit, with the accuracy in percent.
struct BarScale {
  double scale = 1.0, sigma_percent = 0.0;
};

BarScale FitScale(const std::vector<survey::ScaleBarFit>& bars) {
  double given = 0.0, squares = 0.0;
  for (const survey::ScaleBarFit& bar : bars) {
    given += bar.measured_m * bar.length_m;
    squares += bar.measured_m * bar.measured_m;
  }
  BarScale fit{.scale = given / squares};
  double residuals = 0.0;
  for (const survey::ScaleBarFit& bar : bars) residuals += std::pow(fit.scale * bar.measured_m - bar.length_m, 2);
  const auto n = static_cast<double>(bars.size());
  const double of_residuals = n > 1.0 ? std::sqrt(residuals / (n - 1.0) / squares) / fit.scale : 0.0;
  fit.sigma_percent = std::max(100.0 * of_residuals, kLeastBarError_percent / std::sqrt(n));
  return fit;
}

std::string BarsText(const std::vector<survey::ScaleBarFit>& bars) {
  std::vector<std::string> parts;
  for (const survey::ScaleBarFit& bar : bars) {
    parts.push_back(
        fmt::format("{} to {}: {:.3f} m given, {:.3f} m here ({:+.1f} %)", bar.a, bar.b, bar.length_m, bar.measured_m, DifferenceOf(bar)));
  }
  return base::Join(parts, "; ");
}

bool Contradict(const std::vector<survey::ScaleBarFit>& bars) {
  return std::any_of(bars.begin(), bars.end(), [](const survey::ScaleBarFit& bar) { return std::abs(DifferenceOf(bar)) > kBarConflict_percent; });
}

}  // namespace

std::vector<ScaleBar> ParseScaleBars(const std::string& text) {
  std::vector<ScaleBar> bars;
  if (text.empty()) return bars;
  for (const std::string& part : SplitOption(text, '|')) bars.push_back(ParseBar(part));
  return bars;
}

control::ControlPoints ReadScaleMarks(const std::vector<ScaleBar>& bars, const control::ControlFiles& given, const control::ControlPoints& control,
                                      const std::vector<input::PhotoFile>& files) {
  const auto first = std::find_if(bars.begin(), bars.end(), [](const ScaleBar& bar) { return !bar.at_a; });
  if (first == bars.end()) return {};
  if (given.points.empty() && given.marks.empty()) {
    throw base::UsageError("prepare.scale_bars (--scale-bar) names the marks '" + first->a + "' and '" + first->b +
                           "', but there is no file of marks. Give a table image,label,x,y as prepare.gcp_marks, or two points x;y;z of the model");
  }
  const control::ControlPoints marks = given.points.empty() ? control::ReadMarkedPlaces(given.marks, PhotoSizesOf(files)) : control;
  if (given.points.empty()) {
    for (const std::string& warning : marks.warnings) base::LogWarning("{}", warning);
  }
  control::ControlPoints wanted{.file = marks.file};
  for (const ScaleBar& bar : bars) {
    if (bar.at_a) continue;
    for (const std::string* label : {&bar.a, &bar.b}) {
      const control::ControlPoint* const point = FindLabel(marks, *label);
      if (point == nullptr || point->marks.size() < 2) {
        throw base::UsageError(fmt::format("prepare.scale_bars (--scale-bar): '{}' has {} in {}. Mark it in two photos or more, or correct the label",
                                           *label, point == nullptr || point->marks.empty() ? "no mark" : "one mark only", marks.file));
      }
      if (FindLabel(wanted, *label) == nullptr) wanted.points.push_back(*point);
    }
  }
  return wanted;
}

void ApplyScaleBars(const std::vector<ScaleBar>& bars, const control::ControlPoints& marks, survey::ColmapModel& model,
                    const std::vector<input::PreparedPhoto>& photos, Georeference& georeference) {
  if (bars.empty()) return;
  const std::vector<std::optional<Vector3d>> places = PlacesOf(marks, model, photos);
  const auto place_of = [&](const std::string& label) { return places[static_cast<size_t>(FindLabel(marks, label) - marks.points.data())]; };
  std::vector<survey::ScaleBarFit> measured;
  std::vector<std::string> lost;
  for (const ScaleBar& bar : bars) {
    double length = std::numeric_limits<double>::quiet_NaN();
    if (bar.at_a && bar.at_b) {
      // Adjustments have moved the model, but its first unit is known.
      length = georeference.fit.scale * (*bar.at_a - *bar.at_b).norm();
    } else if (const auto a = place_of(bar.a), b = place_of(bar.b); a && b) {
      length = georeference.enu_from_model.scale * (*a - *b).norm();
    }
    if (length > 0.0) {
      measured.push_back({bar.a, bar.b, bar.length_m, length});
    } else {
      lost.push_back(bar.a + " to " + bar.b);
    }
  }
  if (!lost.empty()) {
    georeference.problems.push_back({"scale_bar_lost",
                                     fmt::format("{} of {} scale bars cannot be measured, because fewer than two marks of one of their ends agree in "
                                                 "photos with a pose: {}",
                                                 lost.size(), bars.size(), base::Join(lost)),
                                     "Check the marks, or mark these places in more photos; then run the same command with --restart",
                                     !georeference.ok});
  }
  if (measured.empty()) return;
  if (!georeference.ok) {
    const BarScale fit = FitScale(measured);
    for (survey::ScaleBarFit& bar : measured) bar.measured_m *= fit.scale;
    georeference.enu_from_model.scale *= fit.scale;
    georeference.enu_from_model.translation *= fit.scale;
    georeference.fit.scale *= fit.scale;
    georeference.fit.accuracy.scale_percent = fit.sigma_percent;
    SayLengthsAreMetres(&georeference.problems);
    base::LogInfo("the scale is that of {} scale bar(s), within {:.1f} %: lengths are metres. {}", measured.size(), fit.sigma_percent,
                  BarsText(measured));
  } else {
    base::LogInfo("scale bars are compared with the scale of the survey: {}", BarsText(measured));
  }
  if (Contradict(measured)) {
    georeference.problems.push_back(
        {"scale_bars_contradict",
         georeference.ok ? fmt::format("A scale bar differs from the survey by more than {:.0f} %: {}", kBarConflict_percent, BarsText(measured))
                         : fmt::format("The scale bars contradict each other by more than {:.0f} %: {}", kBarConflict_percent, BarsText(measured)),
         georeference.ok ? "Check length and marks of the bar, and the GPS tags or control points that give the scale"
                         : "Check the lengths and marks of the bars, leave a wrong one out, then run the same command with --restart",
         true});
  }
  georeference.fit.scale_bars = std::move(measured);
}

}  // namespace skyquilt::prepare::georeference
