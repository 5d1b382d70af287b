#include "worker/start/tie_point_shading.h"

#include <algorithm>
#include <cmath>

namespace skyquilt::worker {
namespace {

constexpr int kMostShadingSteps = 60;    // of conjugate gradients; it is continued in the next round
constexpr double kShadingSolved = 1e-8;  // of the squared residual
constexpr double kNoWeight = 1e-12;

// The normal equations of the knots, without storing them.
class ShadingSystem {
 public:
  ShadingSystem(std::span<const ShadedSighting> sightings, const brightness::ShadingOptions& options)
      : sightings_(sightings), options_(options), knots_(options.grid.knots()) {
    for (const ShadedSighting& s : sightings) at_.push_back(brightness::KnotsAt(options.grid, s.place));
    const double ratio = brightness::kShadingScatter / static_cast<double>(options.sigma);
    prior_ = ratio * ratio;
  }

  // Values about the mean of their point, as a gradient by the knots.
  template <typename Value>
  std::vector<double> OfKnots(const Value& value) const {
    std::vector<double> sums(options_.learns.size() * knots_, 0.0);
    for (size_t first = 0, last = 0; first < sightings_.size(); first = last) {
      double weights = 0.0, total = 0.0;
      for (last = first; last < sightings_.size() && sightings_[last].point == sightings_[first].point; ++last) {
        weights += sightings_[last].weight;
        total += sightings_[last].weight * value(last);
      }
      if (!(weights > kNoWeight)) continue;
      for (size_t s = first; s < last; ++s) {
        const auto photo = static_cast<size_t>(sightings_[s].photo);
        if (options_.learns[photo] == 0) continue;
        const double off = sightings_[s].weight * (value(s) - total / weights);
        for (size_t i = 0; i < 4; ++i) sums[photo * knots_ + at_[s].knot[i]] += static_cast<double>(at_[s].weight[i]) * off;
      }
    }
    return sums;
  }
  std::vector<double> Apply(const std::vector<double>& x) const {
    std::vector<double> image = OfKnots([&](size_t s) { return At(s, x); });
    for (size_t i = 0; i < options_.learns.size(); ++i) {
      if (options_.learns[i] == 0) continue;
      brightness::AddShadingPrior(options_.grid, std::span<const double>(x).subspan(i * knots_, knots_), prior_,
                                  std::span(image).subspan(i * knots_, knots_));
    }
    return image;
  }
  // About the diagonal.
  std::vector<double> Diagonal() const {
    std::vector<double> diagonal(options_.learns.size() * knots_, prior_ * (1.0 + 4.0 * brightness::kShadingSmoothness));
    for (size_t s = 0; s < sightings_.size(); ++s) {
      for (size_t i = 0; i < 4; ++i) {
        const auto weight = static_cast<double>(at_[s].weight[i]);
        diagonal[static_cast<size_t>(sightings_[s].photo) * knots_ + at_[s].knot[i]] += sightings_[s].weight * weight * weight;
      }
    }
    return diagonal;
  }

 private:
  double At(size_t s, const std::vector<double>& x) const {
    const double* const of_photo = x.data() + static_cast<size_t>(sightings_[s].photo) * knots_;
    double sum = 0.0;
    for (size_t i = 0; i < 4; ++i) sum += static_cast<double>(at_[s].weight[i]) * of_photo[at_[s].knot[i]];
    return sum;
  }

  std::span<const ShadedSighting> sightings_;
  const brightness::ShadingOptions& options_;
  size_t knots_;
  std::vector<brightness::KnotWeights> at_;
  double prior_ = 0.0;
};

double Dot(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

}  // namespace

void SolveShading(std::span<const ShadedSighting> sightings, const brightness::ShadingOptions& options, brightness::Response& response) {
  const ShadingSystem system(sightings, options);
  std::vector<double> x(response.shading.begin(), response.shading.end());
  std::vector<double> rest = system.OfKnots([&](size_t s) { return sightings[s].log_light; });
  const double all = Dot(rest, rest);
  const std::vector<double> image = system.Apply(x), diagonal = system.Diagonal();
  for (size_t i = 0; i < rest.size(); ++i) rest[i] -= image[i];
  std::vector<double> scaled(rest.size()), direction;
  const auto precondition = [&] {
    for (size_t i = 0; i < rest.size(); ++i) scaled[i] = rest[i] / diagonal[i];
  };
  precondition();
  direction = scaled;
  double size = Dot(rest, scaled);
  for (int step = 0; step < kMostShadingSteps && Dot(rest, rest) > kShadingSolved * all; ++step) {
    const std::vector<double> moved = system.Apply(direction);
    const double stride = size / Dot(direction, moved);
    for (size_t i = 0; i < x.size(); ++i) {
      x[i] += stride * direction[i];
      rest[i] -= stride * moved[i];
    }
    precondition();
    const double next = Dot(rest, scaled);
    for (size_t i = 0; i < direction.size(); ++i) direction[i] = scaled[i] + next / size * direction[i];
    size = next;
  }
  const size_t knots = options.grid.knots();
  for (size_t i = 0; i < x.size(); ++i) {
    if (options.learns[i / knots] == 0) continue;
    response.shading[i] = std::clamp(static_cast<float>(x[i]), -brightness::kMaxLogShading, brightness::kMaxLogShading);
  }
  brightness::CentreShading(options.grid, options.learns, response.shading);
}

}  // namespace skyquilt::worker
