#include "core/brightness/predict_gains.h"

#include <algorithm>
#include <cmath>

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

void PredictGains(const std::vector<CapturedPhoto>& photos, Response& response) {
  SKYQUILT_CHECK(photos.size() == response.photos(), "one entry per photo");
  const double trust = TrustInTags(response, photos);
  // What the trusted part of the tags leaves of a learned photo's gain.
  const auto rest = [&](size_t photo, size_t c) {
    return static_cast<double>(response.log_gain[3 * photo + c]) + (1.0 - trust) * LogExif(response, photo);
  };
  for (const std::vector<size_t>& sequence : Sequences(photos)) {
    for (size_t k = 0; k < sequence.size(); ++k) {
      const size_t photo = sequence[k];
      if (photos[photo].learned) continue;
      size_t before = k, after = k;
      while (before > 0 && !photos[sequence[before]].learned) --before;
      while (after + 1 < sequence.size() && !photos[sequence[after]].learned) ++after;
      const bool has_before = photos[sequence[before]].learned, has_after = photos[sequence[after]].learned;
      if (!has_before && !has_after) continue;
      const size_t a = has_before ? sequence[before] : sequence[after], b = has_after ? sequence[after] : sequence[before];
      const double span = photos[b].order - photos[a].order;
      const double share = span > 0.0 ? (photos[photo].order - photos[a].order) / span : 0.5;
      for (size_t c = 0; c < 3; ++c) {
        const double between = (1.0 - share) * rest(a, c) + share * rest(b, c);
        response.log_gain[3 * photo + c] = static_cast<float>(between - (1.0 - trust) * LogExif(response, photo));
      }
    }
  }
}

}  // namespace skyquilt::brightness
