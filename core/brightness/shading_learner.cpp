#include "core/brightness/shading_learner.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/errors.h"
#include "core/checkpoint/take_array.h"

namespace skyquilt::brightness {
namespace {

constexpr double kLearnFrom = 0.2;                // of the training
constexpr double kRate = 1e-2, kLastRate = 5e-4;  // in log light, geometric in between
constexpr float kShadingBeta1 = 0.9F, kShadingBeta2 = 0.99F;
// Second derivative of a pixel's squared error, summed over its colours, by its log light, for display values in the middle of the scale.
constexpr double kSquaredPerLogLight = 0.3;
// Pixels around a knot err together, so that many of them count as so many independent ones.
constexpr double kPixelsOfKnot = 10.0;

}  // namespace

ShadingLearner::ShadingLearner(Response& response, ShadingOptions options) : response_(response), options_(std::move(options)) {
  if (!On()) return;
  SKYQUILT_CHECK(options_.learns.size() == response.photos() && options_.sigma > 0.0F, "one flag per photo, and a prior");
  SKYQUILT_CHECK(options_.grid == response.shading_grid, "the response has another grid");
  gradient_.assign(response.shading.size(), 0.0);
  weight_.assign(response.photos(), 0.0);
}

void ShadingLearner::Add(size_t photo, const PicturePlace& place, float gradient, float weight) {
  if (options_.learns[photo] == 0) return;
  const KnotWeights at = KnotsAt(options_.grid, place);
  double* const of_photo = gradient_.data() + photo * options_.grid.knots();
  for (size_t i = 0; i < at.knot.size(); ++i) of_photo[at.knot[i]] += static_cast<double>(at.weight[i] * gradient);
  weight_[photo] += static_cast<double>(weight);
}

void ShadingLearner::Step(double progress, Moments& moments) {
  if (!Learns()) return;
  const bool learns = progress >= kLearnFrom;
  const double passed = std::clamp((progress - kLearnFrom) / (1.0 - kLearnFrom), 0.0, 1.0);
  const auto rate = static_cast<float>(kRate * std::pow(kLastRate / kRate, passed));
  const size_t knots = options_.grid.knots();
  const double ratio = kShadingScatter / static_cast<double>(options_.sigma);
  const double prior = kSquaredPerLogLight * ratio * ratio / (kPixelsOfKnot * static_cast<double>(knots));
  for (size_t i = 0; i < weight_.size(); ++i) {
    if (weight_[i] == 0.0) continue;
    const std::span<double> gradient = std::span(gradient_).subspan(i * knots, knots);
    AddShadingPrior(options_.grid, std::span<const float>(response_.shading).subspan(i * knots, knots), prior * weight_[i], gradient);
    if (learns && std::ranges::all_of(gradient, [](double g) { return std::isfinite(g); })) Update(i, rate, moments);
    std::ranges::fill(gradient, 0.0);
    weight_[i] = 0.0;
  }
  if (learns) CentreShading(options_.grid, options_.learns, response_.shading);
}

void ShadingLearner::Update(size_t photo, float rate, Moments& moments) {
  const auto t = static_cast<float>(++moments.steps[photo]);
  const float correction1 = 1.0F - std::pow(kShadingBeta1, t), correction2 = 1.0F - std::pow(kShadingBeta2, t);
  const size_t knots = options_.grid.knots();
  for (size_t k = photo * knots; k < (photo + 1) * knots; ++k) {
    const auto g = static_cast<float>(gradient_[k]);
    moments.first[k] = kShadingBeta1 * moments.first[k] + (1.0F - kShadingBeta1) * g;
    moments.second[k] = kShadingBeta2 * moments.second[k] + (1.0F - kShadingBeta2) * g * g;
    const float change = rate * (moments.first[k] / correction1) / (std::sqrt(moments.second[k] / correction2) + 1e-15F);
    response_.shading[k] = std::clamp(response_.shading[k] - change, -kMaxLogShading, kMaxLogShading);
  }
}

ShadingLearner::Moments ShadingLearner::EmptyMoments() const {
  if (!On()) return {};
  const size_t n = response_.shading.size();
  return {std::vector<float>(n, 0.0F), std::vector<float>(n, 0.0F), std::vector<int64_t>(response_.photos(), 0)};
}

void ShadingLearner::Put(const Moments& moments, checkpoint::ArchiveWriter& writer) const {
  if (!On()) return;
  writer.SetAttribute("shading_frozen", frozen_ ? 1 : 0);
  writer.Put("learner/shading_moment1", moments.first);
  writer.Put("learner/shading_moment2", moments.second);
  writer.Put("learner/shading_steps", moments.steps);
}

void ShadingLearner::Get(const checkpoint::ArchiveReader& reader, const std::filesystem::path& file, Moments& moments) {
  if (!On()) return;
  const auto take = [&](auto& to, const auto& from, const char* name) { checkpoint::TakeArray(from, name, file, "survey", to); };
  frozen_ = reader.IntAttribute("shading_frozen") != 0;
  take(moments.first, reader.Floats("learner/shading_moment1"), "learner/shading_moment1");
  take(moments.second, reader.Floats("learner/shading_moment2"), "learner/shading_moment2");
  take(moments.steps, reader.Ints("learner/shading_steps"), "learner/shading_steps");
}

}  // namespace skyquilt::brightness
