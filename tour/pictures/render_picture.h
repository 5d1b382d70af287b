// Renders one picture from the field.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/image/image.h"
#include "core/scene/camera_rays.h"
#include "core/scene/scene.h"
#include "products/ray_caster.h"
#include "tour/pictures/panorama_rays.h"
#include "tour/pictures/picture_request.h"

namespace skyquilt::tour {

// What pictures are rendered from. A test needs no scene for it.
struct PictureField {
  std::string identity;         // another one when the scene's content or its surround is another
  bool cones = false;           // scene::Scales::Cones
  size_t batch_rays = 1 << 17;  // rendered at a time
  // Renders rays over the background in an exposure that is given as products.exposure. Throws base::UsageError for one that is not allowed.
  std::function<products::RayCaster(const std::string& exposure)> caster;
};

// Of a scene that was loaded from this file, on this process or on other ranks, in memory or paged. Keeps references to scene and threads.
// plain_surround: see scene::Appearance. Throws base::InputError when the file is gone.
PictureField FieldOf(const scene::Scene& scene, const std::filesystem::path& scene_h5, bool plain_surround, base::ThreadPool& threads);

struct RenderedPicture {
  image::Image8 color;  // display values
  // To where half of the light is left, of all pixels, NaN where there is no surface: of a panorama metres along the ray from the eye, of a still
  // along the optical axis, as frames of the viewer have it.
  std::vector<float> depth_m;
};

// caster: of the field, in the exposure of the request. on_rays is called after each batch with the number of rays in it. The same bits for any size
// of batches, any number of threads, ranks and blocks in memory. Throws base::Interrupted, and what the caster throws.
RenderedPicture RenderPicture(const PictureRequest& request, const PictureField& field, const products::RayCaster& caster,
                              const std::function<void(int64_t rays)>& on_rays);

// The rays of one picture, one through the centre of each pixel, for those who render some at a time.
class PictureRays {
 public:
  // cones: the scene has cones (scene::Scales::Cones).
  PictureRays(const PictureRequest& request, bool cones);

  // pixels: row * width + column each; `out` has the same length. Thread-safe.
  void Make(std::span<const size_t> pixels, std::span<render::Ray> out) const;

 private:
  std::variant<PanoramaRays, scene::CameraRays> rays_;
};

// All pixels of a picture, in an order in which they are rendered fast.
std::vector<size_t> PixelsInOrder(const PictureRequest& request);

}  // namespace skyquilt::tour
