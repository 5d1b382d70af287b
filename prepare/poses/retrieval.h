// Which photos look alike, without knowing where they were taken: each feature becomes the nearest of a few thousand visual words that are learned
// from the survey itself, and photos are compared by the words that they have (Sivic and Zisserman 2003, "Video Google"): square roots of their
// numbers, so that repeated patterns count less (Jegou et al. 2009), times the logarithm of how rare they are.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/base/thread_pool.h"

namespace skyquilt::prepare::poses {

struct RetrievalOptions {
  size_t words = 4096;               // fewer where there are fewer than 8 sampled descriptors for each
  size_t sample = 65536;             // descriptors that words are learned from, in equal parts of all photos
  int rounds = 8;                    // of k-means
  size_t features_per_photo = 2048;  // the first that `load` gives
  uint64_t seed = 1;
};

class PhotoIndex {
 public:
  // load(i): SIFT descriptors of photo i (rows of 128 bytes, length about 512), those that are found again most surely first; it is called by one
  // thread at a time, twice for each photo. The same input gives the same index with any number of threads. Shows progress. Throws what `load`
  // throws, and base::Interrupted.
  PhotoIndex(size_t n_photos, const std::function<std::vector<uint8_t>(size_t)>& load, const RetrievalOptions& options, base::ThreadPool& threads);

  size_t size() const { return n_photos_; }
  size_t n_words() const { return n_words_; }
  // Cosine of the angle between the weighted words of the photo and of every photo, 0 to 1; 0 for photos without features, and for itself.
  std::vector<float> Similarities(size_t photo) const;
  // At most n others with a similarity above 0, the most similar first.
  std::vector<uint32_t> MostSimilar(size_t photo, size_t n) const;

 private:
  struct Entry {
    uint32_t number;  // of a word or of a photo
    float weight;
  };
  size_t n_photos_;
  size_t n_words_ = 0;
  std::vector<std::vector<Entry>> words_of_photo_;
  std::vector<std::vector<Entry>> photos_of_word_;  // the inverted file
};

// Words for descriptors (rows of 128 bytes): means of the descriptors nearest to them by angle, of length 512 again. options.words of them at most.
std::vector<uint8_t> LearnWords(std::span<const uint8_t> sample, const RetrievalOptions& options, base::ThreadPool& threads);

}  // namespace skyquilt::prepare::poses
