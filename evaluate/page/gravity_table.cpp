#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/page/figure.h"
#include "core/page/plot_frame.h"
#include "evaluate/page/geo_section.h"
#include "evaluate/page/page_parts.h"

namespace skyquilt::evaluate::page {

namespace {

constexpr double kPlot_px = 340.0;
constexpr double kRim_px = 138.0;  // radius of the plot

struct Kind {
  const char* kind;
  const char* name;
  const char* meaning;
};
constexpr std::array<Kind, 6> kKinds = {{{"stated", "Given", "Direction that was given (prepare.up)"},
                                         {"gimbal", "Gimbal", "Gimbal angles in the tags"},
                                         {"cameras", "Cameras", "Camera axes: most cameras look straight down or are level"},
                                         {"wall", "Wall", "Plane of the points where it is about upright: up lies in it"},
                                         {"ground", "Ground", "Plane of the ground points"},
                                         {"gps_heights", "GPS heights", "Heights of the GPS tags"}}};

Kind KindOf(const survey::GravityEvidence& evidence) {
  const auto* known = std::find_if(kKinds.begin(), kKinds.end(), [&](const Kind& kind) { return evidence.kind == kind.kind; });
  return known == kKinds.end() ? Kind{"", evidence.kind.c_str(), "Other evidence"} : *known;
}

double LeanOf(const survey::GravityEvidence& evidence) {
  return std::hypot(evidence.lean_east_deg, evidence.lean_north_deg);
}

// "0.80° to the north-east"; in a local frame no direction is north.
std::string ShownLean(const survey::GravityEvidence& evidence, bool georeferenced) {
  constexpr std::array<const char*, 8> kDirections = {"east", "north-east", "north", "north-west", "west", "south-west", "south", "south-east"};
  const double lean_deg = LeanOf(evidence);
  std::string size = FormatFixed(lean_deg, 2, kDegree);
  if (!(lean_deg >= 0.005) || !georeferenced) return size;
  const double eighth = std::atan2(evidence.lean_north_deg, evidence.lean_east_deg) / (0.25 * std::numbers::pi);
  return size + " to the " + kDirections[static_cast<size_t>(std::lround(eighth) + 8) % 8];
}

// Lean at the rim: what is used shall fit with its uncertainty; the rest is drawn on the rim if it lies beyond.
double RimOf(const std::vector<survey::GravityEvidence>& gravity) {
  double reach_deg = 0.0, farthest_deg = 0.0;
  for (const survey::GravityEvidence& evidence : gravity) {
    const double lean_deg = LeanOf(evidence);
    if (!std::isfinite(lean_deg)) continue;
    farthest_deg = std::max(farthest_deg, lean_deg);
    if (evidence.weight > 0.0) reach_deg = std::max(reach_deg, lean_deg + (std::isfinite(evidence.sigma_deg) ? 0.5 * evidence.sigma_deg : 0.0));
  }
  return 1.15 * std::max({reach_deg, std::min(farthest_deg, 3.0 * reach_deg), reach_deg > 0.0 ? 0.0 : farthest_deg, 0.2});
}

// The direction of up, seen from above: the result in the middle, each kind of evidence where its up leans.
std::string TargetPlot(const std::vector<survey::GravityEvidence>& gravity, bool georeferenced) {
  constexpr double kMiddle_px = 0.5 * kPlot_px;
  const double rim_deg = RimOf(gravity);
  const double px_per_deg = kRim_px / rim_deg;
  std::string html = FigureBegin({.title = "Where each up leans",
                                  .width_px = kPlot_px,
                                  .height_px = kPlot_px,
                                  .css_class = "target",
                                  .spoken = "Direction of up by each kind of evidence, against the result in the middle"});
  html += fmt::format("<clipPath id=\"gravity-rim\"><circle cx=\"{0}\" cy=\"{0}\" r=\"{1}\"/></clipPath>", kMiddle_px, kRim_px);
  const auto ring = [&](const char* css_class, double radius_px) {
    html += fmt::format("<circle class=\"{0}\" cx=\"{1}\" cy=\"{1}\" r=\"{2:.1f}\"/>", css_class, kMiddle_px, radius_px);
  };
  html += SvgLine("grid", kMiddle_px - kRim_px, kMiddle_px + kRim_px, kMiddle_px, kMiddle_px);
  html += SvgLine("grid", kMiddle_px, kMiddle_px, kMiddle_px - kRim_px, kMiddle_px + kRim_px);
  for (const double tick : RoundTicks(0.0, rim_deg, 3)) {
    if (!(tick > 0.0)) continue;
    ring("ring", tick * px_per_deg);
    const double diagonal_px = tick * px_per_deg / std::numbers::sqrt2;
    html += SvgText("tick", kMiddle_px + diagonal_px + 2.0, kMiddle_px + diagonal_px + 9.0, Anchor::kStart, TickLabel(tick) + kDegree);
  }
  ring("rim", kRim_px);
  html += SvgText("label", kMiddle_px, kMiddle_px - kRim_px - 8.0, Anchor::kMiddle, georeferenced ? "N" : "y");
  html += SvgText("label", kMiddle_px + kRim_px + 8.0, kMiddle_px + 4.0, Anchor::kStart, georeferenced ? "E" : "x");
  std::string legend;
  for (size_t i = 0; i < gravity.size(); ++i) {
    const survey::GravityEvidence& evidence = gravity[i];
    const double lean_deg = LeanOf(evidence);
    if (!std::isfinite(lean_deg)) continue;
    const bool beyond = lean_deg > rim_deg, used = evidence.weight > 0.0;
    const double share = beyond ? rim_deg / lean_deg : 1.0;
    const double x = kMiddle_px + share * evidence.lean_east_deg * px_per_deg, y = kMiddle_px - share * evidence.lean_north_deg * px_per_deg;
    const std::string title = EscapeHtml(fmt::format("{}: {}", KindOf(evidence).name, ShownLean(evidence, georeferenced)));
    html += fmt::format("<g class=\"c{}\"><title>{}</title>", i % 10, title);
    if (!beyond && std::isfinite(evidence.sigma_deg)) {
      html += fmt::format("<circle class=\"error\" clip-path=\"url(#gravity-rim)\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\"/>", x, y,
                          evidence.sigma_deg * px_per_deg);
    }
    html += fmt::format("<circle class=\"dot{}\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4.5\"/></g>", used ? "" : " hollow", x, y);
    legend +=
        LegendEntry(fmt::format("c{} {}", i % 10, used ? "disc" : "ring"), std::string(KindOf(evidence).name) + (beyond ? " (beyond the rim)" : ""));
  }
  return html + FigureEnd(legend);
}

std::string EvidenceRow(const survey::GravityEvidence& evidence, bool georeferenced) {
  const double percent = 100.0 * std::clamp(evidence.weight, 0.0, 1.0);
  std::string html = "<tr>" + TextCell(KindOf(evidence).name) + TextCell(KindOf(evidence).meaning) + CountCell(evidence.n);
  html += NumberCell(LeanOf(evidence), ShownLean(evidence, georeferenced)) + FixedCell(evidence.sigma_deg, 2, kDegree);
  if (!(evidence.weight > 0.0)) return html + NumberCell(0.0, "not used") + "</tr>";
  return html + BarCell(percent, 0.01 * percent, FormatFixed(percent, percent < 9.95 ? 1 : 0, "%")) + "</tr>";
}

}  // namespace

std::string GravityEvidenceTable(const survey::Survey& survey) {
  const survey::GeoFit& fit = survey.fit;
  if (fit.gravity.empty()) return "";
  std::string html =
      BlockBegin("Evidence for the direction of gravity") + "<div class=\"gravity-grid\">" + TargetPlot(fit.gravity, survey.georeferenced);
  html += "<div>" +
          TableBegin(Headings({"Evidence", "What it is"}) + NumberHeadings({"Number", "Its up leans by", "Accuracy", "Weight"}), "sortable gravity");
  for (const survey::GravityEvidence& evidence : fit.gravity) html += EvidenceRow(evidence, survey.georeferenced);
  std::string note;
  if (std::isfinite(fit.tags_alone_tilt_deg)) {
    note = fmt::format("A fit to the tags alone would tilt the survey by {}. ", FormatFixed(fit.tags_alone_tilt_deg, 1, kDegree));
  }
  note +=
      "Leans are angles against the result, which is the middle of the plot. Accuracy, the circle about each point, is one standard deviation. "
      "Weight is the share in what is known of gravity.";
  return html + kTableEnd + Note(note) + "</div></div></div>\n";
}

}  // namespace skyquilt::evaluate::page
