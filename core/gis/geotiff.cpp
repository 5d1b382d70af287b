#include "core/gis/geotiff.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/output_file.h"
#include "core/gis/gdal_support.h"

namespace skyquilt::gis {
namespace {

using internal::Dataset;
using internal::FailWriting;
using internal::QuietErrors;

GDALDataType TypeOf(PixelType type) {
  return type == PixelType::kUint8 ? GDT_Byte : type == PixelType::kUint16 ? GDT_UInt16 : GDT_Float32;
}

// Of the plain file that the rows are written to: it is only read once more, so that fast compression is better than good compression.
CPLStringList CreationOptions(const GeoTiffSpec& spec) {
  CPLStringList options;
  options.SetNameValue("TILED", "YES");
  options.SetNameValue("BLOCKXSIZE", std::to_string(GeoTiffWriter::kTile).c_str());
  options.SetNameValue("BLOCKYSIZE", std::to_string(GeoTiffWriter::kTile).c_str());
  options.SetNameValue("COMPRESS", "DEFLATE");
  options.SetNameValue("ZLEVEL", "1");
  options.SetNameValue("PREDICTOR", spec.type == PixelType::kFloat32 ? "3" : "2");
  options.SetNameValue("BIGTIFF", "IF_SAFER");
  if (spec.type == PixelType::kUint8 && spec.bands == 4) {
    options.SetNameValue("PHOTOMETRIC", "RGB");
    options.SetNameValue("ALPHA", "YES");
  }
  return options;
}

CPLStringList CogOptions(const GeoTiffSpec& spec) {
  CPLStringList options;
  if (spec.jpeg_quality > 0) {
    options.SetNameValue("COMPRESS", "JPEG");  // YCbCr, and the alpha band becomes a mask
    options.SetNameValue("QUALITY", std::to_string(spec.jpeg_quality).c_str());
  } else {
    options.SetNameValue("COMPRESS", "DEFLATE");
    options.SetNameValue("PREDICTOR", "YES");  // the one for the type of the values
  }
  options.SetNameValue("BLOCKSIZE", std::to_string(GeoTiffWriter::kTile).c_str());
  options.SetNameValue("OVERVIEWS", "AUTO");
  options.SetNameValue("RESAMPLING", spec.labels ? "NEAREST" : "AVERAGE");
  options.SetNameValue("BIGTIFF", "IF_SAFER");
  options.SetNameValue("NUM_THREADS", "ALL_CPUS");  // tiles are compressed in parallel, but written in order
  return options;
}

}  // namespace

struct GeoTiffWriter::Impl {
  std::filesystem::path file;
  std::optional<base::PartialPath> plain;  // the rows as they come; never published
  base::PartialPath cog;                   // rearranged, with overviews
  GeoTiffSpec spec;
  Dataset dataset;

  Impl(const std::filesystem::path& final_file, const GeoTiffSpec& given)
      : file(final_file), plain(file), cog(file, file.string() + ".cog.partial"), spec(given) {}

