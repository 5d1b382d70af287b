#include "tour/pictures/render_picture.h"

#include <algorithm>
#include <fstream>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/checkpoint/user_block.h"
#include "products/render_views.h"

namespace skyquilt::tour {

namespace {

// As in scene.cpp: ranks wait for each other at the end of each batch.
constexpr size_t kRaysOfRanks = 1 << 20;

// The beginning of an archive has the length and the digest of all that follows.
std::string IdentityOf(const std::filesystem::path& scene_h5) {
  std::string text(checkpoint::kUserBlockBytes, '\0');
  std::ifstream stream(scene_h5, std::ios::binary);
  if (!stream.read(text.data(), static_cast<std::streamsize>(text.size()))) {
    throw base::InputError(scene_h5, "cannot be read any more", "Leave the scene in its place while its tour is made");
  }
  return text;
}

}  // namespace

PictureField FieldOf(const scene::Scene& scene, const std::filesystem::path& scene_h5, bool plain_surround, base::ThreadPool& threads) {
  PictureField field;
  field.identity = IdentityOf(scene_h5) + (plain_surround ? " plain surround" : "");
  field.cones = scene.info().scales.Cones();
  if (scene.statistics().ranks > 1) field.batch_rays = kRaysOfRanks;
  field.caster = [&scene, &threads, plain_surround](const std::string& exposure) {
    scene::Appearance appearance = products::AppearanceOf(exposure, scene.info());
    appearance.plain_surround = plain_surround;
    return products::BackgroundCasterOf(scene, appearance, threads);
  };
  return field;
}

RenderedPicture RenderPicture(const PictureRequest& request, const PictureField& field, const products::RayCaster& caster,
                              const std::function<void(int64_t rays)>& on_rays) {
  const PictureRays picture_rays(request, field.cones);
  const std::vector<size_t> order = PixelsInOrder(request);
  const Eigen::Vector3d axis_enu = request.cam_from_enu.conjugate() * Eigen::Vector3d::UnitZ();
  RenderedPicture picture;
  picture.color = image::Image8(request.width, request.height, 3);
  picture.depth_m.resize(order.size());
  std::vector<render::Ray> rays;
  std::vector<render::RayColor> colors;
  for (size_t first = 0; first < order.size(); first += rays.size()) {
    base::ThrowIfCancelled();
    const size_t count = std::min(std::max<size_t>(1, field.batch_rays), order.size() - first);
    const std::span<const size_t> pixels = std::span(order).subspan(first, count);
    rays.resize(count);
    colors.assign(count, render::RayColor{});
    picture_rays.Make(pixels, rays);
    caster(rays, colors);
    const image::Image8 some = products::ColorImage(colors, static_cast<int>(count), 1);
    for (size_t i = 0; i < count; ++i) {
      std::copy_n(&some.data[3 * i], 3, &picture.color.data[3 * pixels[i]]);
      const double along = request.kind == PictureKind::kStill ? axis_enu.dot(rays[i].direction_enu) : 1.0;
      picture.depth_m[pixels[i]] = static_cast<float>(along * static_cast<double>(colors[i].depth_median));
    }
    on_rays(static_cast<int64_t>(count));
  }
  return picture;
}

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
