#include "tour/pictures/render_picture.h"

#include <algorithm>
#include <span>

#include "core/base/cancel.h"
#include "products/render_views.h"
#include "tour/pictures/picture_rays.h"

namespace skyquilt::tour {

RenderedPicture RenderPicture(const PictureRequest& request, const PictureField& field, const products::RayCaster& caster,
                              const std::function<void(int64_t rays)>& on_rays) {
  const PictureRays maker(request, field.cones);
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
    maker.Make(pixels, rays);
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

}  // namespace skyquilt::tour
