#include "core/brightness/predict_gains.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/base/errors.h"

namespace skyquilt::brightness {
namespace {

// Indices of the photos of each group in order of capture.
std::vector<std::vector<size_t>> Sequences(const std::vector<CapturedPhoto>& photos) {
  std::vector<size_t> order(photos.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
    return photos[a].group != photos[b].group ? photos[a].group < photos[b].group : photos[a].order < photos[b].order;
  });
  std::vector<std::vector<size_t>> sequences;
  for (const size_t i : order) {
    if (sequences.empty() || photos[sequences.back().back()].group != photos[i].group) sequences.emplace_back();
    sequences.back().push_back(i);
  }
  return sequences;
}

double LogExif(const Response& response, size_t photo) {
  return std::log(static_cast<double>(response.exif_gain[photo]));
}

}  // namespace

double TagReliability(const Response& response, const std::vector<CapturedPhoto>& photos) {
  constexpr double kHardly = 1e-3;  // mean squared change of log exposure below which tags count as constant
  double both = 0.0, tags = 0.0, pairs = 0.0;
  for (const std::vector<size_t>& sequence : Sequences(photos)) {
    const size_t none = photos.size();
    size_t before = none;
    for (const size_t i : sequence) {
      if (!photos[i].learned || !photos[i].tagged) continue;
      if (before != none) {
        const double tag_step = LogExif(response, i) - LogExif(response, before);
        double step = 0.0;
        for (size_t c = 0; c < 3; ++c) step += static_cast<double>(response.log_gain[3 * i + c] - response.log_gain[3 * before + c]) / 3.0;
        both += tag_step * (tag_step + step);
        tags += tag_step * tag_step;
        pairs += 1.0;
      }
      before = i;
    }
  }
  return tags > kHardly * pairs ? std::clamp(both / tags, 0.0, 1.0) : 1.0;
}

namespace {

// The residual of the learned photos' log gains over time. tags = true: the part that the trusted tags do not explain, of tagged photos only;
// tags = false: the whole log gain, tags included, of all photos.
class RestOverTime {
 public:
  RestOverTime(const Response& response, const std::vector<CapturedPhoto>& photos, bool tags, double trust)
      : response_(response), photos_(photos), tags_(tags), explained_(tags ? trust : 0.0) {}

  bool Counts(size_t photo) const { return photos_[photo].learned && (!tags_ || photos_[photo].tagged); }
  double Of(size_t photo, size_t c) const { return static_cast<double>(response_.log_gain[3 * photo + c]) + Unexplained(photo); }
  // The part of a photo's tagged log gain that is not trusted.
  double Unexplained(size_t photo) const { return (1.0 - explained_) * LogExif(response_, photo); }
  // The residual at position k of a sequence, interpolated between the nearest learned photos before and after it; the photo's own is not used.
  std::optional<std::array<double, 3>> At(const std::vector<size_t>& sequence, size_t k) const {
    std::optional<size_t> before, after;
    for (size_t i = k; i > 0 && !before; --i) {
      if (Counts(sequence[i - 1])) before = sequence[i - 1];
    }
    for (size_t i = k + 1; i < sequence.size() && !after; ++i) {
      if (Counts(sequence[i])) after = sequence[i];
    }
    if (!before && !after) return std::nullopt;
    const size_t a = before.value_or(after.value_or(0)), b = after.value_or(a);
    const double span = photos_[b].order - photos_[a].order;
    const double share = span > 0.0 ? (photos_[sequence[k]].order - photos_[a].order) / span : 0.5;
    std::array<double, 3> rest{};
    for (size_t c = 0; c < 3; ++c) rest[c] = (1.0 - share) * Of(a, c) + share * Of(b, c);
    return rest;
  }

 private:
  const Response& response_;
  const std::vector<CapturedPhoto>& photos_;
  bool tags_;
  double explained_;
};

void Predict(const std::vector<CapturedPhoto>& photos, bool tags, double trust, Response& response) {
  const RestOverTime rest(response, photos, tags, trust);
  const std::vector<std::vector<size_t>> sequences = Sequences(photos);
  std::array<double, 3> mean = {0.0, 0.0, 0.0};
  double n = 0.0;
  for (size_t i = 0; i < photos.size(); ++i) {
    if (!rest.Counts(i)) continue;
    for (size_t c = 0; c < 3; ++c) mean[c] += rest.Of(i, c);
    n += 1.0;
  }
  for (double& value : mean) value /= std::max(n, 1.0);
  // Light changes slowly, but errors that jump from photo to photo cannot be interpolated. `memory` (0..1) is the least-squares factor on the
  // interpolated deviation from the mean that predicts the learned photos best.
  double both = 0.0, neighbours = 0.0;
  for (const std::vector<size_t>& sequence : sequences) {
    for (size_t k = 0; k < sequence.size(); ++k) {
      if (!rest.Counts(sequence[k])) continue;
      const auto between = rest.At(sequence, k);
      for (size_t c = 0; between && c < 3; ++c) {
        both += (rest.Of(sequence[k], c) - mean[c]) * ((*between)[c] - mean[c]);
        neighbours += ((*between)[c] - mean[c]) * ((*between)[c] - mean[c]);
      }
    }
  }
  const double memory = neighbours > 0.0 ? std::clamp(both / neighbours, 0.0, 1.0) : 1.0;
  for (const std::vector<size_t>& sequence : sequences) {
    for (size_t k = 0; k < sequence.size(); ++k) {
      const size_t photo = sequence[k];
      if (photos[photo].learned || photos[photo].tagged != tags) continue;
      const auto between = rest.At(sequence, k);
      for (size_t c = 0; between && c < 3; ++c) {
        const double predicted = mean[c] + memory * ((*between)[c] - mean[c]);
        response.log_gain[3 * photo + c] = static_cast<float>(predicted - rest.Unexplained(photo));
      }
    }
  }
}

}  // namespace

void PredictGains(const std::vector<CapturedPhoto>& photos, Response& response) {
  SKYQUILT_CHECK(photos.size() == response.photos(), "one entry per photo");
  const double trust = TagReliability(response, photos);
  for (const bool tags : {true, false}) Predict(photos, tags, trust, response);
}

}  // namespace skyquilt::brightness
