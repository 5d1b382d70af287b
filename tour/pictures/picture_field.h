// What pictures are rendered from. A test needs no scene for it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>

#include "core/base/thread_pool.h"
#include "core/scene/scene.h"
#include "products/ray_caster.h"

namespace skyquilt::tour {

struct PictureField {
  std::string identity;         // another one when the scene's content is another
  bool cones = false;           // scene::Scales::Cones
  size_t batch_rays = 1 << 17;  // rendered at a time
  // Renders rays over the background in an exposure that is given as products.exposure. Throws base::UsageError for one that is not allowed.
  std::function<products::RayCaster(const std::string& exposure)> caster;
};

// Of a scene that was loaded from this file, on this process or on other ranks, in memory or paged. Keeps references to scene and threads.
// Throws base::InputError when the file is gone.
PictureField FieldOf(const scene::Scene& scene, const std::filesystem::path& scene_h5, base::ThreadPool& threads);

}  // namespace skyquilt::tour
