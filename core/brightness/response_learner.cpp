#include "core/brightness/response_learner.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/errors.h"

namespace skyquilt::brightness {
namespace {

// Rates at the start and the end of training; between them geometrically. A stop is 0.69.
constexpr double kGainRate = 2e-2, kLastGainRate = 5e-4;
constexpr double kFalloffRate = 1e-2, kLastFalloffRate = 2e-4;
constexpr float kBeta1 = 0.9F, kBeta2 = 0.99F;
// Weight of the squared falloff coefficients, which have no meaning beyond what the photos ask for.
constexpr double kFalloffDecay = 1e-4;
// Second derivative of a pixel's squared error by the logarithm of its gain, for a display value in the middle of the scale.
constexpr double kSquaredPerLog = 0.1;

double RateAt(double progress, double first, double last) {
  return first * std::pow(last / first, std::clamp(progress, 0.0, 1.0));
}

}  // namespace

void ResponseLearner::Group::Resize(size_t threes) {
  for (auto* moment : {&moment1, &moment2}) moment->assign(3 * threes, 0.0F);
  steps.assign(threes, 0);
  gradient.assign(3 * threes, 0.0);
  touched.assign(threes, 0);
}

void ResponseLearner::Group::Update(float rate, std::vector<float>* parameters) {
  for (size_t i = 0; i < touched.size(); ++i) {
    if (touched[i] == 0) continue;
    const bool finite = std::isfinite(gradient[3 * i]) && std::isfinite(gradient[3 * i + 1]) && std::isfinite(gradient[3 * i + 2]);
    if (finite) ++steps[i];
    const auto t = static_cast<float>(steps[i]);
    const float correction1 = 1.0F - std::pow(kBeta1, t), correction2 = 1.0F - std::pow(kBeta2, t);
    for (size_t k = 3 * i; k < 3 * i + 3; ++k) {
      const auto g = static_cast<float>(gradient[k]);
      gradient[k] = 0.0;
      if (!finite) continue;
      moment1[k] = kBeta1 * moment1[k] + (1.0F - kBeta1) * g;
      moment2[k] = kBeta2 * moment2[k] + (1.0F - kBeta2) * g * g;
      (*parameters)[k] -= rate * (moment1[k] / correction1) / (std::sqrt(moment2[k] / correction2) + 1e-15F);
    }
    touched[i] = 0;
  }
}

ResponseLearner::ResponseLearner(Response& response, const LearnerOptions& options) : response_(response), options_(options) {
  SKYQUILT_CHECK(options.learns_gain.size() == response.photos(), "one flag per photo");
  active_ = options.Gains() || options.falloff;
  SKYQUILT_CHECK(options.belief.empty() || options.belief.size() == response.photos(), "a belief per photo, or none");
  gain_.Resize(response.photos());
  weight_.assign(response.photos(), 0.0);
  falloff_.Resize(response.falloff.size() / 3);
}

void ResponseLearner::Add(size_t photo, float radius2, const float gradient[3], float weight) {
  if (options_.learns_gain[photo] != 0) {
    gain_.touched[photo] = 1;
    weight_[photo] += static_cast<double>(weight);
    for (size_t c = 0; c < 3; ++c) gain_.gradient[3 * photo + c] += static_cast<double>(gradient[c]);
  }
  if (!options_.falloff) return;
  const auto camera = static_cast<size_t>(response_.camera[photo]);
  falloff_.touched[camera] = 1;
  double power = static_cast<double>(gradient[0] + gradient[1] + gradient[2]);
  for (size_t k = 0; k < 3; ++k) falloff_.gradient[3 * camera + k] += power *= static_cast<double>(radius2);
}

void ResponseLearner::Step(double progress) {
  for (size_t i = 0; i < falloff_.touched.size(); ++i) {
    if (falloff_.touched[i] == 0) continue;
    for (size_t k = 3 * i; k < 3 * i + 3; ++k) falloff_.gradient[k] += 2.0 * kFalloffDecay * static_cast<double>(response_.falloff[k]);
  }
  for (size_t i = 0; i < options_.belief.size(); ++i) {
    if (gain_.touched[i] == 0) continue;
    const double pull = kSquaredPerLog * static_cast<double>(options_.belief[i]) * weight_[i];
    for (size_t k = 3 * i; k < 3 * i + 3; ++k) gain_.gradient[k] += pull * static_cast<double>(response_.log_gain[k]);
  }
  std::fill(weight_.begin(), weight_.end(), 0.0);
  gain_.Update(static_cast<float>(RateAt(progress, kGainRate, kLastGainRate)), &response_.log_gain);
  falloff_.Update(static_cast<float>(RateAt(progress, kFalloffRate, kLastFalloffRate)), &response_.falloff);
  for (float& gain : response_.log_gain) gain = std::clamp(gain, -kMaxLogGain, kMaxLogGain);
  if (!options_.anchored) TakeOffMean();
}

void ResponseLearner::TakeOffMean() {
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
  writer.SetAttribute("learner_rests", resting_ ? 1 : 0);
  writer.Put("learner/gain_moment1", gain_.moment1);
  writer.Put("learner/gain_moment2", gain_.moment2);
  writer.Put("learner/gain_steps", gain_.steps);
  writer.Put("learner/falloff_moment1", falloff_.moment1);
  writer.Put("learner/falloff_moment2", falloff_.moment2);
  writer.Put("learner/falloff_steps", falloff_.steps);
}

void ResponseLearner::Get(const checkpoint::ArchiveReader& reader, const std::filesystem::path& file) {
  const auto take = [&](auto& to, auto from, const char* name) {
    if (from.size() != to.size()) {
      throw base::InputError(file, std::string("array '") + name + "' belongs to another number of photos", "Train again with --restart");
    }
    to = std::move(from);
  };
  resting_ = reader.IntAttribute("learner_rests") != 0;
  take(gain_.moment1, reader.Floats("learner/gain_moment1"), "learner/gain_moment1");
  take(gain_.moment2, reader.Floats("learner/gain_moment2"), "learner/gain_moment2");
  take(gain_.steps, reader.Ints("learner/gain_steps"), "learner/gain_steps");
  take(falloff_.moment1, reader.Floats("learner/falloff_moment1"), "learner/falloff_moment1");
  take(falloff_.moment2, reader.Floats("learner/falloff_moment2"), "learner/falloff_moment2");
  take(falloff_.steps, reader.Ints("learner/falloff_steps"), "learner/falloff_steps");
}

}  // namespace skyquilt::brightness
