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

double TrustInTags(const Response& response, const std::vector<CapturedPhoto>& photos) {
  constexpr double kHardly = 1e-3;  // mean squared change of log exposure
  double both = 0.0, tags = 0.0, pairs = 0.0;
  for (const std::vector<size_t>& sequence : Sequences(photos)) {
    const size_t none = photos.size();
    size_t before = none;
    for (const size_t i : sequence) {
      if (!photos[i].learned) continue;
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

// What the trusted part of the tags leaves of the learned photos' gains, over time.
class RestOverTime {
 public:
  RestOverTime(const Response& response, const std::vector<CapturedPhoto>& photos, double trust)
      : response_(response), photos_(photos), trust_(trust) {}

  double Of(size_t photo, size_t c) const {
    return static_cast<double>(response_.log_gain[3 * photo + c]) + (1.0 - trust_) * LogExif(response_, photo);
  }
  // Interpolated at place k of a sequence between the nearest learned photos before and after it; its own is not used.
  std::optional<std::array<double, 3>> At(const std::vector<size_t>& sequence, size_t k) const {
    std::optional<size_t> before, after;
    for (size_t i = k; i > 0 && !before; --i) {
      if (photos_[sequence[i - 1]].learned) before = sequence[i - 1];
    }
    for (size_t i = k + 1; i < sequence.size() && !after; ++i) {
      if (photos_[sequence[i]].learned) after = sequence[i];
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
  double trust_;
};

}  // namespace

void PredictGains(const std::vector<CapturedPhoto>& photos, Response& response) {
  SKYQUILT_CHECK(photos.size() == response.photos(), "one entry per photo");
  const double trust = TrustInTags(response, photos);
  const RestOverTime rest(response, photos, trust);
  const std::vector<std::vector<size_t>> sequences = Sequences(photos);
  std::array<double, 3> mean = {0.0, 0.0, 0.0};
  double n = 0.0;
  for (size_t i = 0; i < photos.size(); ++i) {
    if (!photos[i].learned) continue;
    for (size_t c = 0; c < 3; ++c) mean[c] += rest.Of(i, c);
    n += 1.0;
  }
  for (double& value : mean) value /= std::max(n, 1.0);
  // Light changes slowly, but what is off from one photo to the next has no memory: as much of the neighbours is used as would have predicted the
  // learned photos best.
  double both = 0.0, neighbours = 0.0;
  for (const std::vector<size_t>& sequence : sequences) {
    for (size_t k = 0; k < sequence.size(); ++k) {
      if (!photos[sequence[k]].learned) continue;
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
      const auto between = photos[photo].learned ? std::nullopt : rest.At(sequence, k);
      for (size_t c = 0; between && c < 3; ++c) {
        const double predicted = mean[c] + memory * ((*between)[c] - mean[c]);
        response.log_gain[3 * photo + c] = static_cast<float>(predicted - (1.0 - trust) * LogExif(response, photo));
      }
    }
  }
}

}  // namespace skyquilt::brightness
