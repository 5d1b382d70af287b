#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "core/page/figure.h"
#include "evaluate/control/tag_positions.h"
#include "evaluate/page/control_section.h"
#include "evaluate/page/drawn_map.h"
#include "evaluate/page/page_parts.h"

namespace skyquilt::evaluate::page {

namespace {

constexpr double kLongestArrow_px = 60.0;

bool HasError(const survey::ControlPointFit& point) {
  return point.error_m.head<2>().allFinite() && point.given_in_enu.head<2>().allFinite();
}

// Rejected points may be off by any amount: they must not make the other errors too small to be seen.
bool SetsTheScale(const survey::ControlPointFit& point) {
  return HasError(point) && point.use != survey::ControlUse::kRejected;
}

DrawnMap FrameOf(const survey::Survey& survey) {
  MapBounds bounds;
  for (const survey::ControlPointFit& point : survey.control.points) bounds.Include(point.given_in_enu.head<2>());
  for (const survey::Photo& photo : survey.photos) bounds.Include(photo.cam_from_enu.OriginInSource().head<2>());
  bounds.MakeRoom();
  return DrawnMap(bounds);
}

// How many times too long errors are drawn: 1, 2 or 5 times a power of ten, so that the largest one nearly is kLongestArrow_px.
double Exaggeration(const survey::ControlFit& fit, const DrawnMap& frame) {
  double largest_m = 0.0;
  for (const survey::ControlPointFit& point : fit.points) {
    if (!SetsTheScale(point)) continue;
    largest_m = std::max(largest_m, point.error_m.head<2>().norm());
    if (std::isfinite(point.error_m.z())) largest_m = std::max(largest_m, std::abs(point.error_m.z()));
  }
  if (!(largest_m > 0.0)) return 1.0;
  const double wanted = kLongestArrow_px / (largest_m * frame.scale());
  if (wanted < 1.0) return 1.0;
  const double magnitude = std::pow(10.0, std::floor(std::log10(wanted)));
  return magnitude * (wanted >= 5.0 * magnitude ? 5.0 : wanted >= 2.0 * magnitude ? 2.0 : 1.0);
}

const char* ClassOf(survey::ControlUse use) {
  switch (use) {
    case survey::ControlUse::kControl:
      return "c1";
    case survey::ControlUse::kCheck:
      return "c0";
    case survey::ControlUse::kRejected:
      return "c5";
    case survey::ControlUse::kUnseen:
      return "c6";
  }
  return "";
}

std::string Tracks(const survey::Survey& survey, const DrawnMap& frame) {
  std::string svg;
  for (const auto& [flight, photos] : control::PhotosByFlight(survey)) {
    std::vector<Eigen::Vector2d> points_px;
    for (const size_t i : photos) points_px.push_back(frame.Pixel(survey.photos[i].cam_from_enu.OriginInSource()));
    svg += TrackLine("cameras", points_px, fmt::format("Camera positions of flight {}", flight + 1));
  }
  return svg;
}

std::string Mark(const survey::ControlPointFit& point, const DrawnMap& frame, double exaggeration) {
  const Eigen::Vector2d at = frame.Pixel(point.given_in_enu);
  std::string title = EscapeHtml(point.label) + ", " + survey::NameOf(point.use);
  std::string svg;
  if (HasError(point)) {
    title += fmt::format("\nerror east {}, north {}, up {}", FormatFixed(point.error_m.x(), 3), FormatFixed(point.error_m.y(), 3),
                         FormatFixed(point.error_m.z(), 3, "m"));
    // Longer ones are cut, and dashed.
    const Eigen::Vector2d wanted = exaggeration * frame.scale() * Eigen::Vector2d(point.error_m.x(), -point.error_m.y());
    const double share = std::min(1.0, 1.2 * kLongestArrow_px / std::max(wanted.norm(), 1e-9));
    svg += fmt::format("<path{} d=\"{}\"/>", share < 1.0 ? " class=\"beyond\"" : "", ArrowPath(at, at + share * wanted));
    if (std::isfinite(point.error_m.z())) {
      const double radius_px = std::min(exaggeration * frame.scale() * std::abs(point.error_m.z()), 1.2 * kLongestArrow_px);
      svg += fmt::format("<path class=\"height{}\" d=\"M{:.1f} {:.1f}a{:.1f} {:.1f} 0 1 0 {:.1f} 0a{:.1f} {:.1f} 0 1 0 {:.1f} 0\"/>",
                         point.error_m.z() < 0.0 ? " low" : "", at.x() - radius_px, at.y(), radius_px, radius_px, 2.0 * radius_px, radius_px,
                         radius_px, -2.0 * radius_px);
    }
  }
  return fmt::format(
      "<g class=\"point {}\"><title>{}</title>{}<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\"/><text x=\"{:.1f}\" y=\"{:.1f}\">{}</text></g>",
      ClassOf(point.use), title, svg, at.x(), at.y(), at.x(), at.y() - 8.0, EscapeHtml(point.label));
}

}  // namespace

std::string ControlMap(const survey::Survey& survey) {
  const survey::ControlFit& fit = survey.control;
  if (!std::any_of(fit.points.begin(), fit.points.end(), HasError)) return "";
  const DrawnMap frame = FrameOf(survey);
  const double exaggeration = Exaggeration(fit, frame);
  std::string svg = MapFigureBegin(frame, "geo-map control-map", "Map of control points and their errors") + Tracks(survey, frame);
  for (const survey::ControlPointFit& point : fit.points) {
    if (point.given_in_enu.head<2>().allFinite()) svg += Mark(point, frame, exaggeration);
  }
  svg += ScaleBarAndNorth(frame, survey.georeferenced);
  std::string legend;
  const auto entry = [&](survey::ControlUse use, const char* name) {
    const bool any = std::any_of(fit.points.begin(), fit.points.end(), [&](const survey::ControlPointFit& point) { return point.use == use; });
    if (any) legend += LegendEntry(ClassOf(use), name);
  };
  entry(survey::ControlUse::kControl, "control points");
  entry(survey::ControlUse::kCheck, "check points");
  entry(survey::ControlUse::kRejected, "rejected");
  entry(survey::ControlUse::kUnseen, "not estimated");
  std::string note =
      "Arrows lead from the given position towards the estimated one; the radius of a ring is the error in height, dashed where the estimate is too "
      "low. Dashed arrows are cut";
  if (exaggeration > 1.0) note += fmt::format(". Errors are drawn <b>{:.0f} times too large</b>", exaggeration);
  return svg + MapFigureEnd(legend, note + ".");
}

}  // namespace skyquilt::evaluate::page
