// Somebody else who answers rays for a scene: other ranks, which hold its fields.
#pragma once

#include <span>

#include "core/render/ray_engine.h"
#include "core/render/ray_segments.h"
#include "core/scene/field_store.h"
#include "core/scene/scene.h"

namespace skyquilt::scene {

class RayService {
 public:
  virtual ~RayService() = default;
  // Called once, before the first rays: the scene's outlines, which outlive the service's use.
  virtual void Begin(const FieldStore& store, const render::RaySegments& segments) = 0;
  // As RenderRays of the whole scene, to the bit. Throws base::Interrupted, and what the others met as base::UsageError or base::InputError.
  virtual void Render(std::span<const render::Ray> rays, std::span<render::RayColor> out, const render::EngineOptions& options) = 0;
  virtual RenderStatistics statistics() const = 0;
};

}  // namespace skyquilt::scene
