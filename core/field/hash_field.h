// A radiance field: the function from position and direction to density and colour. Encoding (hash grid or a baseline) -> density network -> colour
// network with the direction in spherical harmonics:
//   features = encoding(x)                                FeatureRows() rows
//   geometry = W2 relu(W1 features)                       kGeometryRows rows, row 0 gives the density
//   tau      = exp(geometry[0] + density_bias)            optical depth of one marching step; or softplus or relu (density_activation.h)
//   rgb      = range * sigmoid(W4 relu(W3 [geometry, SH(direction), code]))
// Both networks may have more than one hidden layer.
// Row 0 of the geometry is called the log density; with exp it is that up to a constant, with the others density grows with it.
// With `appearance` a code of so many numbers tells how one photo looks (Martin-Brualla et al. 2021, NeRF in the Wild, section 4.1). The caller has
// the codes; the mean look, which renderings show, is a code of zeros.
// W4 has a fourth row. With `luminance` it is the log luminance of the samples, from which a convolution of width 7 over neighbouring pixels computes
// Omega (core/brightness/luminance.h); the taps and the bias of the convolution are the last parameters. Without `luminance` the row stays zero.
// With `normal_head` a linear map of the geometry rows predicts a normal: its first three rows, in ENU out of the surface, of any length. Its
// kNormalRows x kGeometryRows weights are the last parameters of all.
// The field owns no parameters: it works on flat buffers of the caller (grid: the encoding's parameters; networks: all others), so that optimiser and
// checkpoint handle plain arrays. Batches are structures of arrays, padded as in core/kernel/kernels.h. Functions are const; threads may call them at
// the same time with separate buffers. Source: Mueller et al. 2022; network sizes are configurable.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/base/random.h"
#include "core/encoding/encoding.h"
#include "core/field/density_activation.h"

namespace skyquilt::field {

constexpr int kGeometryRows = 16;
constexpr int kColorRows = 4;      // red, green, blue, luminance
constexpr int kLuminanceTaps = 7;  // of the convolution
constexpr int kNormalRows = 4;     // of the normal head: east, north, up, padding
// Callers should process this many samples at a time: their activations fit into the second-level cache.
constexpr int kChunk = 512;
// Row stride of buffers for one chunk: an odd number of cache lines, so that rows do not fall on the same cache sets.
constexpr int kChunkStride = kChunk + kernel::kStridePad;

struct FieldConfig {
  encoding::Kind encoding = encoding::Kind::kHash;
  encoding::HashGridConfig grid;
  int hidden = 64;                // width of all hidden layers, a multiple of 4
  int density_hidden_layers = 1;  // 1..8
  int color_hidden_layers = 1;    // 1..3
  int sh_degree = 3;              // 1..4
  double color_range = 1.0;       // largest display value of a colour; > 1 leaves headroom for photos darker than the reference
  double density_bias = -5.0;     // log of the initial optical depth of one marching step
  DensityActivation density_activation = DensityActivation::kExp;
  int appearance = 0;           // numbers of an appearance code, 0..32; 0: colour depends on position and direction only
  int multisample = 0;          // positions per sample (core/render/footprint.h): 1, 4 or 6; 0: samples are points without footprint
  bool scale_features = false;  // whether the density network also sees how much its footprint leaves of the levels; not with points
  bool luminance = false;       // whether the luminance row and its convolution are used
  bool normal_head = false;     // whether normals are predicted

  bool Cones() const { return multisample > 0; }
};

// A copy of the network parameters as one matrix per layer, with transposed copies for the backward pass.
struct NetworkWeights {
  std::vector<std::vector<float>> layer;                 // density network, then colour
  std::vector<std::vector<float>> transposed;            // same order
  std::array<float, kLuminanceTaps + 1> luminance = {};  // taps, then bias
  std::vector<float> normal_head, normal_head_transposed;
};

// Activations and gradients of a packet of samples, kept between the forward and the backward pass. One object per thread.
// Rows of `stride` floats. The layers of `density_hidden` and then `geometry` are consecutive, so that one kernel::Compact drops samples from all.
class Activations {
 public:
  // Makes room for n samples (any n). The content is lost when the stride grows.
  void Reserve(const class HashField& field, int64_t n);

  size_t stride = 0;
  int kept_rows = 0;          // rows of density_hidden and geometry together
  bool by_direction = false;  // whether HashField::Backward writes direction_gradient
  float* density_hidden = nullptr;
  float* color_in = nullptr;  // geometry, then spherical harmonics of the direction, then the appearance code
  float* color_hidden[3] = {nullptr, nullptr, nullptr};
  float* color_raw = nullptr;  // before the sigmoid
  // Gradients with respect to the rows of the same name; the log density is row 0 of geometry.
  float* color_gradient = nullptr;
  float* log_density_gradient = nullptr;
  float* geometry_gradient = nullptr;
  float* appearance_gradient = nullptr;  // by the AppearanceRows() rows of color_in; null without codes
  float* direction_gradient = nullptr;   // by the DirectionRows() rows of color_in; written where `by_direction`
  float* hidden_gradient[2] = {nullptr, nullptr};
  float* geometry() const { return color_in; }

