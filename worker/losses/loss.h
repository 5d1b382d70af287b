// Losses of a ray, or of a group of rays, each in a file of its own in this folder. To add one:
//   1. Write a small free function template over the scalar (float trains, double is for the test): what the rendering came to and the weight go
//      in, the loss and its derivative by what went in come out - as a Loss, or added to places the caller names where a loss has many inputs
//      or shares its places with others. No state, no allocation per ray: scratch is handed in.
//   2. Give it a weight: a constant in LossWeights, or a member of StepOptions where the weight changes during training. Weight 0 means that the
//      function is not called. Losses that judge photos directly (photo_loss.h) have weight 1: the others are measured by them.
//   3. Call it where its inputs are. Losses of what a ray was composed to: worker/ray_loss.cpp, or worker/concealed_ray_loss.cpp for fields with
//      concealing field; add the gradient to a member of what is returned there, and the scatter to the samples is done already. Losses of the
//      samples' compositing weights: beside PacketTrainer::AddDistortion, into its gradient by them. Losses of a group: as LossOfShares does.
//   4. Check it in tests/worker/losses_test.cpp: ExpectLossGradient holds its derivatives against differences in double.
#pragma once

namespace skyquilt::worker {

// A loss of one number and its derivative by that number.
template <typename T>
struct Loss {
  T value = T(0);
  T gradient = T(0);
};

// Weights beside the photo loss, all >= 0; 0: not evaluated. The distortion loss's changes from step to step: StepOptions::distortion.
struct LossWeights {
  float emptiness = 1.0F;  // of rays that are known to meet nothing
  // The wish for a mean brightness has a direction to itself, in which the photos do not care, so its size matters little.
  float mean_brightness = 0.1F;
  // Omega of neighbouring rays should agree, and all should stay near the survey's mean: otherwise Omega takes over the scene's texture.
  float smoothness = 1e-2F;
  float mean_share = 1e-3F;
};
inline constexpr LossWeights kLossWeights;

}  // namespace skyquilt::worker
