#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/page/figure.h"
#include "evaluate/page/building_numbers.h"
#include "evaluate/page/buildings_section.h"
#include "evaluate/page/drawn_map.h"
#include "evaluate/page/page_parts.h"

namespace skyquilt::evaluate::page {
namespace {

constexpr std::array<std::array<double, 3>, 4> kHeightColors = {{{255, 243, 176}, {250, 166, 75}, {214, 52, 58}, {112, 11, 73}}};  // low to high
constexpr const char* kUnknownColor = "#9aa4b0";
constexpr double kLabelRoom_px = 16.0;  // shortest side of a footprint that has room for its number

std::string HeightColor(double share) {
  const double place = std::clamp(share, 0.0, 1.0) * static_cast<double>(kHeightColors.size() - 1);
  const size_t below = std::min(static_cast<size_t>(place), kHeightColors.size() - 2);
  const double part = place - static_cast<double>(below);
  std::string color = "#";
  for (size_t c = 0; c < 3; ++c) {
    color += fmt::format("{:02x}", std::lround(kHeightColors[below][c] + part * (kHeightColors[below + 1][c] - kHeightColors[below][c])));
  }
  return color;
}

class BuildingsMapDrawing {
 public:
  explicit BuildingsMapDrawing(const ReportInput& input)
      : input_(input),
        set_(input.buildings->compared.set),
        matches_(input.buildings->compared.matches),
        units_(BuildingUnits::Of(set_)),
        frame_(BoundsOf(input)),
        carded_(set_.buildings.size()) {
    for (const buildings::Building& building : set_.buildings) {
      const double height = building.measures.height_m.value;
      if (!std::isfinite(height)) continue;
      low_ = std::min(low_, height);
      high_ = std::max(high_, height);
    }
    for (const size_t index : buildings::BuildingsWithCards(set_)) carded_[index] = true;
  }

  std::string Figure() const {
    return MapFigureBegin(frame_, input_.background ? "building-map over-image" : "building-map", "Map of the buildings") +
           (input_.background ? BackgroundImage(frame_, *input_.background) : "") + Outlines(buildings::TrueFate::kNotCounted, "uncounted") +
           Footprints() + Outlines(buildings::TrueFate::kMissed, "missed") + Numbers() + ScaleBarAndNorth(frame_, input_.survey->georeferenced) +
           MapFigureEnd(Legend());
  }

 private:
  static MapBounds BoundsOf(const ReportInput& input) {
    MapBounds bounds;
    const buildings::ComparedBuildings& compared = input.buildings->compared;
    for (const buildings::Building& building : compared.set.buildings) {
      for (const Eigen::Vector2d& corner : building.footprint.outer) bounds.Include(corner);
    }
    for (size_t t = 0; t < compared.matches.truth.size(); ++t) {
      if (compared.matches.truth[t] == buildings::TrueFate::kNotCounted) continue;
      for (const Eigen::Vector2d& corner : compared.truth->outlines[t].walls.outer) bounds.Include(corner);
    }
    return bounds;
  }

  std::string PathOf(const buildings::Polygon& polygon) const {
    std::string path;
    const auto add = [&](const std::vector<Eigen::Vector2d>& ring) {
      for (size_t i = 0; i < ring.size(); ++i)
        path += fmt::format("{}{:.1f} {:.1f}", i == 0 ? "M" : "L", frame_.X(ring[i].x()), frame_.Y(ring[i].y()));
      path += "Z";
    };
    add(polygon.outer);
    for (const std::vector<Eigen::Vector2d>& hole : polygon.holes) add(hole);
    return path;
  }

  buildings::FoundFate FateOf(size_t index) const { return matches_.found.empty() ? buildings::FoundFate::kMatched : matches_.found[index]; }

  std::string Title(size_t index) const {
    const buildings::Building& building = set_.buildings[index];
    const skyquilt::buildings::Measures& measures = building.measures;
    std::string title = fmt::format("Building {}, {} roof\nheight {}\nlength {}, width {}", building.id, NameOf(building.roof),
                                    ShownMeasure(measures.height_m, units_.length), ShownMeasure(measures.length_m, units_.length),
                                    ShownMeasure(measures.width_m, units_.length));
    if (FateOf(index) == buildings::FoundFate::kInvented) title += "\nno such building in the truth";
    return title;
  }

