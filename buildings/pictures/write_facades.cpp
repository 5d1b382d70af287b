#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>

#include "buildings/pictures/building_pictures.h"
#include "buildings/pictures/model_view.h"
#include "buildings/pictures/solid_rays.h"
#include "buildings/pictures/wall_sides.h"
#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/image/image.h"

namespace skyquilt::buildings {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kFront_m = 3.0;      // where rays begin
constexpr double kBehind_m = 1.5;     // where they end: windows and blurred walls lie deeper than the wall
constexpr double kNarrowest_m = 1.0;  // of the walls with pictures
constexpr double kLowest_m = 0.5;     // lower ones are steps between roofs
constexpr double kLeastOpacity = 0.5;
constexpr size_t kBatchRays = 1 << 16;
constexpr int kPngLevel = 6;
constexpr int kDigits = 4;  // of lengths

struct PixelRay {
  render::Ray ray;
  size_t pixel = 0;
};

uint8_t ToByte(float display_value) {
  return static_cast<uint8_t>(std::lround(255.0F * std::clamp(display_value, 0.0F, 1.0F)));
}

class FacadePainter {
 public:
  FacadePainter(const WallSide& side, const SolidRays& solid, double pixel_m, base::ThreadPool& threads)
      : side_(side),
        solid_(solid),
        pixel_m_(pixel_m),
        threads_(threads),
        picture_(PixelsFor(side.width_m, pixel_m), PixelsFor(side.height_m, pixel_m), 4) {}

  image::Image8 Paint(const surface::RayCaster& caster) {
    const int rows_at_once = std::max(1, static_cast<int>(kBatchRays / static_cast<size_t>(picture_.width)));
    for (int row = 0; row < picture_.height; row += rows_at_once) {
      base::ThrowIfCancelled();
      Render(caster, RaysOf(row, std::min(row + rows_at_once, picture_.height)));
    }
    return std::move(picture_);
  }

 private:
  // A wall of 5.0000001 m needs no more pixels than one of 5 m.
  static int PixelsFor(double metres, double pixel_m) { return std::max(1, static_cast<int>(std::ceil(metres / pixel_m - 1e-3))); }

  // Only pixels of the wall itself: what is in its plane elsewhere belongs to other parts of the building.
  std::vector<PixelRay> RaysOf(int begin, int end) const {
    std::vector<std::vector<PixelRay>> rows(static_cast<size_t>(end - begin));
    threads_.ParallelFor(end - begin, [&](int64_t task, int) {
      const int row = begin + static_cast<int>(task);
      for (int column = 0; column < picture_.width; ++column) {
        const Eigen::Vector2d place = pixel_m_ * Eigen::Vector2d(column + 0.5, row + 0.5);
        if (!side_.Contains(place)) continue;
        const size_t pixel = static_cast<size_t>(row) * static_cast<size_t>(picture_.width) + static_cast<size_t>(column);
        rows[static_cast<size_t>(task)].push_back({RayTo(side_.At(place)), pixel});
      }
    });
    std::vector<PixelRay> rays;
    for (const auto& row : rows) rays.insert(rays.end(), row.begin(), row.end());
    return rays;
  }

  render::Ray RayTo(const Eigen::Vector3d& wall) const {
    // Halfway to what is opposite, because neither surface is exactly where the model has it.
    constexpr double kOff_m = 0.05;
    const double opposite = kOff_m + solid_.FirstHit(wall + kOff_m * side_.normal, side_.normal);
    const double front = std::min(kFront_m, 0.5 * opposite);
    render::Ray ray;
    ray.origin_enu = wall + front * side_.normal;
    ray.direction_enu = -side_.normal;
    ray.t_far = front + kBehind_m;
    ray.pixel_width = static_cast<float>(pixel_m_);
    return ray;
  }

