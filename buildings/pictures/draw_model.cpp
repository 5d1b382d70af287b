#include <algorithm>
#include <array>
#include <string>

#include "buildings/pictures/building_pictures.h"
#include "buildings/pictures/line_layer.h"
#include "buildings/pictures/model_view.h"
#include "core/base/errors.h"

namespace skyquilt::buildings {
namespace {

// Bright lines with a dark border can be read on snow and on tar.
constexpr std::array<uint8_t, 3> kDark = {16, 18, 24}, kRoofLine = {255, 214, 10}, kWallLine = {120, 225, 255};
constexpr double kLine_px = 2.0, kHiddenLine_px = 1.0, kBorder_px = 1.2;
constexpr double kBorderOpacity = 0.75, kHiddenOpacity = 0.6, kHiddenBorderOpacity = 0.35;
constexpr double kUsualSize_px = 700.0;  // of a part; lines grow with larger ones, which are shown smaller

struct Layers {
  LineLayer border, roof, wall;

  Layers(int width, int height) : border(width, height), roof(width, height), wall(width, height) {}
  void Add(const ViewedPiece& piece, const Eigen::Vector2d& corner, double width_px, double border_px) {
    for (size_t i = 1; i < piece.points.size(); ++i) {
      const Eigen::Vector2d a = piece.points[i - 1] - corner, b = piece.points[i] - corner;
      border.Add(a, b, width_px + 2.0 * border_px);
      (piece.roof ? roof : wall).Add(a, b, width_px);
    }
  }
};

image::Image8 Cut(const image::Image8& picture, const PhotoPart& part) {
  image::Image8 cut(part.width, part.height, 3);
  for (int y = 0; y < part.height; ++y) std::copy_n(picture.At(part.left, part.top + y), 3 * static_cast<size_t>(part.width), cut.At(0, y));
  return cut;
}

}  // namespace

image::Image8 DrawModel(const Building& building, const image::Image8& picture, const camera::Camera& camera, const geo::Rigid3d& cam_from_enu,
                        const PhotoPart& part) {
  SKYQUILT_CHECK(
      picture.channels == 3 && picture.width == camera.width && picture.height == camera.height,
      "a model is drawn into an RGB picture of the camera's size, not " + std::to_string(picture.width) + " x " + std::to_string(picture.height));
  SKYQUILT_CHECK(part.left >= 0 && part.top >= 0 && part.width >= 0 && part.height >= 0 && part.width <= picture.width - part.left &&
                     part.height <= picture.height - part.top,
                 "the part must be inside the picture");
  if (part.width == 0 || part.height == 0) return image::Image8(0, 0, 3);
  image::Image8 drawn = Cut(picture, part);
  const double scale = std::clamp(std::max(part.width, part.height) / kUsualSize_px, 1.0, 4.0);
  Layers hidden(part.width, part.height), visible(part.width, part.height);
  for (const ViewedPiece& piece : ViewEdges(ModelOf(building), camera, cam_from_enu)) {
    (piece.hidden ? hidden : visible)
        .Add(piece, Eigen::Vector2d(part.left, part.top), scale * (piece.hidden ? kHiddenLine_px : kLine_px), scale * kBorder_px);
  }
  hidden.border.BlendInto(&drawn, kDark, kHiddenBorderOpacity);
  hidden.wall.BlendInto(&drawn, kWallLine, kHiddenOpacity);
  hidden.roof.BlendInto(&drawn, kRoofLine, kHiddenOpacity);
  visible.border.BlendInto(&drawn, kDark, kBorderOpacity);
  visible.wall.BlendInto(&drawn, kWallLine, 1.0);
  visible.roof.BlendInto(&drawn, kRoofLine, 1.0);
  return drawn;
}

}  // namespace skyquilt::buildings
