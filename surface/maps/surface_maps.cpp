#include "surface/maps/surface_maps.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "core/base/cancel.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "core/gis/contours.h"
#include "core/gis/geotiff.h"
#include "surface/maps/contour_raster.h"
#include "surface/maps/find_terrain.h"
#include "surface/maps/hillshade.h"

namespace skyquilt::surface {
namespace {

constexpr float kNoData = -9999.0F;
constexpr const char* kCogFormat = "GeoTIFF (COG)";

struct MapText {
  const char* file;
  const char* content;
  const char* band;
  const char* description;
  std::string vertical;       // what the heights are above; empty: the values are no heights
  bool in_map_frame = false;  // they are heights of the maps' CRS
};

class MapWriter {
 public:
  MapWriter(const MapFrame& frame, const gis::MapGrid& grid, const std::filesystem::path& folder) : frame_(frame), grid_(grid), folder_(folder) {}

  // value(cell): the value of a cell, no data for those without.
  template <typename T, typename Value>
  void Write(const MapText& text, T no_data, const Value& value) {
    gis::GeoTiffSpec spec;
    spec.grid = grid_;
    spec.type = sizeof(T) == 1 ? gis::PixelType::kUint8 : gis::PixelType::kFloat32;
    spec.nodata = static_cast<double>(no_data);
    spec.band_names = {text.band};
    spec.metadata["TIFFTAG_SOFTWARE"] = "skyquilt";
    spec.metadata["TIFFTAG_IMAGEDESCRIPTION"] = text.description;
    if (spec.type == gis::PixelType::kFloat32) {
      spec.unit = "m";
      spec.metadata["VERTICAL_REFERENCE"] = text.vertical;
      if (text.in_map_frame) {
        spec.heights = frame_.heights().reference();
        spec.metadata.merge(frame_.heights().Metadata());
      }
    }
    gis::GeoTiffWriter writer(folder_ / text.file, spec);
    std::vector<T> values;
    const auto width = static_cast<size_t>(grid_.width);
    for (int first = 0; first < grid_.height; first += gis::GeoTiffWriter::kTile) {
      base::ThrowIfCancelled();
      const int rows = std::min(gis::GeoTiffWriter::kTile, grid_.height - first);
      values.clear();
      const size_t begin = static_cast<size_t>(first) * width;
      for (size_t cell = begin; cell < begin + static_cast<size_t>(rows) * width; ++cell) values.push_back(value(cell));
      writer.WriteRows(first, rows, std::span<const T>(values));
    }
    writer.Close();
    Add(text.file, text.content, kCogFormat, text.vertical, fmt::format("cells of {:.6g} m", grid_.resolution_m));
  }

  void Add(const char* name, const char* content, const char* format, const std::string& vertical, const std::string& detail) {
    files_.push_back({.file = name,
                      .content = content,
                      .format = format,
                      .crs = frame_.CrsName(),
                      .vertical = vertical,
                      .bytes = static_cast<int64_t>(std::filesystem::file_size(folder_ / name)),
                      .detail = detail});
  }
  std::vector<WrittenFile> TakeFiles() { return std::move(files_); }

 private:
  const MapFrame& frame_;
  gis::MapGrid grid_;
  std::filesystem::path folder_;
  std::vector<WrittenFile> files_;
};

TerrainOptions TerrainOptionsOf(const SurfaceOptions& options) {
  return {.cell_m = options.terrain_cell_m,
          .window_m = options.terrain_window_m,
          .slope = options.terrain_slope,
          .low_m = options.terrain_low_m,
          .high_m = options.terrain_high_m};
}

}  // namespace

SurfaceMaps MakeSurfaceMaps(const HeightRaster& surface, const MapFrame& frame, const std::optional<gis::Boundary>& boundary,
                            const SurfaceOptions& options, const std::filesystem::path& folder, base::ThreadPool& threads) {
  SurfaceMaps maps;
  maps.terrain.grid = surface.grid;
  if (surface.height_m.empty()) {
    base::LogWarning("the surface has no cells, so no maps are made of it");
    return maps;
  }
  if (options.maps) base::RequireWritableFolder(folder);
  maps.terrain = FindTerrain(surface, TerrainOptionsOf(options)).height;
  if (!options.maps) return maps;
  const std::vector<uint8_t> mask = boundary ? boundary->Mask(surface.grid) : std::vector<uint8_t>();
  const auto inside = [&](size_t cell) { return mask.empty() || mask[cell] != 0; };
  const std::vector<float>& ground = maps.terrain.height_m;

  MapWriter writer(frame, surface.grid, folder);
  writer.Write<float>({.file = "dtm.tif",
                       .content = "terrain model",
                       .band = "height of the ground",
                       .description = "Digital terrain model: height of the ground without what stands on it.",
                       .vertical = frame.VerticalName(),
                       .in_map_frame = true},
                      kNoData, [&](size_t cell) { return inside(cell) && std::isfinite(ground[cell]) ? ground[cell] : kNoData; });
  writer.Write<float>({.file = "height_above_ground.tif",
                       .content = "height above ground",
                       .band = "height above ground",
                       .description = "Height of the surface above the ground.",
                       .vertical = "ground of dtm.tif"},
                      kNoData, [&](size_t cell) {
                        const float above = surface.height_m[cell] - ground[cell];
                        return inside(cell) && std::isfinite(above) ? std::max(0.0F, above) : kNoData;
                      });
  {
    const std::vector<uint8_t> shade = Hillshade(surface, threads);
    writer.Write<uint8_t>({.file = "hillshade.tif",
                           .content = "hillshade",
                           .band = "brightness",
                           .description = "Shaded relief of the surface, light from the north-west, 45 degrees high.",
                           .vertical = ""},
                          uint8_t{0}, [&](size_t cell) { return inside(cell) ? shade[cell] : uint8_t{0}; });
  }
  const ContourRaster contours = MakeContourRaster(maps.terrain, mask, options.terrain_cell_m);
  const double wanted_m = options.contour_interval_m > 0.0 ? options.contour_interval_m : contours.interval_m;
  const double interval_m = gis::AllowedContourInterval(contours.heights.height_m, wanted_m);
  const int64_t lines = gis::WriteContours(contours.heights.grid, contours.heights.height_m, wanted_m, frame.VerticalName(), folder / "contours.gpkg",
                                           frame.heights().Metadata());
  if (lines == 0) base::LogInfo("the ground is too level for contour lines every {:.6g} m", interval_m);
  writer.Add("contours.gpkg", "contour lines", "GeoPackage", frame.VerticalName(), fmt::format("{} lines every {:.6g} m", lines, interval_m));
  maps.files = writer.TakeFiles();
  return maps;
}

}  // namespace skyquilt::surface
