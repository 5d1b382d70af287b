// A scene that is a formula: patterned ground with a block on it, seen by rays from above. Batches of such rays train a field without photos, at
// any place of the survey's frame.
#pragma once

#include <Eigen/Core>

#include "core/base/random.h"
#include "core/field/optimizer.h"
#include "core/render/trained_field.h"
#include "worker/ray_batch.h"

namespace skyquilt::bench {

struct SyntheticOptions {
  Eigen::Vector3d offset_enu = Eigen::Vector3d::Zero();  // of the scene's middle on the ground
  double edge_m = 8.0;                                   // of the square field
  double height_m = 4.0;
  double voxel_m = 0.1;
  int levels = 6;
  int features = 2;
  int log2_table_size = 12;
  int hidden = 16;
  int color_hidden_layers = 1;
};

// A field over the scene with every cell awake and no parameters.
render::TrainedField SyntheticField(const SyntheticOptions& options);

struct SyntheticRays {
  int rays = 256;
  float empty_share = 0.0F;  // of the rays: they teach emptiness
  float most_stops = 0.0F;   // exposures are spread evenly over +- this
};

// Rays through random places of the scene, with what a photo of that exposure shows there: display values in [0, 1], without noise.
void DrawSyntheticBatch(const render::TrainedField& field, const SyntheticOptions& scene, const SyntheticRays& rays, base::Random& random,
                        worker::RayBatch* batch);

// The samples' unit positions once more, from survey-wide coordinates in single precision throughout: what a trainer without blocks of its own
// frame would feed its field with.
void RepositionInFloat(const render::TrainedField& field, worker::RayBatch* batch);

// A field in training: copied to see later what a step did.
struct TrainingState {
  field::Parameters parameters;
  field::TrainableState moments;
};
// As training starts.
TrainingState InitialState(const field::HashField& field, uint64_t seed);
bool AllFinite(const TrainingState& state);
bool SameParameters(const TrainingState& a, const TrainingState& b);

}  // namespace skyquilt::bench
