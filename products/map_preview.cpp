#include "products/map_preview.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/order_statistics.h"
#include "core/gis/geotiff.h"
#include "core/survey/geo_fit.h"
#include "core/trust/trust.h"
#include "products/place_metadata.h"

namespace skyquilt::products {
namespace {

constexpr int kPngLevel = 3;  // of compression
constexpr int kLattice = 32;  // exactly projected points per side, less one; linear in between

// Cell coordinates in the map for each pixel of a preview over the scene's box.
class CellLookup {
 public:
  CellLookup(const scene::SceneInfo& info, const gis::MapGrid& grid, int width, int height) : width_(width), height_(height) {
    const gis::MapProjection projection(info.origin, grid);
    const double z = 0.5 * (info.min_enu.z() + info.max_enu.z());
    for (int j = 0; j <= kLattice; ++j) {
      for (int i = 0; i <= kLattice; ++i) {
        const double x = info.min_enu.x() + (info.max_enu.x() - info.min_enu.x()) * i / kLattice;
        const double y = info.max_enu.y() - (info.max_enu.y() - info.min_enu.y()) * j / kLattice;
        nodes_.push_back(grid.CellOf(projection.EastingNorthing({x, y, z})));
      }
    }
  }
  Eigen::Vector2d At(int x, int y) const {
    const double u = (x + 0.5) / width_ * kLattice;
    const double v = (y + 0.5) / height_ * kLattice;
    const int i = std::min(static_cast<int>(u), kLattice - 1);
    const int j = std::min(static_cast<int>(v), kLattice - 1);
    const double fu = u - i;
    const double fv = v - j;
    return (1 - fv) * ((1 - fu) * Node(j, i) + fu * Node(j, i + 1)) + fv * ((1 - fu) * Node(j + 1, i) + fu * Node(j + 1, i + 1));
  }

 private:
  const Eigen::Vector2d& Node(int j, int i) const { return nodes_[static_cast<size_t>(j) * (kLattice + 1) + static_cast<size_t>(i)]; }
  int width_;
  int height_;
  std::vector<Eigen::Vector2d> nodes_;
};

// The pixel of the reduced map at a cell of the full map; null outside.
const float* Sample(const gis::ReducedRaster& raster, const Eigen::Vector2d& cell) {
  const double x = std::floor((cell.x() + 0.5) / raster.scale);
  const double y = std::floor((cell.y() + 0.5) / raster.scale_down);
  if (!(x >= 0.0 && y >= 0.0 && x < raster.image.width && y < raster.image.height)) return nullptr;
  return raster.image.At(static_cast<int>(x), static_cast<int>(y));
}

// With alpha.
image::Image8 OrthophotoPreview(const gis::ReducedRaster& raster, const CellLookup& lookup, int width, int height) {
  image::Image8 preview(width, height, 4, 255);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float* rgba = Sample(raster, lookup.At(x, y));
      if (rgba == nullptr || rgba[3] < 128.0F) {
        preview.At(x, y)[3] = 0;
        continue;
      }
      for (int c = 0; c < 3; ++c) preview.At(x, y)[c] = static_cast<uint8_t>(std::lround(std::clamp(rgba[c], 0.0F, 255.0F)));
    }
  }
  return preview;
}

// Value interpolated between the four nearest pixels, because the relief would show the pixel grid otherwise. NaN where the nearest is NaN.
float SmoothSample(const gis::ReducedRaster& raster, const Eigen::Vector2d& cell) {
  const float* nearest = Sample(raster, cell);
  if (nearest == nullptr) return std::numeric_limits<float>::quiet_NaN();
  const double x = std::clamp((cell.x() + 0.5) / raster.scale - 0.5, 0.0, raster.image.width - 1.0);
  const double y = std::clamp((cell.y() + 0.5) / raster.scale_down - 0.5, 0.0, raster.image.height - 1.0);
  const int x0 = static_cast<int>(x);
  const int y0 = static_cast<int>(y);
  const int x1 = std::min(x0 + 1, raster.image.width - 1);
  const int y1 = std::min(y0 + 1, raster.image.height - 1);
  const auto u = static_cast<float>(x - x0);
  const auto v = static_cast<float>(y - y0);
  const float smooth = (1 - v) * ((1 - u) * *raster.image.At(x0, y0) + u * *raster.image.At(x1, y0)) +
                       v * ((1 - u) * *raster.image.At(x0, y1) + u * *raster.image.At(x1, y1));
  return std::isfinite(*nearest) && std::isfinite(smooth) ? smooth : *nearest;
}

image::ImageF SmoothPreview(const gis::ReducedRaster& raster, const CellLookup& lookup, int width, int height) {
  image::ImageF preview(width, height, 1);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) *preview.At(x, y) = SmoothSample(raster, lookup.At(x, y));
  }
  return preview;
}

// Width and height, in pixels, of a picture of the scene's box.
std::pair<int, int> PictureSize(const scene::SceneInfo& info, const gis::MapGrid& grid, int max_width) {
  const Eigen::Vector2d extent = (info.max_enu - info.min_enu).head<2>();
  const int full_width = std::max(1, static_cast<int>(std::ceil(extent.x() / grid.resolution_m)));
  const int width = std::min(max_width, full_width);
  return {width, std::clamp(static_cast<int>(std::lround(width * extent.y() / extent.x())), 1, 8 * max_width)};
}

