#include "core/gis/read_maps.h"

#include <ogrsf_frmts.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <optional>

#include "core/gis/gdal_support.h"

namespace skyquilt::gis {
namespace {

constexpr const char* kMakeAgain = "Make it again with 'skyquilt render' or 'skyquilt surface'";

internal::Dataset OpenToRead(const std::filesystem::path& file, unsigned kind) {
  std::error_code error;
  if (!std::filesystem::exists(file, error)) throw base::InputError(file, "does not exist", kMakeAgain);
  internal::Dataset dataset(GDALDataset::Open(file.c_str(), kind | GDAL_OF_READONLY));
  if (!dataset) throw base::InputError(file, std::string("cannot be read: ") + CPLGetLastErrorMsg(), kMakeAgain);
  return dataset;
}

// Nothing without a CRS, or with a local one.
std::optional<geo::UtmZone> ZoneOf(const OGRSpatialReference* reference, const std::filesystem::path& file) {
  if (reference == nullptr || reference->IsEmpty() || reference->IsLocal()) return {};
  OGRSpatialReference horizontal(*reference);
  if (horizontal.IsCompound()) horizontal.StripVertical();
  const char* authority = horizontal.GetAuthorityName(nullptr);
  const char* code_text = horizontal.GetAuthorityCode(nullptr);
  const int code = authority != nullptr && code_text != nullptr && std::string(authority) == "EPSG" ? std::atoi(code_text) : 0;
  if (code == 32661 || code == 32761) return geo::UtmZone{.zone = 0, .north = code == 32661};
  for (const int base : {32600, 32700}) {
    if (code > base && code <= base + 60) return geo::UtmZone{.zone = code - base, .north = base == 32600};
  }
  const char* name = reference->GetName();
  throw base::InputError(file, std::string("is in ") + (name != nullptr ? name : "an unknown CRS") + ", which is no UTM or UPS zone of WGS84",
                         kMakeAgain);
}

int UndulationsOf(GDALMajorObject* object, const std::filesystem::path& file) {
  const char* const text = object->GetMetadataItem(geo::kUndulationsItem);
  if (text == nullptr) return 0;
  const std::string value = text;
  if (value != "1" && value != "-1") throw base::InputError(file, std::string("has ") + geo::kUndulationsItem + " = " + value, kMakeAgain);
  return value == "1" ? 1 : -1;
}

MapGrid GridOf(GDALDataset* dataset, const std::filesystem::path& file) {
  double transform[6];
  if (dataset->GetGeoTransform(transform) != CE_None) throw base::InputError(file, "has no place on the map", kMakeAgain);
  const bool north_up =
      transform[2] == 0.0 && transform[4] == 0.0 && transform[1] > 0.0 && std::abs(transform[1] + transform[5]) < 1e-9 * transform[1];
  if (!north_up || !std::isfinite(transform[0]) || !std::isfinite(transform[3])) {
    throw base::InputError(file, "is not north-up with square cells", kMakeAgain);
  }
  MapGrid grid;
  if (const auto zone = ZoneOf(dataset->GetSpatialRef(), file)) {
    grid.georeferenced = true;
    grid.zone = *zone;
  }
  grid.left = transform[0];
  grid.top = transform[3];
  grid.resolution_m = transform[1];
  grid.width = dataset->GetRasterXSize();
  grid.height = dataset->GetRasterYSize();
  return grid;
}

// One axis of a part: the pixels of the result that lie in the raster, and the cells under them (not whole numbers).
struct Axis {
  int begin = 0, end = 0;  // pixels
  double from = 0.0, to = 0.0;