 private:
  std::vector<float> buffer_;
};

// Workspace of HashField::DensityGradient and its backward pass. Rows of `stride` floats; one object per thread.
class DensitySlope {
 public:
  // Makes room for n samples (any n).
  void Reserve(const class HashField& field, int64_t n);

  size_t stride = 0;
  float* gradient = nullptr;          // 3 rows: d log density / d position, x first
  float* feature_gradient = nullptr;  // d log density / d feature, of the encoding's rows
  float* features = nullptr;
  float* hidden = nullptr;           // of all layers of the density network, after the ReLU
  float* hidden_gradient = nullptr;  // of the same rows, before the ReLU
  float* tangent = nullptr;          // growth of the features along `along`
  float* hidden_tangent[2] = {nullptr, nullptr};
  float* ones = nullptr;  // kernel::kRowPad rows: 1 in the first row of the samples, else 0

 private:
  std::vector<float> buffer_;
};

class HashField {
 public:
  // Throws std::invalid_argument with the member that is out of range.
  explicit HashField(const FieldConfig& config);

  const FieldConfig& config() const { return config_; }
  const encoding::Encoding& encoding() const { return *encoding_; }
  int64_t GridParameters() const { return encoding_->ParameterCount(); }
  int64_t NetworkParameters() const { return NormalHeadOffset() + (config_.normal_head ? kNormalRows * kGeometryRows : 0); }
  // Index of the luminance taps and bias in the network parameters.
  int64_t LuminanceOffset() const { return network_offsets_.back(); }
  // Index of the normal head's weights in the network parameters.
  int64_t NormalHeadOffset() const { return LuminanceOffset() + (config_.luminance ? kLuminanceTaps + 1 : 0); }
  int FeatureRows() const { return encoding_->OutputRows() + scale_rows_; }
  // Rows after those of the encoding that EncodeScales fills.
  int ScaleRows() const { return scale_rows_; }
  // Of these rows the first are of levels, the rest padding: every second level, with the finest, since neighbouring levels fade alike.
  int ScaledLevels() const { return (config_.grid.levels + 1) / 2; }
  int ScaledLevel(int row) const { return (config_.grid.levels - 1) % 2 + 2 * row; }
  // Rows of all hidden layers of the density network.
  int DensityHiddenRows() const { return config_.density_hidden_layers * config_.hidden; }
  // Rows of the colour network's input: geometry, directions, and AppearanceRows() of the code from row AppearanceRow() on, of which the last may be
  // padding.
  int ColorInputRows() const { return AppearanceRow() + AppearanceRows(); }
  int DirectionRows() const { return kernel::PaddedRows(config_.sh_degree * config_.sh_degree); }
  int AppearanceRow() const { return kGeometryRows + DirectionRows(); }
  int AppearanceRows() const { return kernel::PaddedRows(config_.appearance); }

  // Initial parameters: grid by Encoding::Initialize, networks Xavier uniform, luminance row and bias 0 with equal taps.
  void Initialize(base::Random& random, std::span<float> grid, std::span<float> networks) const;
  // Copies the network parameters into matrices. Throws std::invalid_argument unless there are NetworkParameters() of them.
  NetworkWeights Prepare(std::span<const float> networks) const;

