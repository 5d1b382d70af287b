// A radiance field: hash grid -> density network -> colour network with spherical-harmonic direction.
//   features = grid(x)                                    levels * features rows
//   geometry = W2 relu(W1 features)                       kGeometryRows rows, row 0 is the log density
//   rgb      = range * sigmoid(W4 relu(W3 [geometry, SH(direction)]))
// The field owns no parameters: it works on flat buffers it is handed (grid, then networks), so optimiser and checkpoint see plain arrays.
// All batches are structures of arrays padded as core/kernel/kernels.h asks. Functions are const and safe to call from many threads
// with separate scratch. Source: Mueller et al. 2022; network sizes are configuration.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/random.h"
#include "core/base/thread_pool.h"
#include "core/encoding/hash_grid.h"

namespace skyquilt::field {

constexpr int kGeometryRows = 16;
constexpr int kColorRows = 4;  // 3 used; padded to the kernels' row multiple
// Samples handled by one task; activations of one chunk stay in the second-level cache.
constexpr int kChunk = 512;
// Row stride of a chunk's own buffers: an odd number of cache lines, so that rows do not fall on the same cache sets.
constexpr int kChunkStride = kChunk + kernel::kStridePad;

struct FieldConfig {
  encoding::HashGridConfig grid;
  int hidden = 64;              // width of all hidden layers, a multiple of 4
  int color_hidden_layers = 1;  // 1..3
  int sh_degree = 3;            // 1..4
  double color_range = 1.0;     // largest display value a colour can take; > 1 leaves headroom for photos darker than the reference
  double density_bias = -5.0;   // log optical depth of one marching step at start
};

// Weights of one moment, with the transposed copies that backward reads.
struct NetworkWeights {
  std::vector<std::vector<float>> layer;       // density 2, then colour
  std::vector<std::vector<float>> transposed;  // same order
};

// Activations of one chunk. Allocate once per thread.
struct ChunkScratch {
  std::vector<float> hidden[4];
  std::vector<float> gradient[2];
  std::vector<float> color_in;
  std::vector<float> color_in_gradient;
};

class HashField {
 public:
  // Throws std::invalid_argument naming the field out of range.
  explicit HashField(const FieldConfig& config);

  const FieldConfig& config() const { return config_; }
  const encoding::HashGrid& grid() const { return grid_; }
  int64_t GridParameters() const { return grid_.ParameterCount(); }
  int64_t NetworkParameters() const { return network_offsets_.back(); }
  int FeatureRows() const { return grid_.OutputRows(); }
  int ColorInputRows() const { return color_inputs_; }

  // Grid uniform in +-1e-4, networks Xavier uniform; padding rows zero.
  void Initialize(base::Random& random, std::span<float> grid, std::span<float> networks) const;
  NetworkWeights Prepare(std::span<const float> networks) const;
  ChunkScratch MakeScratch() const;

  // features[row][s], row stride `stride`, for n positions. Parallel over levels and stretches of samples.
  void Encode(std::span<const float> grid, const float* x, const float* y, const float* z, int64_t n, float* features, size_t stride,
              base::ThreadPool& threads) const;
  // The same on the calling thread, for callers that are parallel themselves.
  void EncodeSerial(std::span<const float> grid, const float* x, const float* y, const float* z, int64_t n, float* features, size_t stride) const;
  // One chunk, n <= kChunk a multiple of kernel::kPad. geometry: kGeometryRows rows.
  void Density(const NetworkWeights& weights, const float* features, size_t feature_stride, int64_t n, ChunkScratch& scratch, float* geometry,
               size_t geometry_stride) const;
  // color_raw: kColorRows rows, before the sigmoid. direction: x, y, z rows of length n.
  void Color(const NetworkWeights& weights, const float* geometry, size_t geometry_stride, const float* direction, size_t direction_stride, int64_t n,
             ChunkScratch& scratch, float* color_raw, size_t color_stride) const;
  // Backward of Color and Density for the same chunk (activations are computed again: cheaper than keeping them).
  // In: color_gradient w.r.t. color_raw, log_density_gradient w.r.t. geometry row 0 from rendering (row of n).
  // Out: feature_gradient rows (overwritten), network_gradient (added to).
  void Backward(const NetworkWeights& weights, const float* features, size_t feature_stride, const float* direction, size_t direction_stride,
                int64_t n, const float* color_gradient, size_t color_stride, const float* log_density_gradient, ChunkScratch& scratch,
                float* feature_gradient, size_t feature_gradient_stride, float* network_gradient) const;

 private:
  void FillColorInput(const float* geometry, size_t geometry_stride, const float* direction, size_t direction_stride, int64_t n,
                      ChunkScratch& scratch) const;

  struct Layer {
    int outputs, inputs;
  };
  FieldConfig config_;
  encoding::HashGrid grid_;
  int color_inputs_ = 0;
  std::vector<Layer> layers_;             // density 2, then colour
  std::vector<int64_t> network_offsets_;  // layers + 1
};

}  // namespace skyquilt::field
