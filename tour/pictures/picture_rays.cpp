#include "tour/pictures/picture_rays.h"

namespace skyquilt::tour {
namespace {

std::variant<PanoramaRays, scene::CameraRays> RaysOf(const PictureRequest& request, bool cones) {
  if (request.kind == PictureKind::kPanorama) return PanoramaRays(request.eye_enu, request.width);
  const products::View view = ViewOfStill(request);
  return scene::CameraRays(view.camera, view.cam_from_enu, cones);
}

}  // namespace

PictureRays::PictureRays(const PictureRequest& request, bool cones) : rays_(RaysOf(request, cones)) {}

void PictureRays::Make(std::span<const size_t> pixels, std::span<render::Ray> out) const {
  std::visit([&](const auto& rays) { rays.Make(pixels, out); }, rays_);
}

std::vector<size_t> PixelsInOrder(const PictureRequest& request) {
  if (request.kind == PictureKind::kPanorama) return PanoramaOrder(request.width);
  std::vector<size_t> pixels;
  scene::AppendTilePixels(request.width, request.height, 0, scene::TileCount(request.width, request.height), &pixels);
  return pixels;
}

}  // namespace skyquilt::tour
