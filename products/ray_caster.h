// How the products ask for colours and depths: a scene behind two small functions, so that anything that answers rays can be mapped.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/camera/camera.h"
#include "core/geo/transform.h"
#include "core/scene/scene.h"

namespace skyquilt::products {

// Answers any number of rays (ENU, metres); both spans have the same length. May throw base::Interrupted.
using RayCaster = std::function<void(std::span<const render::Ray>, std::span<render::RayColor>)>;

struct View {
  std::string name;  // of the files it is written to, without extension
  camera::Camera camera;
  geo::Rigid3d cam_from_enu;
};

// All pixels of a view, row-major.
using ViewRenderer = std::function<std::vector<render::RayColor>(const View&)>;

// `exposure` as products.exposure: "normal", stops above it (linear light times 2^stops), or the name of a photo whose brightness and white
// balance renderings take. Throws base::UsageError for anything else.
scene::Appearance AppearanceOf(const std::string& exposure, const scene::SceneInfo& info);
// Both keep references to their arguments.
RayCaster CasterOf(const scene::Scene& scene, const scene::Appearance& appearance, base::ThreadPool& threads);
ViewRenderer RendererOf(const scene::Scene& scene, const scene::Appearance& appearance, base::ThreadPool& threads);
// One ray through each pixel centre, in bands.
ViewRenderer RendererOf(RayCaster caster);

}  // namespace skyquilt::products