  // cell_from, cell_to: cells at the edges of the result, which has so many pixels.
  Axis(double cell_from, double cell_to, int pixels, int cells) {
    const double cells_per_pixel = (cell_to - cell_from) / pixels;
    const auto pixel_at = [&](double cell) { return std::clamp((cell - cell_from) / cells_per_pixel, 0.0, static_cast<double>(pixels)); };
    // A little of slack, so that rounding does not lose the outermost pixels.
    begin = static_cast<int>(std::ceil(pixel_at(0.0) - 1e-6));
    end = static_cast<int>(std::floor(pixel_at(cells) + 1e-6));
    from = std::clamp(cell_from + begin * cells_per_pixel, 0.0, static_cast<double>(cells));
    to = std::clamp(cell_from + end * cells_per_pixel, 0.0, static_cast<double>(cells));
  }
  bool Empty() const { return begin >= end || !(from < to); }
  int FirstCell() const { return static_cast<int>(std::floor(from)); }
  int Cells() const { return static_cast<int>(std::ceil(to)) - FirstCell(); }
};

void AppendLine(const OGRLineString& part, double height_m, bool index, std::vector<ContourLine>* lines) {
  ContourLine line{height_m, index, {}};
  for (int i = 0; i < part.getNumPoints(); ++i) {
    if (std::isfinite(part.getX(i)) && std::isfinite(part.getY(i))) line.map_xy.emplace_back(part.getX(i), part.getY(i));
  }
  if (line.map_xy.size() > 1) lines->push_back(std::move(line));
}

// Lines of one feature; contours may be single or multiple lines.
void AppendGeometry(const OGRGeometry* geometry, double height_m, bool index, std::vector<ContourLine>* lines) {
  if (geometry == nullptr || !std::isfinite(height_m)) return;
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
  return GridOf(dataset.get(), file);
}

int ReadUndulations(const std::filesystem::path& file) {
  const internal::QuietErrors quiet;
  GDALRegister_GTiff();
  const internal::Dataset dataset = OpenToRead(file, GDAL_OF_RASTER);
  return UndulationsOf(dataset.get(), file);
}

image::ImageF ReadMapPart(const std::filesystem::path& file, const Eigen::AlignedBox2d& part, int width, int height) {
  SKYQUILT_CHECK(width > 0 && height > 0 && part.min().allFinite() && part.max().allFinite() && part.sizes().minCoeff() > 0.0,
                 std::to_string(width) + " x " + std::to_string(height));
  const internal::QuietErrors quiet;
  GDALRegister_GTiff();
  const internal::Dataset dataset = OpenToRead(file, GDAL_OF_RASTER);
  const MapGrid grid = GridOf(dataset.get(), file);
  const int bands = internal::BandsWithMask(dataset.get());
  image::ImageF image(width, height, bands, std::numeric_limits<float>::quiet_NaN());
  const Axis x((part.min().x() - grid.left) / grid.resolution_m, (part.max().x() - grid.left) / grid.resolution_m, width, grid.width);
  const Axis y((grid.top - part.max().y()) / grid.resolution_m, (grid.top - part.min().y()) / grid.resolution_m, height, grid.height);
  if (x.Empty() || y.Empty()) return image;
  GDALRasterIOExtraArg extra;
  INIT_RASTERIO_EXTRA_ARG(extra);
  const bool shrinks = x.to - x.from >= 1.5 * (x.end - x.begin);
  extra.eResampleAlg = shrinks ? GRIORA_Average : GRIORA_Bilinear;
  extra.bFloatingPointWindowValidity = TRUE;
  extra.dfXOff = x.from;
  extra.dfYOff = y.from;
  extra.dfXSize = x.to - x.from;
  extra.dfYSize = y.to - y.from;
  if (!internal::ReadBands(dataset.get(), {x.FirstCell(), y.FirstCell(), x.Cells(), y.Cells()}, image.At(x.begin, y.begin),
                           {x.end - x.begin, y.end - y.begin}, bands, width, &extra)) {
    throw base::InputError(file, std::string("cannot be read: ") + CPLGetLastErrorMsg(), kMakeAgain);
  }
  internal::ForgetNoData(dataset.get(), &image);
  return image;
}

struct MapReader::Impl {
  std::filesystem::path file;
  internal::Dataset dataset;
  MapGrid grid;
};

MapReader::MapReader(const std::filesystem::path& file) : impl_(std::make_unique<Impl>()) {
  const internal::QuietErrors quiet;
  GDALRegister_GTiff();
  impl_->file = file;
  impl_->dataset = OpenToRead(file, GDAL_OF_RASTER);
  impl_->grid = GridOf(impl_->dataset.get(), file);
}

MapReader::~MapReader() = default;
MapReader::MapReader(MapReader&&) noexcept = default;

const MapGrid& MapReader::grid() const {
  return impl_->grid;
}

image::ImageF MapReader::Read(int column, int row, int width, int height) const {
  const internal::QuietErrors quiet;
  GDALDataset* const dataset = impl_->dataset.get();
  const int stored = dataset->GetRasterCount();
  const bool masked = stored == 3 && dataset->GetRasterBand(1)->GetMaskFlags() == GMF_PER_DATASET;
  const int bands = masked ? 4 : stored;
  image::ImageF image(width, height, bands, std::numeric_limits<float>::quiet_NaN());
  const int left = std::max(column, 0), right = std::min(column + width, impl_->grid.width);
  const int top = std::max(row, 0), bottom = std::min(row + height, impl_->grid.height);
  if (left >= right || top >= bottom) return image;
  const int columns = right - left, rows = bottom - top;
  float* const out = image.At(left - column, top - row);
  const GSpacing pixel = static_cast<GSpacing>(sizeof(float)) * bands, line = pixel * width;
  const bool read = dataset->RasterIO(GF_Read, left, top, columns, rows, out, columns, rows, GDT_Float32, stored, nullptr, pixel, line, sizeof(float),
                                      nullptr) == CE_None &&
                    (!masked || dataset->GetRasterBand(1)->GetMaskBand()->RasterIO(GF_Read, left, top, columns, rows, out + stored, columns, rows,
                                                                                   GDT_Float32, pixel, line, nullptr) == CE_None);
  if (!read) throw base::InputError(impl_->file, std::string("cannot be read: ") + CPLGetLastErrorMsg(), kMakeAgain);
  internal::ForgetNoData(dataset, &image);
  return image;
}

Contours ReadContours(const std::filesystem::path& gpkg, int64_t max_vertices) {
  const internal::QuietErrors quiet;
  GDALAllRegister();
  const internal::Dataset dataset = OpenToRead(gpkg, GDAL_OF_VECTOR);
  OGRLayer* layer = dataset->GetLayerByName("contours");
  if (layer == nullptr) throw base::InputError(gpkg, "has no layer \"contours\"", kMakeAgain);
  Contours contours;
  if (const auto zone = ZoneOf(layer->GetSpatialRef(), gpkg)) {
    contours.georeferenced = true;
    contours.zone = *zone;
  }
  contours.undulations = UndulationsOf(layer, gpkg);
  contours.lines = ReadLines(layer, false, max_vertices, &contours.thinned);
  if (contours.thinned) {
    bool stopped = false;
    contours.lines = ReadLines(layer, true, max_vertices, &stopped);
  }
  return contours;
}

}  // namespace skyquilt::gis
