#include "core/gis/read_maps.h"

#include <ogrsf_frmts.h>

#include <cmath>
#include <cstring>

#include "core/gis/gdal_support.h"

namespace skyquilt::gis {
namespace {

constexpr const char* kMakeAgain = "Make it again with 'skyquilt render' or 'skyquilt surface'";

internal::Dataset OpenToRead(const std::filesystem::path& file, unsigned kind) {
  if (!std::filesystem::exists(file)) throw base::InputError(file, "does not exist", kMakeAgain);
  internal::Dataset dataset(GDALDataset::Open(file.c_str(), kind | GDAL_OF_READONLY));
  if (!dataset) throw base::InputError(file, std::string("cannot be read: ") + CPLGetLastErrorMsg(), kMakeAgain);
  return dataset;
}

void AppendLine(const OGRLineString& part, double height_m, bool index, std::vector<ContourLine>* lines) {
  ContourLine line{height_m, index, {}};
  for (int i = 0; i < part.getNumPoints(); ++i) line.map_xy.emplace_back(part.getX(i), part.getY(i));
  if (line.map_xy.size() > 1) lines->push_back(std::move(line));
}

// Lines of one feature; contours may be single or multiple lines.
void AppendGeometry(const OGRGeometry* geometry, double height_m, bool index, std::vector<ContourLine>* lines) {
  if (geometry == nullptr) return;
  const OGRwkbGeometryType type = wkbFlatten(geometry->getGeometryType());
  if (type == wkbLineString) AppendLine(*geometry->toLineString(), height_m, index, lines);
  if (type == wkbMultiLineString) {
    for (const OGRLineString* part : *geometry->toMultiLineString()) AppendLine(*part, height_m, index, lines);
  }
}

std::vector<ContourLine> ReadLines(OGRLayer* layer, bool only_index, int64_t max_vertices, bool* stopped) {
  std::vector<ContourLine> lines;
  int64_t vertices = 0;
  layer->ResetReading();
  *stopped = false;
  while (const OGRFeatureUniquePtr feature{layer->GetNextFeature()}) {
    const bool index = feature->GetFieldAsInteger("index") != 0;
    if (only_index && !index) continue;
    const size_t before = lines.size();
    AppendGeometry(feature->GetGeometryRef(), feature->GetFieldAsDouble("height_m"), index, &lines);
    for (size_t i = before; i < lines.size(); ++i) vertices += static_cast<int64_t>(lines[i].map_xy.size());
    if (vertices > max_vertices) {
      *stopped = true;
      lines.resize(before);
      break;
    }
  }
  return lines;
}

}  // namespace

MapGrid ReadMapGrid(const std::filesystem::path& file) {
  const internal::QuietErrors quiet;
  GDALRegister_GTiff();
  const internal::Dataset dataset = OpenToRead(file, GDAL_OF_RASTER);
  double transform[6];
  if (dataset->GetGeoTransform(transform) != CE_None) throw base::InputError(file, "has no place on the map", kMakeAgain);
  const bool north_up =
      transform[2] == 0.0 && transform[4] == 0.0 && transform[1] > 0.0 && std::abs(transform[1] + transform[5]) < 1e-9 * transform[1];
  if (!north_up) throw base::InputError(file, "is not north-up with square cells", kMakeAgain);
  MapGrid grid;
  grid.left = transform[0];
  grid.top = transform[3];
  grid.resolution_m = transform[1];
  grid.width = dataset->GetRasterXSize();
  grid.height = dataset->GetRasterYSize();
  return grid;
}

Contours ReadContours(const std::filesystem::path& gpkg, int64_t max_vertices) {
  const internal::QuietErrors quiet;
  GDALAllRegister();
  const internal::Dataset dataset = OpenToRead(gpkg, GDAL_OF_VECTOR);
  OGRLayer* layer = dataset->GetLayerByName("contours");
  if (layer == nullptr) throw base::InputError(gpkg, "has no layer \"contours\"", kMakeAgain);
  Contours contours;
  contours.lines = ReadLines(layer, false, max_vertices, &contours.thinned);
  if (contours.thinned) {
    bool stopped = false;
    contours.lines = ReadLines(layer, true, max_vertices, &stopped);
  }
  return contours;
}

}  // namespace skyquilt::gis
