#include <fmt/core.h>

#include "bench/study/buildings_parts.h"
#include "core/page/html.h"
#include "evaluate/buildings/buildings_scorer.h"
#include "evaluate/page/drawn_map.h"

namespace skyquilt::bench {
namespace {

using evaluate::buildings::FoundFate;
using evaluate::buildings::TrueFate;

constexpr const char* kFoundColor = "#fab64b";

std::string PathOf(const buildings::Polygon& polygon, const evaluate::page::DrawnMap& frame) {
  std::string path;
  const auto add = [&](const std::vector<Eigen::Vector2d>& ring) {
    for (size_t i = 0; i < ring.size(); ++i) path += fmt::format("{}{:.1f} {:.1f}", i == 0 ? "M" : "L", frame.X(ring[i].x()), frame.Y(ring[i].y()));
    path += "Z";
  };
  add(polygon.outer);
  for (const std::vector<Eigen::Vector2d>& hole : polygon.holes) add(hole);
  return path;
}

}  // namespace

std::string BuildingsPlan(const std::string& title, const std::filesystem::path& project_folder, const survey::Survey& survey) {
  const std::optional<evaluate::buildings::ComparedBuildings> compared = evaluate::buildings::LoadBuildingsOf(project_folder, survey);
  if (!compared || !compared->truth) return "";
  const std::vector<evaluate::buildings::TrueBuilding>& outlines = compared->truth->outlines;
  evaluate::page::MapBounds bounds;
  for (const buildings::Building& building : compared->set.buildings) {
    for (const Eigen::Vector2d& corner : building.footprint.outer) bounds.Include(corner);
  }
  for (const evaluate::buildings::TrueBuilding& outline : outlines) {
    for (const Eigen::Vector2d& corner : outline.walls.outer) bounds.Include(corner);
  }
  const evaluate::page::DrawnMap frame(bounds);
  std::string svg;
  for (size_t f = 0; f < compared->set.buildings.size(); ++f) {
    const buildings::Building& building = compared->set.buildings[f];
    const bool invented = compared->matches.found[f] == FoundFate::kInvented;
    svg += fmt::format("<path class=\"footprint{}\" fill=\"{}\" fill-rule=\"evenodd\" d=\"{}\"><title>Found {}, {} roof{}</title></path>",
                       invented ? " invented" : "", kFoundColor, PathOf(building.footprint, frame), building.id, buildings::NameOf(building.roof),
                       invented ? ": no such building" : "");
  }
  for (size_t t = 0; t < outlines.size(); ++t) {
    const TrueFate fate = compared->matches.truth[t];
    const char* css_class = fate == TrueFate::kMissed ? "missed" : fate == TrueFate::kNotCounted ? "uncounted" : "true-outline";
    svg += fmt::format("<path class=\"{}\"{} d=\"{}\"><title>True outline {}, {} roof, {}{}</title></path>", css_class,
                       fate == TrueFate::kMatched ? " fill=\"none\" stroke=\"currentColor\" stroke-width=\"1.4\"" : "",
                       PathOf(outlines[t].walls, frame), outlines[t].id, buildings::NameOf(outlines[t].roof),
                       page::FormatFixed(outlines[t].area_m2, 0, "m\xC2\xB2"), fate == TrueFate::kMissed ? ": missed" : "");
  }
  return fmt::format("<figure class=\"card map-card\"><svg class=\"map building-map\" viewBox=\"0 0 {:.1f} {:.1f}\" role=\"img\" aria-label=\"{}\">",
                     frame.width_px(), frame.height_px(), page::EscapeHtml("Plan of the buildings: " + title)) +
         svg + evaluate::page::ScaleBarAndNorth(frame, survey.georeferenced) +
         fmt::format(
             "</svg><figcaption>{}<div class=\"legend\"><span><i class=\"k-missed\"></i>missed</span><span><i "
             "class=\"k-invented\"></i>invented</span><span><i class=\"k-uncounted\"></i>does not count</span></div></figcaption></figure>\n",
             page::EscapeHtml(title));
}

}  // namespace skyquilt::bench