  std::string Footprints() const {
    std::string svg;
    for (size_t i = 0; i < set_.buildings.size(); ++i) {
      const buildings::Building& building = set_.buildings[i];
      const double height = building.measures.height_m.value;
      const std::string color = std::isfinite(height) ? HeightColor((height - low_) / std::max(high_ - low_, 1e-9)) : kUnknownColor;
      svg += fmt::format(
          "<a href=\"#building-{}{}\"><path class=\"footprint{}{}\" fill=\"{}\" fill-rule=\"evenodd\" d=\"{}\"><title>{}</title></path></a>",
          carded_[i] ? "" : "row-", building.id, building.accepted ? "" : " unsure", FateOf(i) == buildings::FoundFate::kInvented ? " invented" : "",
          color, PathOf(building.footprint), Title(i));
    }
    return svg;
  }

  std::string Outlines(buildings::TrueFate fate, const char* css_class) const {
    std::string svg;
    for (size_t t = 0; t < matches_.truth.size(); ++t) {
      if (matches_.truth[t] != fate) continue;
      const buildings::TrueBuilding& outline = input_.buildings->compared.truth->outlines[t];
      svg += fmt::format(
          "<path class=\"{}\" d=\"{}\"><title>True outline {}{}, {} roof, {}{}</title></path>", css_class, PathOf(outline.walls), outline.id,
          outline.kind.empty() ? "" : ", " + EscapeHtml(outline.kind), NameOf(outline.roof), FormatFixed(outline.area_m2, 0, "m\xC2\xB2"),
          fate == buildings::TrueFate::kMissed ? ": missed" : ": not counted, because it is small or not wholly inside the surveyed area");
    }
    return svg;
  }

  // Where a footprint is large enough; the others have their tooltip.
  std::string Numbers() const {
    std::string svg;
    for (const buildings::Building& building : set_.buildings) {
      if (building.footprint.outer.empty()) continue;
      MapBounds bounds;
      for (const Eigen::Vector2d& corner : building.footprint.outer) bounds.Include(corner);
      if (bounds.Empty() || (bounds.high - bounds.low).minCoeff() * frame_.scale() < kLabelRoom_px) continue;
      const Eigen::Vector2d middle = Centroid(building.footprint);
      svg += fmt::format("<text class=\"number\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>", frame_.X(middle.x()), frame_.Y(middle.y()) + 4.0, building.id);
    }
    return svg;
  }

  std::string Legend() const {
    std::string legend;
    if (low_ <= high_) {
      std::string colors;
      for (size_t i = 0; i < kHeightColors.size(); ++i) {
        colors += (i == 0 ? "" : ",") + HeightColor(static_cast<double>(i) / static_cast<double>(kHeightColors.size() - 1));
      }
      legend += fmt::format("<span class=\"ramp\">height {}<i style=\"background:linear-gradient(90deg,{})\"></i>{}</span>", FormatFixed(low_, 1),
                            colors, FormatFixed(high_, 1, units_.length));
    }
    if (std::any_of(set_.buildings.begin(), set_.buildings.end(), [](const buildings::Building& b) { return !b.accepted; })) {
      legend += LegendEntry("k-unsure", "the model does not fit well");
    }
    if (std::count(matches_.truth.begin(), matches_.truth.end(), buildings::TrueFate::kMissed) > 0)
      legend += LegendEntry("k-missed", "true outline that was missed");
    if (std::count(matches_.found.begin(), matches_.found.end(), buildings::FoundFate::kInvented) > 0)
      legend += LegendEntry("k-invented", "invented: no such building");
    if (std::count(matches_.truth.begin(), matches_.truth.end(), buildings::TrueFate::kNotCounted) > 0)
      legend += LegendEntry("k-uncounted", "true outline that does not count");
    return legend;
  }

  const ReportInput& input_;
  const buildings::BuildingSet& set_;
  const buildings::BuildingMatches& matches_;
  BuildingUnits units_;
  DrawnMap frame_;
  std::vector<bool> carded_;
  double low_ = std::numeric_limits<double>::infinity(), high_ = -low_;
};

}  // namespace

std::string BuildingsMap(const ReportInput& input) {
  return BuildingsMapDrawing(input).Figure();
}

}  // namespace skyquilt::evaluate::page
