#include "core/gis/polygon_file.h"

#include <cmath>
#include <string_view>
#include <utility>

namespace skyquilt::gis::internal {
namespace {

struct DestroyTransformation {
  void operator()(OGRCoordinateTransformation* transformation) const { OCTDestroyCoordinateTransformation(transformation); }
};

// Transforms the corners of rings to the survey's zone.
class ToZone {
 public:
  ToZone(const std::filesystem::path& file, const OGRSpatialReference* source, const geo::UtmZone& zone) : file_(file) {
    // GeoPackage has two entries for "undefined", which GDAL gives as a CRS.
    if (source == nullptr || source->IsEmpty() || source->IsLocal() ||
        (source->GetName() != nullptr && std::string_view(source->GetName()).starts_with("Undefined"))) {
      throw base::InputError(
          file, "has polygons without a coordinate reference system, so their place on Earth is unknown",
          "Set the layer's CRS, for instance to EPSG:" + std::to_string(zone.Epsg()) + ", or give GeoJSON in longitude and latitude");
    }
    OGRSpatialReference from(*source);
    from.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    geographic_ = from.IsGeographic() != 0;
    to_degrees_ = geographic_ ? from.GetAngularUnits() * 180.0 / 3.14159265358979323846 : 1.0;
    const OGRSpatialReference to = ReferenceOf(zone, file);
    transformation_.reset(OGRCreateCoordinateTransformation(&from, &to));
    if (!transformation_) {
      throw base::InputError(
          file, std::string("has a coordinate reference system that cannot be transformed to ") + zone.Name() + ": " + CPLGetLastErrorMsg(),
          "Give the polygons in EPSG:" + std::to_string(zone.Epsg()) + " or in longitude and latitude (EPSG:4326)");
    }
  }

  void Transform(OGRLinearRing* ring) const {
    for (int i = 0; i < ring->getNumPoints(); ++i) {
      const double x = ring->getX(i), y = ring->getY(i);
      if (geographic_ && !(std::abs(x * to_degrees_) <= 360.0 && std::abs(y * to_degrees_) <= 90.0)) {
        throw base::InputError(file_, "has the point " + std::to_string(x) + ", " + std::to_string(y) + ", which is no longitude and latitude",
                               "GeoJSON must be in degrees, longitude first, unless it names another CRS in 'crs'");
      }
      double east = x, north = y;
      const bool ok = transformation_->Transform(1, &east, &north) != 0;
      if (!ok || !std::isfinite(east) || !std::isfinite(north)) {
        throw base::InputError(file_,
                               "has the point " + std::to_string(x) + ", " + std::to_string(y) +
                                   ", which cannot be transformed to the survey's zone: " + CPLGetLastErrorMsg(),
                               "Check that the polygons are at the place of the survey, and that their CRS is right");
      }
      ring->setPoint(i, east, north);
    }
  }

 private:
  std::filesystem::path file_;
  bool geographic_ = false;
  double to_degrees_ = 1.0;  // of the CRS's angles
  std::unique_ptr<OGRCoordinateTransformation, DestroyTransformation> transformation_;
};

void RequireFinite(const OGRMultiPolygon& polygons, const std::filesystem::path& file) {
  for (const OGRPolygon* polygon : polygons) {
    for (const OGRLinearRing* ring : *polygon) {
      for (int i = 0; i < ring->getNumPoints(); ++i) {
        if (std::isfinite(ring->getX(i)) && std::isfinite(ring->getY(i))) continue;
        throw base::InputError(file, "has a polygon with a coordinate that is not a finite number", "Draw the polygon again");
      }
    }
  }
}

void RegisterDrivers(const PolygonFormats& formats) {
  for (const std::string_view driver : formats.drivers) {
    if (driver == "GeoJSON") RegisterOGRGeoJSON();
    if (driver == "GPKG") RegisterOGRGeoPackage();
    if (driver == "ESRI Shapefile") RegisterOGRShape();
  }
}

// Read to the end before anything is looked at: an error of reading explains more than one of the content.
std::vector<FoundPolygons> ReadLayer(OGRLayer* layer, const std::filesystem::path& file, const PolygonFormats& formats) {
  std::vector<FoundPolygons> found;
  // GDAL does not say whether the features of a GeoJSON have numbers; it counts them from 0 where they have none.
  bool numbered = std::string_view(layer->GetFIDColumn()) != "";
  GIntBig row = 0;
  CPLErrorReset();
  for (auto& feature : *layer) {
    numbered = numbered || feature->GetFID() != row;
    ++row;
    FoundPolygons entry;
    if (const OGRGeometry* geometry = feature->GetGeometryRef()) AddPolygons(*geometry, &entry.polygons);
    if (entry.polygons.IsEmpty()) continue;
    entry.feature = std::move(feature);
    found.push_back(std::move(entry));
  }
  if (CPLGetLastErrorType() >= CE_Failure) throw base::InputError(file, std::string("is damaged: ") + CPLGetLastErrorMsg(), formats.fix);
  for (FoundPolygons& entry : found) entry.numbered = numbered;
  return found;
}

}  // namespace

void AddPolygons(const OGRGeometry& geometry, OGRMultiPolygon* polygons) {
  const OGRwkbGeometryType type = wkbFlatten(geometry.getGeometryType());
  if (type == wkbPolygon) {
    polygons->addGeometry(&geometry);
  } else if (type == wkbCurvePolygon || type == wkbMultiSurface) {
    const std::unique_ptr<OGRGeometry> linear(geometry.getLinearGeometry());
    if (linear && wkbFlatten(linear->getGeometryType()) != type) AddPolygons(*linear, polygons);
  } else if (type == wkbMultiPolygon || type == wkbGeometryCollection) {
    for (const OGRGeometry* part : *geometry.toGeometryCollection()) AddPolygons(*part, polygons);
  }
}

void ForEachPolygons(const std::filesystem::path& file, const PolygonFormats& formats, bool georeferenced, const geo::UtmZone& zone,
                     const std::function<void(const FoundPolygons&)>& take) {
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) throw base::InputError(file, "does not exist", formats.fix);
  RegisterDrivers(formats);
  std::vector<const char*> drivers = formats.drivers;
  drivers.push_back(nullptr);
  const Dataset dataset(GDALDataset::Open(file.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY, drivers.data()));
  if (!dataset) {
    const std::string reason = CPLGetLastErrorMsg();
    throw base::InputError(file, "cannot be read as " + formats.names + (reason.empty() ? "" : ": " + reason), formats.fix);
  }
  for (OGRLayer* layer : dataset->GetLayers()) {
    std::vector<FoundPolygons> found = ReadLayer(layer, file, formats);
    if (found.empty()) continue;
    for (const FoundPolygons& entry : found) RequireFinite(entry.polygons, file);
    if (georeferenced) {
      const ToZone to_zone(file, layer->GetSpatialRef(), zone);
      for (FoundPolygons& entry : found) {
        for (OGRPolygon* polygon : entry.polygons) {
          for (OGRLinearRing* ring : *polygon) to_zone.Transform(ring);
        }
      }
    }
    for (const FoundPolygons& entry : found) take(entry);
  }
}

}  // namespace skyquilt::gis::internal
