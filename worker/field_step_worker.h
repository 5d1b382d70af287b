// One thread's workspace of a training step. Private to FieldStep.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "core/field/hash_field.h"
#include "core/render/ray_engine.h"
#include "worker/field_step.h"
#include "worker/luminance_convolution.h"

namespace skyquilt::worker {

// A saturated pixel says only "at least this bright", a black one "at most": true when that is satisfied.
bool SaysLittle(float target_srgb, float residual);

template <typename T>
void Grow(std::vector<T>& v, size_t n) {
  if (v.size() < n) v.resize(n + n / 4);
}

struct FieldStep::Worker {
  field::Activations a;
  std::vector<float> depth, keep, tau, weight, rgb, weight_gradient, mid, width;
  // Rays of the packet: live samples, and what the context shows in front and behind.
  struct View {
    int64_t begin = 0, count = 0;
    float front_rgb[3] = {0, 0, 0}, front_transmittance = 1.0F;
    float behind_rgb[3] = {0, 0, 0};
    float background_share = 1.0F;
    // The same of the concealed rendering, in linear light; with luminance only.
    float front_light[3] = {0, 0, 0}, behind_light[3] = {0, 0, 0};
  };
  std::vector<View> views;
  // What the concealed rendering of a view came to.
  struct RayPlan {
    float rgb[3] = {0, 0, 0};    // plain colour of the samples
    float light[3] = {0, 0, 0};  // concealed, linear
    float transmittance = 1.0F;
    float shown_weight = 0.0F;  // sum of weights times shares
    float log_share = 0.0F;     // logarithm of the mean share, weighted by what is seen
    bool solid = false;         // enough is seen for that to mean something
  };
  std::unique_ptr<render::RayRenderer> context;
  std::vector<render::Ray> pieces;
  std::vector<render::RayColor> colors;
  std::vector<std::pair<size_t, bool>> owner;  // view, is it the piece behind
  float read_ahead = 0.0F;
  LuminanceConvolution luminance;
  std::vector<float> share, share_gradient, omega_gradient;  // per sample
  std::vector<float> light, light_slope;                     // linear light of the samples and its slope by display value, rows as rgb
  std::vector<ConvolvedRay> rays;                            // per view
  std::vector<RayPlan> plans;                                // per view

  void Reserve(const field::HashField& field, int64_t n) {
    a.Reserve(field, n);
    for (auto* v : {&depth, &keep, &tau, &weight}) Grow(*v, a.stride);
    Grow(rgb, 3 * a.stride);
  }
};

}  // namespace skyquilt::worker
