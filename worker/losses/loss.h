// What all losses have in common: the result type and the weights; and the losses of one number. Each other loss of a ray, or of a group of rays, is
// in a file of its own in this folder.
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

// Keeps a number, of one ray or a mean over many, near its goal:
// weight * off^2 and its derivative by off. off: the number minus its goal.
template <typename T>
Loss<T> MeanLoss(T weight, T off) {
  return {weight * off * off, T(2) * weight * off};
}

// Pulls a distance towards zero, but lets go of distances that are too large for the assumption to be true (Geman and McClure 1985):
// weight * s^2 / (1 + s^2 / kappa^2) and its derivative by s. s: any unit, kappa > 0: the same unit; far beyond kappa the loss is constant.
template <typename T>
Loss<T> RobustLoss(T weight, T s, T kappa) {
  const T spread = T(1) + s * s / (kappa * kappa);
  return {weight * s * s / spread, T(2) * weight * s / (spread * spread)};
}

// Keeps a number similar between neighbouring rays: a loss of a group of rays, summed over pairs of neighbours.
// The loss weight * (own - neighbour)^2 of a pair, called once for each of its two rays: adds half of the loss to *loss, because the call for the
// other ray adds the other half, and the derivative of the whole loss by `own` to *gradient.
template <typename T>
void AddSmoothnessLoss(T weight, T own, T neighbour, double* loss, T* gradient) {
  const T step = own - neighbour;
  *gradient += T(2) * weight * step;
  *loss += static_cast<double>(T(0.5) * weight * step * step);
}

// Makes the field transparent along rays that are known to meet no surface in it, so that no floaters remain there:
// weight * (1 - transmittance)^2 and its derivative by transmittance, which is 0..1.
template <typename T>
Loss<T> EmptinessLoss(T weight, T transmittance) {
  const T opacity = T(1) - transmittance;
  return {weight * (opacity * opacity), T(-2) * weight * opacity};
}

}  // namespace skyquilt::worker
