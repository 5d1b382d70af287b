// Interface between products and renderer: functions that return the colours of rays or of a view. Products then work the same with a scene in
// memory, with rendering on several ranks and with test scenes.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/camera/camera.h"
#include "core/geo/transform.h"
#include "core/scene/scene.h"

namespace skyquilt::products {

// Renders any number of rays (ENU, metres); both spans have the same length. May throw base::Interrupted. Ranks that render wait for each other at
// the end of a call.
using RayCaster = std::function<void(std::span<const render::Ray>, std::span<render::RayColor>)>;

struct View {
  std::string name;  // of its image file, without extension
  camera::Camera camera;
  geo::Rigid3d cam_from_enu;
};

// Renders all pixels of a view, row-major.
using ViewRenderer = std::function<std::vector<render::RayColor>(const View&)>;

// Reads an exposure like products.exposure: "normal", stops above normal (linear light times 2^stops), or the name of a photo whose brightness and
// white balance to use. Throws base::UsageError for anything else.
scene::Appearance AppearanceOf(const std::string& exposure, const scene::SceneInfo& info);
// Rays that one call should get: enough that each rank has work for several requests. With many ranks they take up to some hundred megabytes.
constexpr size_t RaysPerCall(int ranks) {
  constexpr size_t kFewest = size_t{1} << 16U, kMost = size_t{1} << 20U, kOfRank = size_t{1} << 13U;
  return std::clamp(kOfRank * static_cast<size_t>(std::max(ranks, 1)), kFewest, kMost);
}

// Renderers of a scene. All keep references to scene and threads.
RayCaster CasterOf(const scene::Scene& scene, const scene::Appearance& appearance, base::ThreadPool& threads);
// With the scene's background where opacity is below 1: the colours that RendererOf(scene) gives these rays.
RayCaster BackgroundCasterOf(const scene::Scene& scene, const scene::Appearance& appearance, base::ThreadPool& threads);
ViewRenderer RendererOf(const scene::Scene& scene, const scene::Appearance& appearance, base::ThreadPool& threads);
// Renders one ray through each pixel centre, in batches.
ViewRenderer RendererOf(RayCaster caster);

}  // namespace skyquilt::products
