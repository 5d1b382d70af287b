// What all losses have in common: the result type and the weights. Each loss of a ray, or of a group of rays, is in a file of its own in this folder.
// To add a loss:
//   1. Write a free function template over the scalar type (float for training, double for the test). It takes the rendered values and the weight,
//      and returns the loss and its derivatives by the rendered values as a Loss; with many inputs it adds the derivatives to buffers of the caller.
//      No state and no allocation per ray: buffers are arguments.
//   2. Give it a weight: a constant in LossWeights, or a member of StepOptions when the weight changes during training. With weight 0 the function is
//      not called. The photo losses (photo_loss.h) have weight 1; other weights are relative to them.
//   3. Call it where its inputs are known. Losses of the rendered colour or transmittance of a ray: in worker/step/ray_loss.cpp, or with a concealing
//      field in worker/step/concealed_ray_loss.cpp; add the derivatives to the returned gradient, which is propagated to the samples already. Losses
//      of the compositing weights: like PacketDistortion (worker/step/packet_losses.h). Losses of a group of rays: like LossOfShares.
//   4. Test it in tests/worker/losses_test.cpp: ExpectLossGradient compares its derivatives with finite differences in double.
#pragma once

namespace skyquilt::worker {

// A loss of one number and its derivative by that number.
template <typename T>
struct Loss {
  T value = T(0);
  T gradient = T(0);
};

// Weights relative to the photo loss, all >= 0; 0: not evaluated. The weight of the distortion loss changes during training: StepOptions::distortion.
struct LossWeights {
  float emptiness = 1.0F;  // for rays that are known to meet no surface in the field
  // The others are for concealing fields only.
  // The photos do not constrain the mean brightness of the rendering shown to people, so the size of this weight matters little.
  float mean_brightness = 0.1F;
  // Omega of neighbouring rays should be similar, and all should be near the survey's mean; otherwise Omega learns the scene's texture.
  float smoothness = 1e-2F;
  float mean_share = 1e-3F;
};
inline constexpr LossWeights kLossWeights;

}  // namespace skyquilt::worker
