#include "core/gis/vector_layers.h"

#include <cmath>

#include "core/gis/gdal_support.h"

namespace skyquilt::gis {
namespace {

OGRFieldType FieldTypeOf(FieldType type) {
  switch (type) {
    case FieldType::kInteger:
      return OFTInteger64;
    case FieldType::kReal:
      return OFTReal;
    case FieldType::kText:
      break;
  }
  return OFTString;
}

std::unique_ptr<OGRPolygon> PolygonOf(const LayerPolygon& rings, bool with_height) {
  auto polygon = std::make_unique<OGRPolygon>();
  for (const std::vector<Eigen::Vector3d>& points : rings) {
    SKYQUILT_CHECK(points.size() >= 3, "a ring of " + std::to_string(points.size()) + " points");
    auto ring = std::make_unique<OGRLinearRing>();
    for (const Eigen::Vector3d& point : points) {
      SKYQUILT_CHECK(point.allFinite(), "a ring with a coordinate that is not finite");
      if (with_height) {
        ring->addPoint(point.x(), point.y(), point.z());
      } else {
        ring->addPoint(point.x(), point.y());
      }
    }
    ring->closeRings();
    polygon->addRingDirectly(ring.release());
  }
  return polygon;
}

std::unique_ptr<OGRGeometry> GeometryOf(const LayerFeature& feature, LayerGeometry type) {
  if (feature.polygons.empty()) return nullptr;
  if (type == LayerGeometry::kPolygon) {
    SKYQUILT_CHECK(feature.polygons.size() == 1, std::to_string(feature.polygons.size()) + " polygons in a layer of single ones");
    return PolygonOf(feature.polygons.front(), false);
  }
  auto all = std::make_unique<OGRMultiPolygon>();
  for (const LayerPolygon& rings : feature.polygons) all->addGeometryDirectly(PolygonOf(rings, true).release());
  return all;
}

void SetValue(const FieldValue& value, FieldType type, int index, OGRFeature* feature) {
  if (std::holds_alternative<std::monostate>(value)) return feature->SetFieldNull(index);
  const bool fits = type == FieldType::kInteger ? std::holds_alternative<int64_t>(value)
                    : type == FieldType::kReal  ? std::holds_alternative<double>(value)
                                                : std::holds_alternative<std::string>(value);
  SKYQUILT_CHECK(fits, "the value of field " + std::to_string(index) + " is not of the field's type");
  if (const auto* whole = std::get_if<int64_t>(&value)) return feature->SetField(index, static_cast<GIntBig>(*whole));
  if (const auto* text = std::get_if<std::string>(&value)) return feature->SetField(index, text->c_str());
  const double real = std::get<double>(value);
  if (std::isfinite(real)) {
    feature->SetField(index, real);
  } else {
    feature->SetFieldNull(index);
  }
}

void WriteLayer(const VectorLayer& source, const OGRSpatialReference& reference, GDALDataset* dataset, const std::filesystem::path& file) {
  CPLStringList options;
  options.SetNameValue("DESCRIPTION", source.description.c_str());
  OGRSpatialReference own(reference);
  const OGRwkbGeometryType type = source.geometry == LayerGeometry::kPolygon ? wkbPolygon : wkbMultiPolygon25D;
  OGRLayer* layer = dataset->CreateLayer(source.name.c_str(), &own, type, options.List());
  if (layer == nullptr) internal::FailWriting(file, "cannot be written");
  for (const LayerField& field : source.fields) {
    OGRFieldDefn definition(field.name.c_str(), FieldTypeOf(field.type));
    if (layer->CreateField(&definition) != OGRERR_NONE) internal::FailWriting(file, "cannot be written");
  }
  for (const LayerFeature& row : source.features) {
    base::ThrowIfCancelled();
    SKYQUILT_CHECK(row.values.size() == source.fields.size(), std::to_string(row.values.size()) + " values in layer " + source.name);
    OGRFeature feature(layer->GetLayerDefn());
    for (size_t i = 0; i < row.values.size(); ++i) SetValue(row.values[i], source.fields[i].type, static_cast<int>(i), &feature);
    if (std::unique_ptr<OGRGeometry> geometry = GeometryOf(row, source.geometry)) feature.SetGeometryDirectly(geometry.release());
    if (layer->CreateFeature(&feature) != OGRERR_NONE) internal::FailWriting(file, "cannot be written");
  }
}

}  // namespace

void WriteVectorLayers(std::span<const VectorLayer> layers, bool georeferenced, const geo::UtmZone& zone, const std::filesystem::path& gpkg) {
  const internal::QuietErrors quiet;
  const internal::FixedTimeStamp time_stamp;
  internal::PartialPackage partial(gpkg);
  internal::Dataset dataset = internal::CreatePackage(partial.path(), gpkg);
  if (dataset->StartTransaction() != OGRERR_NONE) internal::FailWriting(gpkg, "cannot be written");
  for (const VectorLayer& layer : layers) {
    WriteLayer(layer, internal::LayerReference(georeferenced, zone, layer.heights, gpkg), dataset.get(), gpkg);
  }
  if (dataset->CommitTransaction() != OGRERR_NONE) internal::FailWriting(gpkg, "cannot be written");
  internal::CloseWritten(&dataset, gpkg);
  partial.Publish();
}

}  // namespace skyquilt::gis
