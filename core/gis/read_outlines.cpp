#include "core/gis/read_outlines.h"

#include <algorithm>
#include <utility>

#include "core/gis/polygon_file.h"

namespace skyquilt::gis {
namespace {

constexpr const char* kGiveOutlines = "Give a GeoJSON, GeoPackage or Shapefile (.shp) with the outlines as polygons";
constexpr double kLeastArea_m2 = 1e-4;

// Files may hold text in any encoding; what leaves here can be written as JSON.
std::string CleanText(const char* text) {
  if (CPLIsUTF8(text, -1) != 0) return text;
  char* ascii = CPLForceToASCII(text, -1, '?');
  std::string clean = ascii;
  CPLFree(ascii);
  return clean;
}

std::string IdentityOf(const internal::FoundPolygons& found) {
  OGRFeature& feature = *found.feature;
  for (const char* name : {"id", "fid", "osm_id", "name"}) {
    const int field = feature.GetFieldIndex(name);
    if (field < 0 || !feature.IsFieldSetAndNotNull(field)) continue;
    const std::string text = CleanText(feature.GetFieldAsString(field));
    if (!text.empty()) return text;
  }
  return found.numbered ? std::to_string(feature.GetFID()) : "";
}

std::vector<Eigen::Vector2d> PointsOf(const OGRLinearRing& ring, bool counter_clockwise) {
  std::vector<Eigen::Vector2d> points;
  for (int i = 0; i < ring.getNumPoints(); ++i) {
    const Eigen::Vector2d point(ring.getX(i), ring.getY(i));
    if (points.empty() || point != points.back()) points.push_back(point);
  }
  while (points.size() > 1 && points.back() == points.front()) points.pop_back();
  const bool turns_left = ring.isClockwise() == 0;
  if (turns_left != counter_clockwise) std::reverse(points.begin(), points.end());
  return points;
}

void AddOutline(const OGRPolygon& polygon, const std::string& id, std::vector<Outline>* outlines) {
  if (polygon.getExteriorRing() == nullptr || !(polygon.get_Area() >= kLeastArea_m2)) return;
  Outline outline{.rings = {PointsOf(*polygon.getExteriorRing(), true)}, .id = id};
  for (int i = 0; i < polygon.getNumInteriorRings(); ++i) {
    std::vector<Eigen::Vector2d> hole = PointsOf(*polygon.getInteriorRing(i), false);
    if (hole.size() >= 3) outline.rings.push_back(std::move(hole));
  }
  outlines->push_back(std::move(outline));
}

// Without crossing edges.
OGRMultiPolygon Repaired(const OGRPolygon& polygon) {
  OGRMultiPolygon parts;
  if (polygon.IsValid()) {
    parts.addGeometry(&polygon);
  } else if (const std::unique_ptr<OGRGeometry> valid(polygon.MakeValid()); valid) {
    internal::AddPolygons(*valid, &parts);
  }
  return parts;
}

}  // namespace

std::vector<Outline> ReadOutlines(const std::filesystem::path& file, bool georeferenced, const geo::UtmZone& zone) {
  const internal::QuietErrors quiet;
  const internal::PolygonFormats formats = {
      .drivers = {"GeoJSON", "GPKG", "ESRI Shapefile"}, .names = "GeoJSON, GeoPackage or Shapefile", .fix = kGiveOutlines};
  std::vector<Outline> outlines;
  internal::ForEachPolygons(file, formats, georeferenced, zone, [&](const internal::FoundPolygons& found) {
    const std::string id = IdentityOf(found);
    for (const OGRPolygon* polygon : found.polygons) {
      OGRPolygon flat(*polygon);
      flat.flattenTo2D();
      for (const OGRPolygon* part : Repaired(flat)) AddOutline(*part, id, &outlines);
    }
  });
  if (outlines.empty()) throw base::InputError(file, "has no polygon with an area", kGiveOutlines);
  return outlines;
}

}  // namespace skyquilt::gis