  ~Impl() {
    const QuietErrors quiet;
    dataset.reset();
  }
  void Write(int first_row, int n_rows, const void* values, size_t count, PixelType type);
  void Rearrange();
};

GeoTiffWriter::GeoTiffWriter(const std::filesystem::path& file, const GeoTiffSpec& spec) : impl_(std::make_unique<Impl>(file, spec)) {
  const bool colours = spec.type == PixelType::kUint8 && spec.bands == 4 && !spec.nodata;
  SKYQUILT_CHECK(spec.jpeg_quality == 0 || (spec.jpeg_quality > 0 && spec.jpeg_quality <= 100 && colours && !spec.labels),
                 std::to_string(spec.jpeg_quality));
  const QuietErrors quiet;
  GDALRegister_GTiff();
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GTiff");
  SKYQUILT_CHECK(driver != nullptr, "GDAL without GeoTIFF");
  impl_->dataset.reset(
      driver->Create(impl_->plain->path().c_str(), spec.grid.width, spec.grid.height, spec.bands, TypeOf(spec.type), CreationOptions(spec).List()));
  if (!impl_->dataset) FailWriting(file, "cannot be created");
  GDALDataset& dataset = *impl_->dataset;
  double transform[6] = {spec.grid.left, spec.grid.resolution_m, 0.0, spec.grid.top, 0.0, -spec.grid.resolution_m};
  if (dataset.SetGeoTransform(transform) != CE_None) FailWriting(file, "cannot store its position");
  if (spec.grid.georeferenced) {
    const OGRSpatialReference reference =
        internal::ReferenceOf(spec.grid.zone, spec.heights == geo::HeightReference::kEgm96 ? spec.heights : geo::HeightReference::kUnknown, file);
    if (dataset.SetSpatialRef(&reference) != CE_None) FailWriting(file, "cannot store its coordinate system");
  }
  for (const auto& [key, value] : spec.metadata) dataset.SetMetadataItem(key.c_str(), value.c_str());
  dataset.SetMetadataItem(GDALMD_AREA_OR_POINT, GDALMD_AOP_AREA);
  for (int band = 1; band <= spec.bands; ++band) {
    GDALRasterBand& raster = *dataset.GetRasterBand(band);
    if (spec.nodata) raster.SetNoDataValue(*spec.nodata);
    if (!spec.unit.empty()) raster.SetUnitType(spec.unit.c_str());
    if (static_cast<size_t>(band) <= spec.band_names.size()) raster.SetDescription(spec.band_names[static_cast<size_t>(band) - 1].c_str());
  }
}

GeoTiffWriter::~GeoTiffWriter() = default;
GeoTiffWriter::GeoTiffWriter(GeoTiffWriter&&) noexcept = default;

void GeoTiffWriter::Impl::Write(int first_row, int n_rows, const void* values, size_t count, PixelType type) {
  const QuietErrors quiet;
  const size_t expected = static_cast<size_t>(n_rows) * static_cast<size_t>(spec.grid.width) * static_cast<size_t>(spec.bands);
  SKYQUILT_CHECK(dataset != nullptr && type == spec.type && count == expected,
                 std::to_string(count) + " values instead of " + std::to_string(expected));
  const int size = GDALGetDataTypeSizeBytes(TypeOf(type));
  const GSpacing pixel = static_cast<GSpacing>(size) * spec.bands;
  // RasterIO both reads and writes, so its buffer is not const; it does not change the buffer when writing.
  const CPLErr error = dataset->RasterIO(GF_Write, 0, first_row, spec.grid.width, n_rows, const_cast<void*>(values), spec.grid.width, n_rows,
                                         TypeOf(type), spec.bands, nullptr, pixel, pixel * spec.grid.width, size, nullptr);
  if (error != CE_None) FailWriting(file, "cannot be written");
}

void GeoTiffWriter::WriteRows(int first_row, int n_rows, std::span<const uint8_t> values) {
  impl_->Write(first_row, n_rows, values.data(), values.size(), PixelType::kUint8);
}

void GeoTiffWriter::WriteRows(int first_row, int n_rows, std::span<const uint16_t> values) {
  impl_->Write(first_row, n_rows, values.data(), values.size(), PixelType::kUint16);
}

void GeoTiffWriter::WriteRows(int first_row, int n_rows, std::span<const float> values) {
  impl_->Write(first_row, n_rows, values.data(), values.size(), PixelType::kFloat32);
}

// Copies the complete file into a cloud-optimised one: GDAL writes those only as a copy, because the overviews come first.
void GeoTiffWriter::Impl::Rearrange() {
  GDALRegister_COG();
  GDALRegister_VRT();  // in which the COG driver takes alpha for a mask
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("COG");
  SKYQUILT_CHECK(driver != nullptr, "GDAL without cloud-optimised GeoTIFF");
  const Dataset source(GDALDataset::Open(plain->path().c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY));
  if (!source) FailWriting(file, "cannot be read back");
  CPLErrorReset();
  Dataset copy(driver->CreateCopy(cog.path().c_str(), source.get(), FALSE, CogOptions(spec).List(), internal::ContinueUnlessCancelled, nullptr));
  base::ThrowIfCancelled();
  if (!copy || CPLGetLastErrorType() >= CE_Failure) FailWriting(file, "cannot be completed");
  internal::CloseWritten(&copy, file);
}

void GeoTiffWriter::Close() {
  SKYQUILT_CHECK(impl_->dataset != nullptr, "closed twice");
  const QuietErrors quiet;
  internal::CloseWritten(&impl_->dataset, impl_->file);
  impl_->Rearrange();
  impl_->cog.Publish();
  impl_->plain.reset();
}

namespace {

// GDAL's RasterIO has means and medians, but no maximum. Reads row by row. False: see CPLGetLastErrorMsg.
bool ReadMaximum(GDALDataset* dataset, image::ImageF* image) {
  const int cells = dataset->GetRasterXSize(), rows = dataset->GetRasterYSize(), bands = image->channels;
  image::ImageF row(cells, 1, bands);
  // The first and the last of n pixels that a cell touches.
  const auto first = [](int cell, int of_cells, int n) { return static_cast<int>(static_cast<int64_t>(cell) * n / of_cells); };
  const auto last = [](int cell, int of_cells, int n) { return static_cast<int>(((cell + int64_t{1}) * n - 1) / of_cells); };
  std::fill(image->data.begin(), image->data.end(), std::numeric_limits<float>::quiet_NaN());
  for (int y = 0; y < rows; ++y) {
    if (!internal::ReadBands(dataset, {0, y, cells, 1}, row.At(0, 0), {cells, 1}, bands, cells, nullptr)) return false;
    internal::ForgetNoData(dataset, &row);
    for (int x = 0; x < cells; ++x) {
      for (int v = first(y, rows, image->height); v <= last(y, rows, image->height); ++v) {
        for (int u = first(x, cells, image->width); u <= last(x, cells, image->width); ++u) {
          for (int band = 0; band < bands; ++band) {
            float& most = image->At(u, v)[band];
            const float value = row.At(x, 0)[band];
            if (!(most >= value)) most = std::isnan(value) ? most : value;
          }
        }
      }
    }
  }
  return true;
}

// The index of the smallest overview that has at least so many pixels; -1 for the full resolution.
int CoarsestOverview(GDALDataset* dataset, int width, int height) {
  GDALRasterBand& band = *dataset->GetRasterBand(1);
  int best = -1, columns = dataset->GetRasterXSize();
  for (int i = 0; i < band.GetOverviewCount(); ++i) {
    GDALRasterBand& overview = *band.GetOverview(i);
    if (overview.GetXSize() < width || overview.GetYSize() < height || overview.GetXSize() >= columns) continue;
    columns = overview.GetXSize();
    best = i;
  }
  return best;
}

[[noreturn]] void FailReading(const std::filesystem::path& file) {
  throw base::InputError(file, std::string("cannot be read: ") + CPLGetLastErrorMsg(),
                         "Give a GeoTIFF that 'skyquilt render' or 'skyquilt surface' wrote, or make it again");
}

}  // namespace

ReducedRaster ReadReduced(const std::filesystem::path& file, int max_width, Reduction reduction) {
  const QuietErrors quiet;
  GDALRegister_GTiff();
  const auto open = [&](const char* const* options) {
    Dataset dataset(GDALDataset::Open(file.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY, nullptr, options));
    if (!dataset) FailReading(file);
    return dataset;
  };
  Dataset dataset = open(nullptr);
  const int cells = dataset->GetRasterXSize(), rows = dataset->GetRasterYSize();
  const int width = std::min(max_width, cells);
  const int height = std::max(1, static_cast<int>(std::lround(static_cast<double>(rows) * width / cells)));
  const int bands = internal::BandsWithMask(dataset.get());
  ReducedRaster reduced;
  reduced.image = image::ImageF(width, height, bands);
  reduced.scale = static_cast<double>(cells) / width;
  reduced.scale_down = static_cast<double>(rows) / height;
  bool read = false;
  if (reduction == Reduction::kMaximum) {
    read = ReadMaximum(dataset.get(), &reduced.image);
  } else {
    if (const int level = CoarsestOverview(dataset.get(), width, height); level >= 0) {
      CPLStringList options;
      options.SetNameValue("OVERVIEW_LEVEL",
                           (std::to_string(level) + "only").c_str());  // without it GDAL may take one that is up to 1.2 times too coarse
      dataset = open(options.List());
    }
    GDALRasterIOExtraArg extra;
    INIT_RASTERIO_EXTRA_ARG(extra);
    extra.eResampleAlg = GRIORA_Average;
    read = internal::ReadBands(dataset.get(), {0, 0, dataset->GetRasterXSize(), dataset->GetRasterYSize()}, reduced.image.data.data(),
                               {width, height}, bands, width, &extra);
  }
  if (!read) FailReading(file);
  internal::ForgetNoData(dataset.get(), &reduced.image);
  return reduced;
}

}  // namespace skyquilt::gis
