#include "core/gis/derived_maps.h"

#include <gdal_utils.h>

#include <algorithm>
#include <cmath>

#include "core/gis/gdal_support.h"
#include "core/gis/geotiff.h"
#include "core/gis/map_projection.h"
#include "core/gis/read_maps.h"

namespace skyquilt::gis {
namespace {

constexpr int kColumnsAtOnce = 4096;
constexpr int kOrthophotoQuality = 90;

internal::Dataset OpenMap(const std::filesystem::path& file) {
  GDALRegister_GTiff();
  internal::Dataset dataset(GDALDataset::Open(file.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY));
  if (!dataset) throw base::InputError(file, std::string("cannot be read: ") + CPLGetLastErrorMsg(), "Make the map again");
  return dataset;
}

// What of a map is not in its cells.
GeoTiffSpec SpecOf(const std::filesystem::path& file) {
  const internal::QuietErrors quiet;
  const internal::Dataset dataset = OpenMap(file);
  GeoTiffSpec spec;
  spec.grid = ReadMapGrid(file);
  spec.bands = internal::BandsWithMask(dataset.get());
  GDALRasterBand& band = *dataset->GetRasterBand(1);
  spec.type = band.GetRasterDataType() == GDT_Byte ? PixelType::kUint8 : PixelType::kFloat32;
  if (spec.type == PixelType::kUint8 && spec.bands > dataset->GetRasterCount()) spec.jpeg_quality = kOrthophotoQuality;
  int has_nodata = FALSE;
  const double nodata = band.GetNoDataValue(&has_nodata);
  if (has_nodata != FALSE) spec.nodata = nodata;
  spec.unit = band.GetUnitType();
  for (int i = 1; i <= dataset->GetRasterCount(); ++i) spec.band_names.emplace_back(dataset->GetRasterBand(i)->GetDescription());
  for (char** item = dataset->GetMetadata(); item != nullptr && *item != nullptr; ++item) {
    const std::string text = *item;
    const size_t equals = text.find('=');
    if (equals != std::string::npos && text.substr(0, equals) != GDALMD_AREA_OR_POINT)
      spec.metadata[text.substr(0, equals)] = text.substr(equals + 1);
  }
  if (const OGRSpatialReference* reference = dataset->GetSpatialRef(); reference != nullptr && reference->IsCompound() != 0) {
    spec.heights = geo::HeightReference::kEgm96;  // the only heights that become part of a map's CRS (GeoTiffSpec::heights)
  }
  return spec;
}

// NaN: no data.
float StoredHeight(float value, const GeoTiffSpec& spec) {
  return std::isnan(value) && spec.nodata ? static_cast<float>(*spec.nodata) : value;
}

uint8_t StoredByte(float value) {
  return std::isnan(value) ? uint8_t{0} : static_cast<uint8_t>(std::clamp(std::round(value), 0.0F, 255.0F));
}

}  // namespace

void WriteCoarserMap(const std::filesystem::path& from, const std::filesystem::path& to, double cell_m) {
  GeoTiffSpec spec = SpecOf(from);
  const MapGrid fine = spec.grid;
  SKYQUILT_CHECK(cell_m >= fine.resolution_m, std::to_string(cell_m));
  MapExtent extent;
  extent.low = {fine.left, fine.top - fine.height * fine.resolution_m};
  extent.high = {fine.left + fine.width * fine.resolution_m, fine.top};
  extent.SetCells(cell_m, &spec.grid);
  const MapGrid& grid = spec.grid;
  GeoTiffWriter writer(to, spec);
  const auto bands = static_cast<size_t>(spec.bands);
  for (int row = 0; row < grid.height; row += GeoTiffWriter::kTile) {
    const int rows = std::min(GeoTiffWriter::kTile, grid.height - row);
    std::vector<uint8_t> bytes;
    std::vector<float> heights;
    const size_t values = static_cast<size_t>(rows) * static_cast<size_t>(grid.width) * bands;
    spec.type == PixelType::kUint8 ? bytes.resize(values) : heights.resize(values);
    for (int column = 0; column < grid.width; column += kColumnsAtOnce) {
      base::ThrowIfCancelled();
      const int columns = std::min(kColumnsAtOnce, grid.width - column);
      const Eigen::Vector2d low(grid.left + column * cell_m, grid.top - (row + rows) * cell_m);
      const image::ImageF part = ReadMapPart(from, {low, low + cell_m * Eigen::Vector2d(columns, rows)}, columns, rows);
      for (int y = 0; y < rows; ++y) {
        for (int x = 0; x < columns; ++x) {
          for (size_t band = 0; band < bands; ++band) {
            const size_t at = (static_cast<size_t>(y) * static_cast<size_t>(grid.width) + static_cast<size_t>(column + x)) * bands + band;
            const float value = part.At(x, y)[band];
            if (spec.type == PixelType::kUint8) {
              bytes[at] = StoredByte(value);
            } else {
              heights[at] = StoredHeight(value, spec);
            }
          }
        }
      }
    }
    spec.type == PixelType::kUint8 ? writer.WriteRows(row, rows, bytes) : writer.WriteRows(row, rows, heights);
  }
  writer.Close();
}

void WriteMapPicture(const std::filesystem::path& from, const std::filesystem::path& png) {
  const internal::QuietErrors quiet;
  GDALRegister_PNG();
  GDALRegister_VRT();
  const internal::Dataset map = OpenMap(from);
  // GDAL names the world file after the picture, so the picture has another name until both are there.
  base::PartialPath picture(png, png.parent_path() / (png.stem().string() + ".partial.png"));
  base::PartialPath world(std::filesystem::path(png).replace_extension(".wld"), std::filesystem::path(picture.path()).replace_extension(".wld"));
  CPLStringList words;
  for (const char* word : {"-of", "PNG", "-co", "WORLDFILE=YES", "-co", "ZLEVEL=6", "-b", "1", "-b", "2", "-b", "3", "-b"}) words.AddString(word);
  words.AddString(map->GetRasterCount() >= 4 ? "4" : "mask");
  words.AddString("-colorinterp_4");
  words.AddString("alpha");
  const std::unique_ptr<GDALTranslateOptions, void (*)(GDALTranslateOptions*)> options(GDALTranslateOptionsNew(words.List(), nullptr),
                                                                                       GDALTranslateOptionsFree);
  SKYQUILT_CHECK(options != nullptr, "GDAL does not know these options");
  GDALTranslateOptionsSetProgress(options.get(), internal::ContinueUnlessCancelled, nullptr);
  // Else statistics and the CRS go to a third file.
  CPLSetThreadLocalConfigOption("GDAL_PAM_ENABLED", "NO");
  internal::Dataset made(GDALDataset::FromHandle(GDALTranslate(picture.path().c_str(), GDALDataset::ToHandle(map.get()), options.get(), nullptr)));
  CPLSetThreadLocalConfigOption("GDAL_PAM_ENABLED", nullptr);
  base::ThrowIfCancelled();
  if (!made) internal::FailWriting(png, "cannot be made");
  internal::CloseWritten(&made, png);
  world.Publish();
  picture.Publish();
}

}  // namespace skyquilt::gis
