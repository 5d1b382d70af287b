#include "core/brightness/response_learner.h"

#include <array>
#include <cmath>

#include "core/checkpoint/take_array.h"

namespace skyquilt::brightness {
namespace {

// Learning rates at the start and the end of training, in log gain (a stop is 0.69); geometric in between.
constexpr double kGainRate = 2e-2, kLastGainRate = 5e-4;
constexpr float kBeta1 = 0.9F, kBeta2 = 0.99F;
// Second derivative of a pixel's squared error by its log gain, for a display value in the middle of the scale.
constexpr double kSquaredPerLog = 0.1;

double RateAt(double progress, double first, double last) {
  return first * std::pow(last / first, std::clamp(progress, 0.0, 1.0));
}

}  // namespace

ResponseLearner::ResponseLearner(Response& response, const LearnerOptions& options)
    : response_(response), options_(options), shading_(response, options.shading) {
  const size_t photos = response.photos();
  SKYQUILT_CHECK(options.learns_gain.size() == photos, "one flag per photo");
  SKYQUILT_CHECK(options.tag_weight.empty() || options.tag_weight.size() == photos, "a tag weight per photo, or none");
  active_ = options.Gains();
  for (auto* moment : {&moments_.first, &moments_.second}) moment->assign(3 * photos, 0.0F);
  moments_.steps.assign(photos, 0);
  moments_.shading = shading_.EmptyMoments();
  gradient_.assign(3 * photos, 0.0);
  touched_.assign(photos, 0);
  weight_.assign(photos, 0.0);
}

void ResponseLearner::Add(size_t photo, const float gradient[3], float weight) {
  if (options_.learns_gain[photo] == 0 || frozen_) return;
  touched_[photo] = 1;
  weight_[photo] += static_cast<double>(weight);
  for (size_t c = 0; c < 3; ++c) gradient_[3 * photo + c] += static_cast<double>(gradient[c]);
}

void ResponseLearner::Step(double progress) {
  shading_.Step(progress, moments_.shading);
  if (frozen_) return;
  for (size_t i = 0; i < options_.tag_weight.size(); ++i) {
    const double pull = kSquaredPerLog * static_cast<double>(options_.tag_weight[i]) * weight_[i];
    for (size_t k = 3 * i; k < 3 * i + 3; ++k) gradient_[k] += pull * static_cast<double>(response_.log_gain[k]);
  }
  Update(static_cast<float>(RateAt(progress, kGainRate, kLastGainRate)));
  for (float& gain : response_.log_gain) gain = std::clamp(gain, -kMaxLogGain, kMaxLogGain);
  if (!options_.anchored) SubtractMean();
}

void ResponseLearner::Update(float rate) {
  for (size_t i = 0; i < touched_.size(); ++i) {
    if (touched_[i] == 0) continue;
    const bool finite = std::isfinite(gradient_[3 * i]) && std::isfinite(gradient_[3 * i + 1]) && std::isfinite(gradient_[3 * i + 2]);
    if (finite) ++moments_.steps[i];
    const auto t = static_cast<float>(moments_.steps[i]);
    const float correction1 = 1.0F - std::pow(kBeta1, t), correction2 = 1.0F - std::pow(kBeta2, t);
    for (size_t k = 3 * i; k < 3 * i + 3; ++k) {
      const auto g = static_cast<float>(gradient_[k]);
      gradient_[k] = 0.0;
      if (!finite) continue;
      moments_.first[k] = kBeta1 * moments_.first[k] + (1.0F - kBeta1) * g;
      moments_.second[k] = kBeta2 * moments_.second[k] + (1.0F - kBeta2) * g * g;
      response_.log_gain[k] -= rate * (moments_.first[k] / correction1) / (std::sqrt(moments_.second[k] / correction2) + 1e-15F);
    }
    touched_[i] = 0;
    weight_[i] = 0.0;
  }
}

void ResponseLearner::SubtractMean() {
  std::array<double, 3> mean = {0.0, 0.0, 0.0};
  double n = 0.0;
  for (size_t i = 0; i < options_.learns_gain.size(); ++i) {
    if (options_.learns_gain[i] == 0) continue;
    for (size_t c = 0; c < 3; ++c) mean[c] += static_cast<double>(response_.log_gain[3 * i + c]);
    n += 1.0;
  }
  if (n == 0.0) return;
  for (size_t i = 0; i < options_.learns_gain.size(); ++i) {
    if (options_.learns_gain[i] == 0) continue;
    for (size_t c = 0; c < 3; ++c) response_.log_gain[3 * i + c] -= static_cast<float>(mean[c] / n);
  }
}

void ResponseLearner::Put(checkpoint::ArchiveWriter& writer) const {
  writer.SetAttribute("learner_frozen", frozen_ ? 1 : 0);
  writer.Put("learner/gain_moment1", moments_.first);
  writer.Put("learner/gain_moment2", moments_.second);
  writer.Put("learner/gain_steps", moments_.steps);
  shading_.Put(moments_.shading, writer);
}

void ResponseLearner::Get(const checkpoint::ArchiveReader& reader, const std::filesystem::path& file) {
  const auto take = [&](auto& to, const auto& from, const char* name) { checkpoint::TakeArray(from, name, file, "survey", to); };
  frozen_ = reader.IntAttribute("learner_frozen") != 0;
  take(moments_.first, reader.Floats("learner/gain_moment1"), "learner/gain_moment1");
  take(moments_.second, reader.Floats("learner/gain_moment2"), "learner/gain_moment2");
  take(moments_.steps, reader.Ints("learner/gain_steps"), "learner/gain_steps");
  shading_.Get(reader, file, moments_.shading);
}

}  // namespace skyquilt::brightness
