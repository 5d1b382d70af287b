#include "core/gis/zone_wkt.h"

#include "core/gis/gdal_support.h"

namespace skyquilt::gis {

std::string WktOfZone(const geo::UtmZone& zone, geo::HeightReference heights) {
  const internal::QuietErrors quiet;
  const OGRSpatialReference reference = internal::ReferenceOf(zone, heights, "EPSG:" + std::to_string(zone.Epsg()));
  const char* const options[] = {"FORMAT=WKT1_GDAL", "ALLOW_ELLIPSOIDAL_HEIGHT_AS_VERTICAL_CRS=YES", nullptr};
  char* text = nullptr;
  const OGRErr result = reference.exportToWkt(&text, options);
  const std::string wkt = text != nullptr ? text : "";
  CPLFree(text);
  SKYQUILT_CHECK(result == OGRERR_NONE && !wkt.empty(), "no WKT of EPSG:" + std::to_string(zone.Epsg()));
  return wkt;
}

}  // namespace skyquilt::gis
