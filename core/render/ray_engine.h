// Renders rays through any number of overlapping fields at once, so that the borders of blocks do not show. The density of a field is multiplied by
// its blend weight at the sample, and the samples of all fields are composited in order of distance. The optical depth of a ray is therefore exactly
// the weighted sum of the optical depths of its fields.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/brightness/luminance.h"
#include "core/geo/ray_box.h"
#include "core/render/concealed.h"
#include "core/render/ray.h"
#include "core/render/ray_state.h"
#include "core/render/trained_field.h"

namespace skyquilt::render {

struct FieldSet {
  std::vector<const TrainedField*> blocks;  // may be empty; blocks outside the windows of all rays need not be loaded
  const TrainedField* context = nullptr;    // is rendered where no block is; may be null
};

struct EngineOptions {
  // Options for the concealed rendering; the defaults when luminance is off.
  static EngineOptions For(const brightness::Luminance& luminance);
  // No colours; a ray ends where its opacity is above both `opacity` and 0.85, at which the last of its depths is known.
  static EngineOptions DepthsOnly(double opacity);

  bool operator==(const EngineOptions&) const = default;

  double step_scale = 1.0;                    // marching step as a multiple of the field's own step
  float colour_threshold = 1e-4F;             // samples with a smaller compositing weight get no colour
  double end_transmittance = 5e-3;            // a ray ends below it, scaled to full opacity; about one step of an 8-bit colour
  bool normals = false;                       // also fill the normals of RayColor, from the samples that get a colour
  Concealing concealing = Concealing::kNone;  // not kNone: fill RayColor::concealed_light (fields with luminance only)
};

// The interval of a ray where a block has a blend weight: in its core box widened by the ramp, at any height.
geo::Interval BlendInterval(const TrainedField& block, const Ray& ray);

// Writes the blend weight at (x, y) of each candidate (index into fields.blocks) and returns the context's weight. They sum to 1.
double BlendWeights(const FieldSet& fields, std::span<const int> candidates, double x, double y, std::span<double> weights);

// Renders on the calling thread and keeps its workspace between calls. The fields must outlive it. Not thread-safe.
class RayRenderer {
 public:
  RayRenderer(const FieldSet& fields, const EngineOptions& options);
  ~RayRenderer();
  // As RenderRays; returns the number of samples evaluated. Most efficient with some hundreds of rays per call.
  int64_t Render(std::span<const Ray> rays, std::span<RayColor> out);
  // Continues rays through their windows, front to back (no windows: to their ends). The result has the same bits wherever a ray is cut into windows.
  // Returns the number of samples evaluated. Throws std::logic_error when a window needs a field that is not loaded.
  int64_t Continue(std::span<const Ray> rays, std::span<const Window> windows, std::span<RayState> states);

 private:
  class Group;
  std::unique_ptr<Group> group_;
  std::vector<RayState> states_;
};

// rays and out have the same length. Adds the number of samples evaluated to *samples when not null. Same bits for any number of threads. Throws
// base::Interrupted when cancelled.
void RenderRays(const FieldSet& fields, std::span<const Ray> rays, std::span<RayColor> out, const EngineOptions& options, base::ThreadPool& threads,
                int64_t* samples = nullptr);

}  // namespace skyquilt::render