  void Render(const surface::RayCaster& caster, const std::vector<PixelRay>& pixels) {
    if (pixels.empty()) return;
    std::vector<render::Ray> rays;
    rays.reserve(pixels.size());
    for (const PixelRay& pixel : pixels) rays.push_back(pixel.ray);
    std::vector<render::RayColor> colors(rays.size());
    caster(rays, colors);
    for (size_t i = 0; i < pixels.size(); ++i) {
      const render::RayColor& color = colors[i];
      if (!(static_cast<double>(color.opacity) >= kLeastOpacity)) continue;
      uint8_t* rgba = picture_.data.data() + 4 * pixels[i].pixel;
      // Rendered colours are premultiplied by opacity.
      for (size_t c = 0; c < 3; ++c) {
        const float straight = color.rgb_srgb[c] / color.opacity;
        rgba[c] = std::isfinite(straight) ? ToByte(straight) : uint8_t{0};
      }
      rgba[3] = 255;
    }
  }

  const WallSide& side_;
  const SolidRays& solid_;
  double pixel_m_;
  base::ThreadPool& threads_;
  image::Image8 picture_;
};

double ShareShown(const image::Image8& picture) {
  size_t shown = 0;
  for (size_t i = 3; i < picture.data.size(); i += 4) shown += picture.data[i] != 0 ? 1U : 0U;
  return static_cast<double>(shown) / (static_cast<double>(picture.data.size()) / 4.0);
}

Json Describe(const WallSide& side, const image::Image8& picture, const FileFrame& frame, double pixel_m, const std::string& file) {
  const auto corner = [&](int column, int row) {
    const Eigen::Vector3d x = frame.PositionOf(side.At(pixel_m * Eigen::Vector2d(column, row)));
    return Json::array({x.x(), x.y(), x.z()});
  };
  const Eigen::Vector3f normal = frame.map().MapDirection(side.normal.cast<float>());
  double azimuth = std::atan2(static_cast<double>(normal.x()), static_cast<double>(normal.y())) * 180.0 / std::numbers::pi;
  if (azimuth < 0.0) azimuth += 360.0;
  Json json;
  json["file"] = file;
  json["azimuth_deg"] = azimuth;
  const std::string unit = frame.metric() ? "_m" : "";
  const double scale = frame.scale();
  json["wall_width" + unit] = Rounded(scale * side.width_m, kDigits);
  json["wall_height" + unit] = Rounded(scale * side.height_m, kDigits);
  json["pixel" + unit] = scale * pixel_m;
  json["width_px"] = picture.width;
  json["height_px"] = picture.height;
  json["top_left"] = corner(0, 0);
  json["top_right"] = corner(picture.width, 0);
  json["bottom_right"] = corner(picture.width, picture.height);
  json["bottom_left"] = corner(0, picture.height);
  json["shown"] = ShareShown(picture);
  return json;
}

}  // namespace

std::vector<std::filesystem::path> WriteFacades(const Building& building, const surface::RayCaster& caster, const FileFrame& frame, double pixel_m,
                                                const std::filesystem::path& folder, base::ThreadPool& threads) {
  SKYQUILT_CHECK(pixel_m > 0.0 && std::isfinite(pixel_m), std::to_string(pixel_m) + " m for a pixel of a facade");
  base::RequireWritableFolder(folder);
  const Solid& solid = ModelOf(building);
  const SolidRays rays(solid);
  const std::string name = "facade_" + std::to_string(building.id);
  std::vector<std::filesystem::path> files;
  Json json;
  json["building"] = building.id;
  json["crs"] = frame.CrsName();
  json["vertical"] = frame.VerticalName();
  json["note"] =
      "Corners: easting, northing and height of the corners of each picture. Azimuth: of the wall's outward normal, clockwise from grid north. "
      "Shown: "
      "share of the pixels that are not transparent.";
  json["facades"] = Json::array();
  for (const WallSide& side : WallSidesOf(solid)) {
    if (side.width_m < kNarrowest_m || side.height_m < kLowest_m) continue;
    const image::Image8 picture = FacadePainter(side, rays, pixel_m, threads).Paint(caster);
    const std::string file = name + "_" + std::to_string(files.size() + 1) + ".png";
    base::WriteFileAtomically(folder / file, image::EncodePng(picture, kPngLevel));
    files.push_back(folder / file);
    json["facades"].push_back(Describe(side, picture, frame, pixel_m, file));
  }
  // Last, so that it never names a picture that is not there.
  files.push_back(folder / (name + ".json"));
  base::WriteFileAtomically(files.back(), base::JsonText(json, 2) + "\n");
  return files;
}

}  // namespace skyquilt::buildings
