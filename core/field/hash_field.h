// A radiance field: encoding (a hash grid, or a baseline in its place) -> density network -> colour network with spherical-harmonic direction.
//   features = encoding(x)                                FeatureRows() rows
//   geometry = W2 relu(W1 features)                       kGeometryRows rows, row 0 is the log density
//   rgb      = range * sigmoid(W4 relu(W3 [geometry, SH(direction)]))
// Both networks may have more hidden layers than one.
// W4 has a fourth row. With `luminance` it gives the samples' log luminance, from which a convolution of width 7 over neighbouring pixels makes
// Omega (core/brightness/luminance.h); its taps and bias are the last parameters. Without, the row stays zero.
// The field owns no parameters: it works on flat buffers it is handed (grid: the encoding's; then networks), so optimiser and checkpoint see plain
// arrays. All batches are structures of arrays padded as core/kernel/kernels.h asks. Functions are const and safe to call from many threads with
// separate scratch. Source: Mueller et al. 2022; network sizes are configuration.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/base/random.h"
#include "core/encoding/encoding.h"

namespace skyquilt::field {

constexpr int kGeometryRows = 16;
constexpr int kColorRows = 4;      // red, green, blue, luminance
constexpr int kLuminanceTaps = 7;  // of the convolution
// Samples whose activations stay in the second-level cache: what one task should hand over at a time.
constexpr int kChunk = 512;
// Row stride of a chunk's own buffers: an odd number of cache lines, so that rows do not fall on the same cache sets.
constexpr int kChunkStride = kChunk + kernel::kStridePad;

struct FieldConfig {
  encoding::Kind encoding = encoding::Kind::kHash;
  encoding::HashGridConfig grid;
  int hidden = 64;                // width of all hidden layers, a multiple of 4
  int density_hidden_layers = 1;  // 1..8
  int color_hidden_layers = 1;    // 1..3
  int sh_degree = 3;              // 1..4
  double color_range = 1.0;       // largest display value a colour can take; > 1 leaves headroom for photos darker than the reference
  double density_bias = -5.0;     // log optical depth of one marching step at start
  bool luminance = false;
};

// Weights of one moment, with the transposed copies that backward reads.
struct NetworkWeights {
  std::vector<std::vector<float>> layer;                 // density network, then colour
  std::vector<std::vector<float>> transposed;            // same order
  std::array<float, kLuminanceTaps + 1> luminance = {};  // taps, then bias
};

// Activations and gradients of one packet of samples, kept between forward and backward. One per thread.
// Rows of `stride` floats; the layers of `density_hidden` and `geometry` follow each other, so that samples can be dropped from all of them at once.
class Activations {
 public:
  // Makes room for n samples (any n). What was in it is lost when the stride grows.
  void Reserve(const class HashField& field, int64_t n);

  size_t stride = 0;
  int kept_rows = 0;  // of density_hidden and geometry together
  float* density_hidden = nullptr;
  float* color_in = nullptr;  // geometry, then spherical harmonics of the direction
  float* color_hidden[3] = {nullptr, nullptr, nullptr};
  float* color_raw = nullptr;  // before the sigmoid
  // Gradients with respect to the rows of the same name; the log density is row 0 of geometry.
  float* color_gradient = nullptr;
  float* log_density_gradient = nullptr;
  float* geometry_gradient = nullptr;
  float* hidden_gradient[2] = {nullptr, nullptr};
  float* geometry() const { return color_in; }

 private:
  std::vector<float> buffer_;
};

class HashField {
 public:
  // Throws std::invalid_argument naming the field out of range.
  explicit HashField(const FieldConfig& config);

  const FieldConfig& config() const { return config_; }
  const encoding::Encoding& encoding() const { return *encoding_; }
  int64_t GridParameters() const { return encoding_->ParameterCount(); }
  int64_t NetworkParameters() const { return LuminanceOffset() + (config_.luminance ? kLuminanceTaps + 1 : 0); }
  // Where the luminance's taps and bias begin among the network parameters.
  int64_t LuminanceOffset() const { return network_offsets_.back(); }
  int FeatureRows() const { return encoding_->OutputRows(); }
  // Activations of all hidden layers of the density network.
  int DensityHiddenRows() const { return config_.density_hidden_layers * config_.hidden; }
  int ColorInputRows() const { return color_inputs_; }

  // Grid as its encoding asks (Encoding::Initialize), networks Xavier uniform; luminance zero everywhere, with even taps.
  void Initialize(base::Random& random, std::span<float> grid, std::span<float> networks) const;
  // Throws std::invalid_argument when there are not NetworkParameters() of them.
  NetworkWeights Prepare(std::span<const float> networks) const;

  // features[row][s], row stride `stride`, for n positions, part by part on the calling thread.
  void EncodeSerial(std::span<const float> grid, const float* x, const float* y, const float* z, int64_t n, float* features, size_t stride) const;
  // n a multiple of kernel::kPad. hidden: room for DensityHiddenRows() rows; geometry: kGeometryRows rows.
  void Density(const NetworkWeights& weights, const float* features, size_t feature_stride, int64_t n, float* hidden, size_t hidden_stride,
               float* geometry, size_t geometry_stride) const;
  // Spherical harmonics of one direction for `count` samples: ColorInputRows() - kGeometryRows rows.
  void FillDirection(const float direction[3], int64_t count, float* rows, size_t stride) const;
  // color_in: ColorInputRows() rows, geometry first. hidden: one buffer of config().hidden rows per hidden layer.
  void Color(const NetworkWeights& weights, const float* color_in, size_t in_stride, int64_t n, float* const hidden[3], size_t hidden_stride,
             float* color_raw, size_t color_stride) const;
  // Backward of Density and Color on what they left in `a`. In: a.color_gradient, a.log_density_gradient, features; the features'
  // gradient takes their place. network_gradient is added to.
  void Backward(const NetworkWeights& weights, Activations& a, float* features, size_t feature_stride, int64_t n, float* network_gradient) const;
  // Multiplications and additions of the networks for one sample, forward and in all of training, without padding.
  double ForwardFlops() const;
  double TrainFlops() const;

 private:
  struct Layer {
    int outputs, inputs;
  };
  // Among the layers: the density network's last, and the colour network's first.
  size_t DensityOutput() const { return static_cast<size_t>(config_.density_hidden_layers); }
  size_t ColorInput() const { return DensityOutput() + 1; }
  FieldConfig config_;
  std::unique_ptr<const encoding::Encoding> encoding_;
  int color_inputs_ = 0;
  std::vector<Layer> layers_;             // density network, then colour
  std::vector<int64_t> network_offsets_;  // layers + 1
};

}  // namespace skyquilt::field
