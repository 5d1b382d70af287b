// Orthophotos of the patterned survey, on a field that is right about the surface.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/gis/geotiff.h"
#include "products/map_products.h"
#include "tests/products/patterned_survey.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::products {

class PhotoOrthophotoTest : public testing::Test {
 protected:
  static scene::SceneInfo Info() {
    scene::SceneInfo info;
    info.origin = {47.0, 8.0, 400.0};
    info.gsd_m = 0.46;
    scene::SceneBlock block;
    block.name = "r0c0";
    block.min_enu = {-28.0, -22.0, 0.0};
    block.max_enu = {28.0, 22.0, 12.0};
    info.blocks = {block};
    info.min_enu = block.min_enu;
    info.max_enu = block.max_enu;
    return info;
  }
  // The field is right about the surface, and shows its colours without detail.
  static void Field(std::span<const render::Ray> rays, std::span<render::RayColor> out) {
    for (size_t i = 0; i < rays.size(); ++i) {
      const Eigen::Vector3d& from = rays[i].origin_enu;
      const double t = (PatternedSurvey::SurfaceZ(from.x(), from.y()) - from.z()) / rays[i].direction_enu.z();
      out[i].opacity = 1.0F;
      out[i].depth = out[i].depth_median = out[i].depth_front = out[i].depth_back = static_cast<float>(t);
      const std::array<double, 3> color = PatternedSurvey::Color(from.x(), from.y());
      for (size_t c = 0; c < 3; ++c) out[i].rgb_srgb[c] = static_cast<float>(color[c]);
    }
  }
  MapProducts Make(const survey::Survey& survey, const ProductOptions& options = {}, int n_threads = 2, size_t memory = size_t{1} << 30) {
    base::ThreadPool threads(n_threads);
    const MapPhotos photos{survey, memory, threads, elsewhere_};
    const MapProducts made = MakeMapProducts(Info(), caster_, options, folder_ / "products", &photos);
    map_ = gis::ReadReduced(folder_ / "products/orthophoto.tif", 1 << 20).image;
    return made;
  }
  const float* At(const gis::MapGrid& grid, double x, double y) const {
    const Eigen::Vector2d cell = grid.CellOf({x, y}).array().round().matrix();
    return map_.At(static_cast<int>(cell.x()), static_cast<int>(cell.y()));
  }
  std::vector<double> Errors(const gis::MapGrid& grid) const {
    std::vector<double> errors;
    for (double x = PatternedSurvey::kWest; x <= PatternedSurvey::kEast; x += 0.3) {
      for (double y = PatternedSurvey::kSouth; y <= PatternedSurvey::kNorth; y += 0.3) {
        // The surface has cells of half a metre.
        if (PatternedSurvey::InHouse(x, y, 0.75) && !PatternedSurvey::InHouse(x, y, -0.75)) continue;
        const float* rgba = At(grid, x, y);
        EXPECT_EQ(rgba[3], 255.0F) << x << " " << y;
        const std::array<double, 3> color = PatternedSurvey::Color(x, y);
        for (size_t c = 0; c < 3; ++c) errors.push_back(std::abs(static_cast<double>(rgba[c]) - 255.0 * color[c]));
      }
    }
    return errors;
  }
  nlohmann::ordered_json Sources() const { return base::ParseJson(base::ReadFile(folder_ / "products/ortho_sources.json")); }

  TemporaryFolder folder_;
  RayCaster caster_ = Field;
  TileService* elsewhere_ = nullptr;
  image::ImageF map_;
};

}  // namespace skyquilt::products