  // Writes the rows after those of the encoding, if there are any: 1 - FootprintWeight of every second level, the part of it that the footprint
  // hides. They have no parameters. rows: the first of them, of n samples.
  void EncodeScales(const kernel::Positions& at, int64_t n, float* rows, size_t stride) const;
  // Computes features[row][s], row stride `stride`, for n samples, on the calling thread.
  void EncodeSerial(std::span<const float> grid, const kernel::Positions& at, int64_t n, float* features, size_t stride) const;
  // Density network. n is a multiple of kernel::kPad. hidden: room for DensityHiddenRows() rows; geometry: kGeometryRows rows.
  void Density(const NetworkWeights& weights, const float* features, size_t feature_stride, int64_t n, float* hidden, size_t hidden_stride,
               float* geometry, size_t geometry_stride) const;
  // The optical depth of one marching step from row 0 of the geometry, by the configuration's activation and at most exp(max_log_tau), max_log_tau <=
  // kernel::kMaxExpLimit. n is a multiple of kernel::kPad. tau may be the same as `geometry`. NaN as in kernel::ExpShifted.
  void StepTau(const float* geometry, int64_t n, float max_log_tau, float* tau) const;
  // Fills the rows of the colour input after the geometry, ColorInputRows() - kGeometryRows, with the spherical harmonics of one direction for
  // `count` samples, and with the code of the mean look, zeros.
  void EncodeDirection(const float direction[3], int64_t count, float* rows, size_t stride) const;
  // After EncodeDirection, whose arguments `rows`, `count` and `stride` are: replaces these zeros by a code of config().appearance numbers.
  void EncodeAppearance(const float* code, int64_t count, float* rows, size_t stride) const;
  // Changes the network parameters so that colours are those with this code where no code is given: the first spherical harmonic is constant, so its
  // weights can take what the code adds to the first layer of the colour network. networks: NetworkParameters(); code: config().appearance numbers.
  void FoldAppearance(std::span<const float> code, std::span<float> networks) const;
  // Backward pass of EncodeDirection for the samples of one ray: adds to gradient[3] the derivatives by the direction. rows_gradient:
  // Activations::direction_gradient from the ray's first sample on.
  void DirectionBackward(const double direction[3], int64_t count, const float* rows_gradient, size_t stride, double gradient[3]) const;
  // Colour network. color_in: ColorInputRows() rows, geometry first. hidden: one buffer of config().hidden rows per hidden layer.
  void Color(const NetworkWeights& weights, const float* color_in, size_t in_stride, int64_t n, float* const hidden[3], size_t hidden_stride,
             float* color_raw, size_t color_stride) const;
  // Backward pass of Density and Color, whose activations are in `a`. Inputs: a.color_gradient, a.log_density_gradient, features. Replaces the
  // encoding's features by their gradient, writes a.appearance_gradient when there are codes and a.direction_gradient when a.by_direction, and adds
  // to network_gradient. more_geometry_gradient: null, or kGeometryRows rows of a.stride that are added to the gradient of the geometry, such as
  // those of NormalHeadBackward.
  void Backward(const NetworkWeights& weights, Activations& a, float* features, size_t feature_stride, int64_t n, float* network_gradient,
                const float* more_geometry_gradient = nullptr) const;
  // The part of it for the density network, for fields that need no colour: a.geometry_gradient in, all kGeometryRows rows.
  void DensityBackward(const NetworkWeights& weights, Activations& a, float* features, size_t feature_stride, int64_t n,
                       float* network_gradient) const;
  // The normal head's rows, before they are made unit vectors (UnitNormal in core/render/density_normal.h). n is a multiple of kernel::kPad; raw:
  // kNormalRows rows, the last zero. Only for fields with a head.
  void PredictNormals(const NetworkWeights& weights, const float* geometry, size_t geometry_stride, int64_t n, float* raw, size_t raw_stride) const;
  // Backward pass of PredictNormals: adds to network_gradient. raw_gradient: kNormalRows rows, the last zero. Writes geometry_gradient (rows of
  // geometry_stride) unless it is null: then the head learns without changing the geometry.
  void NormalHeadBackward(const NetworkWeights& weights, const float* raw_gradient, size_t raw_stride, const float* geometry, size_t geometry_stride,
                          int64_t n, float* geometry_gradient, float* network_gradient) const;
  // The gradient of the log density (row 0 of the geometry) by position in the unit frame, of n samples (any n) on the calling thread: all positions
  // of a sample move together, its footprint stays as it is. Density grows along it, so the outward normal is its negative
  // (core/render/density_normal.h). Writes slope.gradient; slope keeps what the backward pass needs. Throws base::UsageError for an encoding without
  // slope (encoding::Encoding::HasSlope).
  void DensityGradient(const NetworkWeights& weights, std::span<const float> grid, const kernel::Positions& at, int64_t n, DensitySlope& slope) const;
  // Backward pass of DensityGradient, whose content is in `slope`. along: d loss / d gradient, 3 rows of slope.stride. Adds to network_gradient. The
  // gradient of the tables is that of Encoding::TangentBackward with `along` and slope.feature_gradient, see FeatureGradient::along. Positions get no
  // gradient, and a ReLU has no second derivative.
  void DensityGradientBackward(const NetworkWeights& weights, std::span<const float> grid, const kernel::Positions& at, int64_t n, const float* along,
                               DensitySlope& slope, float* network_gradient) const;
  // Multiplications and additions of the networks for one sample, in the forward pass and in a training step, without padding.
  double ForwardFlops() const;
  double TrainFlops() const;

 private:
  struct Layer {
    int outputs, inputs;
  };
  // Indices into layers_: the last layer of the density network and the first of the colour network.
  size_t DensityOutput() const { return static_cast<size_t>(config_.density_hidden_layers); }
  size_t ColorInput() const { return DensityOutput() + 1; }
  static void InitializeNormalHead(base::Random& random, float* head);
  static void PrepareNormalHead(const float* head, NetworkWeights& weights);

  FieldConfig config_;
  std::unique_ptr<const encoding::Encoding> encoding_;
  float raw_shift_ = 0.0F;  // RawShift of the configuration
  int scale_rows_ = 0;
  std::vector<Layer> layers_;             // density network, then colour
  std::vector<int64_t> network_offsets_;  // layers + 1
};

}  // namespace skyquilt::field
