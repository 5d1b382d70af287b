#include "core/gis/area_without.h"

#include <string>
#include <vector>

#include "core/base/file.h"
#include "core/gis/gdal_support.h"

namespace skyquilt::gis {
namespace {

using Geometry = std::unique_ptr<OGRGeometry>;

// The inside of rings (even-odd) as polygons: rings of a Boundary do not cross, so each lies inside an even or an odd number of others.
Geometry PolygonsOf(const std::vector<std::vector<Eigen::Vector2d>>& rings) {
  std::vector<OGRGeometry*> parts;  // owned by the result
  for (const std::vector<Eigen::Vector2d>& ring : rings) {
    OGRLinearRing line;
    for (const Eigen::Vector2d& point : ring) line.addPoint(point.x(), point.y());
    line.closeRings();
    auto polygon = std::make_unique<OGRPolygon>();
    polygon->addRing(&line);
    parts.push_back(polygon.release());
  }
  return Geometry(OGRGeometryFactory::organizePolygons(parts.data(), static_cast<int>(parts.size()), nullptr, nullptr));
}

Geometry RectangleOf(const MapExtent& all) {
  return PolygonsOf({{all.low, {all.high.x(), all.low.y()}, all.high, {all.low.x(), all.high.y()}}});
}

}  // namespace

void WriteAreaWithout(const std::optional<Boundary>& area, const MapExtent& all, const Boundary& holes, bool georeferenced, const geo::UtmZone& zone,
                      const std::filesystem::path& file) {
  const internal::QuietErrors quiet;
  const Geometry whole = area ? PolygonsOf(area->rings()) : RectangleOf(all), left_out = PolygonsOf(holes.rings());
  // Rings that were drawn across themselves have no difference; widening by nothing gives valid ones of the same area.
  const Geometry mended_whole(whole->Buffer(0.0)), mended_holes(left_out->Buffer(0.0));
  const Geometry rest(mended_whole && mended_holes ? mended_whole->Difference(mended_holes.get()) : nullptr);
  if (!rest || rest->IsEmpty()) {
    throw base::InputError(file, "would be empty: all of the products' area is ground to ignore", "Draw smaller polygons for masks.ignore_ground");
  }
  const std::unique_ptr<char, decltype(&CPLFree)> geometry(rest->exportToJson(), &CPLFree);
  if (!geometry) internal::FailWriting(file, "cannot be written");
  const std::string crs =
      georeferenced ? R"("crs":{"type":"name","properties":{"name":"urn:ogc:def:crs:EPSG::)" + std::to_string(zone.Epsg()) + "\"}}," : "";
  base::WriteFileAtomically(
      file, R"({"type":"FeatureCollection",)" + crs + R"("features":[{"type":"Feature","properties":{},"geometry":)" + geometry.get() + "}]}\n");
}

}  // namespace skyquilt::gis
