// Interface for rendering a scene's rays elsewhere: on other ranks, which hold its fields.
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
  // Called once before the first Render, with the descriptions of the scene's fields. Both arguments outlive the service.
  virtual void Begin(const FieldStore& store, const render::RaySegments& segments) = 0;
  // As RenderRays of the whole scene, with the same bits. Throws base::Interrupted when cancelled; errors on other ranks as base::UsageError or
  // base::InputError.
  virtual void Render(std::span<const render::Ray> rays, std::span<render::RayColor> out, const render::EngineOptions& options) = 0;
  virtual RenderStatistics statistics() const = 0;
};

}  // namespace skyquilt::scene