// Central difference; one-sided at the edge of the data, 0 for a pixel without neighbours.
double Slope(const image::ImageF& height, int x, int y, int dx, int dy, double cell_m) {
  const auto at = [&](int px, int py) {
    const bool inside = px >= 0 && py >= 0 && px < height.width && py < height.height;
    return inside ? static_cast<double>(*height.At(px, py)) : std::numeric_limits<double>::quiet_NaN();
  };
  const double here = at(x, y);
  const double before = at(x - dx, y - dy);
  const double after = at(x + dx, y + dy);
  if (std::isfinite(before) && std::isfinite(after)) return (after - before) / (2.0 * cell_m);
  if (std::isfinite(after)) return (after - here) / cell_m;
  if (std::isfinite(before)) return (here - before) / cell_m;
  return 0.0;
}

}  // namespace

image::Image8 ShadedRelief(const image::ImageF& height_m, double cell_m) {
  std::vector<float> finite;
  for (const float value : height_m.data) {
    if (std::isfinite(value)) finite.push_back(value);
  }
  image::Image8 relief(height_m.width, height_m.height, 3, 255);
  if (finite.empty()) return relief;
  const auto rank = [&finite](double share) { return static_cast<size_t>(share * static_cast<double>(finite.size() - 1)); };
  const float low = base::OrderStatistic(finite, rank(0.02));
  const float high = std::max(base::OrderStatistic(finite, rank(0.98)), low + 1e-3F);
  const image::Image8 colored = image::Colorize(height_m, low, high);
  const Eigen::Vector3d light = Eigen::Vector3d(-1.0, 1.0, std::sqrt(2.0)).normalized();
  for (int y = 0; y < height_m.height; ++y) {
    for (int x = 0; x < height_m.width; ++x) {
      if (!std::isfinite(*height_m.At(x, y))) continue;
      const double to_east = Slope(height_m, x, y, 1, 0, cell_m);
      const double to_north = -Slope(height_m, x, y, 0, 1, cell_m);
      const double shade = 0.35 + 0.65 * std::max(0.0, Eigen::Vector3d(-to_east, -to_north, 1.0).normalized().dot(light)) * std::sqrt(2.0);
      for (int c = 0; c < 3; ++c) {
        const double value = static_cast<double>(colored.At(x, y)[c]) * shade;
        relief.At(x, y)[c] = static_cast<uint8_t>(std::lround(std::min(value, 255.0)));
      }
    }
  }
  return relief;
}

void WriteOrthophotoPicture(const scene::SceneInfo& info, const gis::MapGrid& grid, const std::filesystem::path& orthophoto,
                            const std::filesystem::path& png, int max_width) {
  const auto [width, height] = PictureSize(info, grid, max_width);
  const CellLookup lookup(info, grid, width, height);
  const image::Image8 picture = OrthophotoPreview(gis::ReadReduced(orthophoto, max_width), lookup, width, height);
  base::WriteFileAtomically(png, image::EncodePng(picture, kPngLevel));
}

void WriteTrustPicture(const scene::SceneInfo& info, const gis::MapGrid& grid, const std::filesystem::path& trust_map,
                       const std::filesystem::path& png, int max_width) {
  const auto [width, height] = PictureSize(info, grid, max_width);
  const image::ImageF error = SmoothPreview(gis::ReadReduced(trust_map, max_width), CellLookup(info, grid, width, height), width, height);
  image::Image8 picture = image::Colorize(error, 0.0F, trust::kTopError);
  for (size_t i = 0; i < error.data.size(); ++i) {
    if (!std::isfinite(error.data[i])) std::fill_n(picture.data.begin() + static_cast<std::ptrdiff_t>(3 * i), 3, uint8_t{255});
  }
  base::WriteFileAtomically(png, image::EncodePng(picture, kPngLevel));
}

void WriteMapBounds(const scene::SceneInfo& info, const gis::MapGrid& grid, const std::filesystem::path& file, const std::string& preview) {
  nlohmann::ordered_json bounds = {{"min_enu", {info.min_enu.x(), info.min_enu.y()}},
                                   {"max_enu", {info.max_enu.x(), info.max_enu.y()}},
                                   {"resolution_m", grid.resolution_m},
                                   {"crs", grid.georeferenced ? "EPSG:" + std::to_string(grid.zone.Epsg()) : "local"},
                                   {"georeference", NameOfGeoreference(info)},
                                   {"accuracy", survey::ToJson(info.accuracy)}};
  if (!preview.empty()) bounds["preview"] = preview;
  base::WriteFileAtomically(file, base::JsonText(bounds, 1) + "\n");
}

void WriteMapPreviews(const scene::SceneInfo& info, const gis::MapGrid& ortho_grid, const std::filesystem::path& orthophoto,
                      const gis::MapGrid& dsm_grid, const std::filesystem::path& dsm, const std::filesystem::path& folder, int preview_width) {
  if (!orthophoto.empty()) WriteOrthophotoPicture(info, ortho_grid, orthophoto, folder / "orthophoto.png", preview_width);
  if (!dsm.empty()) {
    const auto [width, height] = PictureSize(info, dsm_grid, preview_width);
    const CellLookup lookup(info, dsm_grid, width, height);
    const double pixel_m = (info.max_enu.x() - info.min_enu.x()) / width;
    image::SavePng(ShadedRelief(SmoothPreview(gis::ReadReduced(dsm, preview_width), lookup, width, height), pixel_m), folder / "dsm.png");
  }
  WriteMapBounds(info, ortho_grid, folder / "orthophoto.json");
}

}  // namespace skyquilt::products
