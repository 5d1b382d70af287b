// One thread's workspace of a training step. Private to FieldStep.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "core/field/hash_field.h"
#include "core/render/ray_engine.h"
#include "worker/field_step.h"
#include "worker/losses/distortion_loss.h"
#include "worker/luminance_convolution.h"

namespace skyquilt::worker {

template <typename T>
void Grow(std::vector<T>& v, size_t n) {
  if (v.size() < n) v.resize(n + n / 4);
}

struct FieldStep::Worker {
  field::Activations a;
  std::vector<float> depth, keep, tau, weight, rgb, weight_gradient;
  DistortionScratch<float> distortion;
  std::vector<RayView> views;
  std::unique_ptr<render::RayRenderer> context;
  std::vector<render::Ray> pieces;
  std::vector<render::RayColor> colors;
  std::vector<std::pair<size_t, bool>> owner;  // view, is it the piece behind
  float read_ahead = 0.0F;
  LuminanceConvolution luminance;
  std::vector<float> share, share_gradient, omega_gradient;  // per sample
  std::vector<float> light, light_slope;                     // linear light of the samples and its slope by display value, rows as rgb
  std::vector<ConvolvedRay> rays;                            // per view
  std::vector<ConcealedRay> concealed;                       // per view

  void Reserve(const field::HashField& field, int64_t n) {
    a.Reserve(field, n);
    for (auto* v : {&depth, &keep, &tau, &weight}) Grow(*v, a.stride);
    Grow(rgb, 3 * a.stride);
  }
};

}  // namespace skyquilt::worker
