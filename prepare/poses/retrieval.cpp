#include "prepare/poses/retrieval.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <numeric>

#include "core/base/cancel.h"
#include "core/base/progress.h"
#include "core/base/random.h"
#include "core/kernel/descriptors.h"

namespace skyquilt::prepare::poses {
namespace {

constexpr size_t kSamplesPerWord = 8;

constexpr size_t kBytes = kernel::kDescriptorBytes;
constexpr size_t kRowsPerTask = 1024;
constexpr float kDescriptorLength = 512.0F;

size_t Rows(std::span<const uint8_t> descriptors) {
  return descriptors.size() / kBytes;
}

std::span<const uint8_t> RowsOf(std::span<const uint8_t> descriptors, size_t first, size_t n) {
  return descriptors.subspan(first * kBytes, n * kBytes);
}

// The nearest word of each descriptor; -1 for a descriptor without a direction.
void AssignWords(std::span<const uint8_t> descriptors, const kernel::PackedDescriptors& words, std::span<int32_t> word) {
  const kernel::BestDotsBothWays best = kernel::FindBestDots(kernel::PackDescriptors(descriptors), words);
  std::copy(best.of_a.index.begin(), best.of_a.index.end(), word.begin());
}

// `n` of the numbers 0 to total - 1 in random order.
std::vector<size_t> ChooseRows(size_t total, size_t n, base::Random& random) {
  std::vector<size_t> rows(total);
  std::iota(rows.begin(), rows.end(), size_t{0});
  for (size_t i = 0; i < n; ++i) std::swap(rows[i], rows[i + random.Below(static_cast<uint32_t>(total - i))]);
  rows.resize(n);
  return rows;
}

// Stores a direction as a descriptor of length 512; false when it has none.
bool StoreDirection(const std::array<float, kBytes>& sum, std::span<uint8_t> row) {
  float length2 = 0.0F;
  for (const float value : sum) length2 += value * value;
  if (!(length2 > 0.0F)) return false;
  const float scale = kDescriptorLength / std::sqrt(length2);
  for (size_t k = 0; k < kBytes; ++k) row[k] = static_cast<uint8_t>(std::min(255.0F, std::round(scale * sum[k])));
  return true;
}

// A few descriptors of each photo, spread over those that are used.
std::vector<uint8_t> SampleOf(std::span<const uint8_t> descriptors, size_t n, base::Random& random) {
  std::vector<uint8_t> sample;
  const size_t total = Rows(descriptors);
  for (const size_t row : ChooseRows(total, std::min(n, total), random)) {
    const auto bytes = RowsOf(descriptors, row, 1);
    sample.insert(sample.end(), bytes.begin(), bytes.end());
  }
  return sample;
}

}  // namespace

std::vector<uint8_t> LearnWords(std::span<const uint8_t> sample, const RetrievalOptions& options, base::ThreadPool& threads) {
  const size_t total = Rows(sample);
  const size_t n_words = std::min({options.words, std::max<size_t>(total / kSamplesPerWord, 1), total});
  base::Random random(options.seed, 1);
  std::vector<uint8_t> words;
  for (const size_t row : ChooseRows(total, n_words, random)) {
    const auto bytes = RowsOf(sample, row, 1);
    words.insert(words.end(), bytes.begin(), bytes.end());
  }
  std::vector<int32_t> word(total);
  for (int round = 0; round < options.rounds && n_words > 1; ++round) {
    const kernel::PackedDescriptors packed = kernel::PackDescriptors(words);
    threads.ParallelFor(static_cast<int64_t>((total + kRowsPerTask - 1) / kRowsPerTask), [&](int64_t task, int /*thread*/) {
      base::ThrowIfCancelled();
      const size_t first = static_cast<size_t>(task) * kRowsPerTask, n = std::min(kRowsPerTask, total - first);
      AssignWords(RowsOf(sample, first, n), packed, std::span(word).subspan(first, n));
    });
    std::vector<std::array<float, kBytes>> sums(n_words);
    for (size_t row = 0; row < total; ++row) {
      if (word[row] < 0) continue;
      const uint8_t* bytes = sample.data() + row * kBytes;
      std::array<float, kBytes>& sum = sums[static_cast<size_t>(word[row])];
      for (size_t k = 0; k < kBytes; ++k) sum[k] += static_cast<float>(bytes[k]);
    }
    for (size_t i = 0; i < n_words; ++i) {
      const std::span<uint8_t> row = std::span(words).subspan(i * kBytes, kBytes);
      if (StoreDirection(sums[i], row)) continue;
      // A word that no descriptor is nearest to starts again somewhere else.
      const auto other = RowsOf(sample, random.Below(static_cast<uint32_t>(total)), 1);
      std::copy(other.begin(), other.end(), row.begin());
    }
  }
  return words;
}

PhotoIndex::PhotoIndex(size_t n_photos, const std::function<std::vector<uint8_t>(size_t)>& load, const RetrievalOptions& options,
                       base::ThreadPool& threads)
    : n_photos_(n_photos), words_of_photo_(n_photos) {
  const auto load_used = [&](size_t photo) {
    std::vector<uint8_t> descriptors = load(photo);
    descriptors.resize(std::min(Rows(descriptors), options.features_per_photo) * kBytes);
    return descriptors;
  };
  std::vector<uint8_t> sample;
  const size_t per_photo = std::max<size_t>(options.sample / std::max<size_t>(n_photos, 1), 1);
  for (size_t photo = 0; photo < n_photos; ++photo) {
    base::ThrowIfCancelled();
    base::Random random(options.seed, 2 + photo);
    const std::vector<uint8_t> rows = SampleOf(load_used(photo), per_photo, random);
    sample.insert(sample.end(), rows.begin(), rows.end());
  }
  const std::vector<uint8_t> words = LearnWords(sample, options, threads);
  n_words_ = Rows(words);
  photos_of_word_.resize(n_words_);
  const kernel::PackedDescriptors packed = kernel::PackDescriptors(words);

  base::Progress progress("compare photos", static_cast<double>(n_photos), "photos");
  std::mutex loading;
  threads.ParallelFor(static_cast<int64_t>(n_photos), [&](int64_t task, int /*thread*/) {
    base::ThrowIfCancelled();
    const auto photo = static_cast<size_t>(task);
    std::vector<uint8_t> descriptors;
    {
      const std::lock_guard lock(loading);
      descriptors = load_used(photo);
    }
    std::vector<int32_t> word(Rows(descriptors));
    AssignWords(descriptors, packed, word);
    std::sort(word.begin(), word.end());
    for (size_t i = 0; i < word.size();) {
      const auto end = static_cast<size_t>(std::upper_bound(word.begin() + static_cast<std::ptrdiff_t>(i), word.end(), word[i]) - word.begin());
      if (word[i] >= 0) words_of_photo_[photo].push_back({static_cast<uint32_t>(word[i]), std::sqrt(static_cast<float>(end - i))});
      i = end;
    }
    progress.Advance();
  });
  progress.Finish();

  std::vector<size_t> n_with(n_words_, 0);
  for (const auto& words_here : words_of_photo_) {
    for (const Entry& entry : words_here) ++n_with[entry.number];
  }
  for (size_t photo = 0; photo < n_photos; ++photo) {
    double length2 = 0.0;
    for (Entry& entry : words_of_photo_[photo]) {
      // Above 0 even for a word that every photo has, so that photos with the same few words are still alike.
      entry.weight *= std::log((1.0F + static_cast<float>(n_photos)) / (0.5F + static_cast<float>(n_with[entry.number])));
      length2 += static_cast<double>(entry.weight) * static_cast<double>(entry.weight);
    }
    if (!(length2 > 0.0)) continue;
    for (Entry& entry : words_of_photo_[photo]) {
      entry.weight /= static_cast<float>(std::sqrt(length2));
      photos_of_word_[entry.number].push_back({static_cast<uint32_t>(photo), entry.weight});
    }
  }
}

std::vector<float> PhotoIndex::Similarities(size_t photo) const {
  std::vector<float> similarities(n_photos_, 0.0F);
  for (const Entry& word : words_of_photo_[photo]) {
    for (const Entry& other : photos_of_word_[word.number]) similarities[other.number] += word.weight * other.weight;
  }
  for (float& similarity : similarities) similarity = std::min(similarity, 1.0F);
  similarities[photo] = 0.0F;
  return similarities;
}

std::vector<uint32_t> PhotoIndex::MostSimilar(size_t photo, size_t n) const {
  const std::vector<float> similarities = Similarities(photo);
  std::vector<uint32_t> others;
  for (uint32_t other = 0; other < n_photos_; ++other) {
    if (similarities[other] > 0.0F) others.push_back(other);
  }
  n = std::min(n, others.size());
  std::partial_sort(others.begin(), others.begin() + static_cast<std::ptrdiff_t>(n), others.end(),
                    [&](uint32_t a, uint32_t b) { return similarities[a] != similarities[b] ? similarities[a] > similarities[b] : a < b; });
  others.resize(n);
  return others;
}

}  // namespace skyquilt::prepare::poses
