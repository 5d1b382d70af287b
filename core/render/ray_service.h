// Somebody else who answers rays for a scene: other ranks, which hold its fields.
#pragma once

#include <span>

#include "core/render/field_store.h"
#include "core/render/ray_engine.h"
#include "core/render/ray_segments.h"

namespace skyquilt::render {

class RayService {
 public:
  virtual ~RayService() = default;
  // Called once, before the first rays: the scene's outlines, which outlive the service's use.
  virtual void Begin(const FieldStore& store, const RaySegments& segments) = 0;
  // As RenderRays of the whole scene, to the bit. Throws base::Interrupted, and what the others met as base::UsageError or base::InputError.
  virtual void Render(std::span<const Ray> rays, std::span<RayColor> out, const EngineOptions& options) = 0;
  virtual RenderStatistics statistics() const = 0;
};

}  // namespace skyquilt::render
