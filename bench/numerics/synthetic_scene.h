// A scene given by a formula: patterned ground with a box on it, seen from above. Rays with known colours train a field without photos, at any
// position in the survey's frame.
#pragma once

#include <Eigen/Core>

#include "core/base/random.h"
#include "core/field/optimizer.h"
#include "core/render/trained_field.h"
#include "worker/rays/ray_batch.h"

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
  double density_bias = -3.0;  // log of the optical depth of a step before training; 1: rays end where they enter
  // As train.multisample and train.scale_features.
  int multisample = 0;
  bool scale_features = false;
  bool normal_head = false;  // whether normals are predicted
  // As train.density_activation and train.appearance_codes; photos: between which the rays are divided.
  field::DensityActivation density_activation = field::DensityActivation::kExp;
  int appearance = 0;
  int photos = 5;
};

// A field over the scene with every occupancy cell on and without parameters.
render::TrainedField SyntheticField(const SyntheticOptions& options);

struct SyntheticRays {
  int rays = 256;
  float empty_share = 0.0F;  // fraction of rays that are trained to be empty (density 0)
  float most_stops = 0.0F;   // exposures are uniform between plus and minus this
  // Footprints where a ray meets the ground, metres; the logarithm is uniform between these. Both 0: points; both infinite: no detail at all.
  double least_width_m = 0.0, most_width_m = 0.0;
};

// Rays through random positions of the scene, with the colours that a photo of that exposure would have: display values in [0, 1], without noise.
void DrawSyntheticBatch(const render::TrainedField& field, const SyntheticOptions& scene, const SyntheticRays& rays, base::Random& random,
                        worker::RayBatch* batch);

// Replaces the unit positions of samples with one position by positions computed from survey-wide single-precision coordinates, as a trainer without
// block frames would have them.
void RepositionInFloat(const render::TrainedField& field, worker::RayBatch* batch);

// Parameters and moments of a field in training; copied to compare them before and after a step.
struct TrainingState {
  field::Parameters parameters;
  field::OptimizerState moments;
};
// The state at the start of training.
TrainingState InitialState(const field::HashField& field, uint64_t seed);
bool AllFinite(const TrainingState& state);
bool SameParameters(const TrainingState& a, const TrainingState& b);

}  // namespace skyquilt::bench
