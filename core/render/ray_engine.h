// Renders rays through any number of fields at once. Every field's density is multiplied by its blend weight at the sample; samples of all
// fields on a ray are composed in order of distance, so a ray's optical depth is exactly the weighted sum of its fields' depths.
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
  std::vector<const TrainedField*> blocks;  // boxes; may be empty. Those a ray's window does not touch need no arrays
  const TrainedField* context = nullptr;    // fills what no block covers; may be null
};

struct EngineOptions {
  // What fields with this concealing field need.
  static EngineOptions For(const brightness::Luminance& luminance);

  bool operator==(const EngineOptions&) const = default;

  double step_scale = 1.0;                    // marching step as a multiple of the field's own
  float colour_threshold = 1e-4F;             // samples of smaller weight get no colour
  Concealing concealing = Concealing::kNone;  // fields with luminance: fill RayColor::concealed_light
};

// Where a block has weight along a ray: its core box widened by the ramp, of any height.
geo::Interval BlendInterval(const TrainedField& block, const Ray& ray);

// Blend weights of the set at a place: one per block, and the context's share in the return value. Sums to 1 inside any core box.
double BlendWeights(const FieldSet& fields, std::span<const int> candidates, double x, double y, std::span<double> weights);

// Renders on the calling thread; keeps its workspace between calls. The fields must outlive it. Not for two threads at once.
class RayRenderer {
 public:
  RayRenderer(const FieldSet& fields, const EngineOptions& options);
  ~RayRenderer();
  // As RenderRays; returns the samples evaluated. Best with some hundreds of rays at a time.
  int64_t Render(std::span<const Ray> rays, std::span<RayColor> out);
  // Goes on with rays through their windows (empty: through everything), front to back: cut into windows at any places, a ray gathers the same
  // bits. Returns the samples evaluated. Throws std::logic_error when a window needs a field that has no arrays.
  int64_t Continue(std::span<const Ray> rays, std::span<const Window> windows, std::span<RayState> states);

 private:
  class Group;
  std::unique_ptr<Group> group_;
  std::vector<RayState> states_;
};

// rays and out have the same length. Colours are display values at the reference exposure, premultiplied, over black. Samples evaluated are
// added to *samples when not null. Deterministic for any number of threads. Throws base::Interrupted when cancelled.
void RenderRays(const FieldSet& fields, std::span<const Ray> rays, std::span<RayColor> out, const EngineOptions& options, base::ThreadPool& threads,
                int64_t* samples = nullptr);

}  // namespace skyquilt::render
