// The inner loops of a radiance field, where training and rendering spend most of their time: small matrix products, hash-grid lookups, exp, sigmoid
// and Adam. Vectorised with Highway: compiled once per instruction set, chosen at run time.
// Matrices are structures of arrays: row r of a batch starts at data + r * stride and has one column per sample. A batch of n samples is padded with
// zeros to a multiple of kPad samples (stride >= padded n; the stride of a single row does not count). No array needs an alignment. Shapes are
// checked once per batch; wrong ones throw std::logic_error (SKYQUILT_CHECK). core/kernel/reference.h has scalar versions of the arithmetic, for
// tests. Every kernel runs on the calling thread and gives the same bits on every call with the same instruction set; instruction sets differ within
// the errors given here, in ulp: the distance between neighbouring floats at the exact result. tests/core/kernel/ulp_test.cpp checks them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace skyquilt::kernel {

// Batches are padded to a multiple of this; a multiple of every supported vector width.
constexpr int kPad = 16;
// Weight matrices are padded with zero rows to a multiple of this.
constexpr int kRowPad = 4;
// Floats per cache line. With row strides that are multiples of a page, all rows fall on the same few cache sets, which is five times slower;
// StrideFor avoids this.
constexpr int kStridePad = 16;

constexpr int64_t Padded(int64_t n) {
  return (n + kPad - 1) / kPad * kPad;
}
constexpr size_t StrideFor(int64_t n) {
  return static_cast<size_t>((Padded(n) / kStridePad + 1) | 1) * kStridePad;  // an odd number of lines
}
constexpr int PaddedRows(int n) {
  return (n + kRowPad - 1) / kRowPad * kRowPad;
}

// Floats per line of a parameter table (one cache line). Training records per line whether its gradient was written. Tables have whole lines.
constexpr int kLineFloats = 16;

// Name of the instruction set in use: "avx3_zen4", "avx3", "avx2", "sse4", ...
std::string ActiveInstructionSet();
// All that this processor can run, best first; the last is the portable one.
std::vector<std::string> InstructionSets();
// Makes all kernels use this instruction set: a name of InstructionSets(), or "avx512", "avx2", "portable".
// Must not be called while kernels run. Throws std::invalid_argument that lists the choices.
void ForceInstructionSet(const std::string& name);

// out[o][s] = sum_i weights[o * n_in + i] * in[i][s], then max(0, .) when relu.
// n_out a multiple of kRowPad, n a multiple of kPad; weights n_out x n_in row-major. out overlaps neither weights nor in.
void Dense(const float* weights, int n_out, int n_in, const float* in, size_t in_stride, int64_t n, bool relu, float* out, size_t out_stride);

// The same without relu, with out[o][s] = 0 where gate[o][s] <= 0: the backward pass through a relu whose output was `gate`.
void DenseGated(const float* weights, int n_out, int n_in, const float* in, size_t in_stride, int64_t n, const float* gate, size_t gate_stride,
                float* out, size_t out_stride);

// weight_gradient[o * n_in + i] += sum_s out_gradient[o][s] * in[i][s]. n_out and n_in multiples of kRowPad, n of kPad; padding columns count in
// the sum, so they must be zero in one of both.
void DenseWeightGradient(const float* out_gradient, size_t out_stride, int n_out, const float* in, size_t in_stride, int n_in, int64_t n,
                         float* weight_gradient);

// True when none of the n values (any n) is infinite or NaN.
bool AllFinite(const float* values, int64_t n);

// The lattice of one level of the multi-resolution hash grid (Mueller et al. 2022, eq. 2-4), of different size per axis.
struct GridLevel {
  float cells_per_unit = 1.0F;  // resolution: cells along an axis of length 1
  int32_t size[3] = {2, 2, 2};  // lattice points per axis, at least 2
  bool dense = true;            // every lattice point has its own entry; false: hashed
  uint32_t entries = 8;         // rows of the table: one per lattice point when dense, a power of two when hashed
};

// Table entry of a lattice point: x + y * size0 + z * size0 * size1 when dense, else (x ^ y * 2654435761 ^ z * 805459861) mod entries.
uint32_t HashIndex(const GridLevel& level, uint32_t x, uint32_t y, uint32_t z);

// Where the samples of a batch are, and how large a part of space each of them stands for. Coordinates in [0, extent]; clamped into the lattice, NaN
// counts as 0.
struct Positions {
  const float* x = nullptr;
  const float* y = nullptr;
  const float* z = nullptr;
  // Per sample 1 / (sqrt(8) s), s: standard deviation of its footprint in unit lengths. 0: infinitely large; infinity, NaN: a point. Null: all
  // points.
  const float* sharpness = nullptr;
  // A sample is the mean of this many positions; position j of sample s is element j * plane + s of x, y and z.
  int points = 1;
  size_t plane = 0;

  // The samples from `first` on.
  Positions From(int64_t first) const { return {x + first, y + first, z + first, sharpness != nullptr ? sharpness + first : nullptr, points, plane}; }
};

// Share of a sample's footprint, a normal distribution, that is inside a cube of edge 1 / cells_per_unit about its centre, along one axis:
// erf(sharpness / cells_per_unit) (Barron et al. 2023, Zip-NeRF, section 3). 1 for footprints much smaller than a cell, 0 for much larger ones.
// From a table; within 2e-6 for sharpness >= 0.
float FootprintWeight(float sharpness, float cells_per_unit);
// 1 - FootprintWeight of n samples (any n): the share that is hidden.
void FootprintHidden(const float* sharpness, int64_t n, float cells_per_unit, float* out);

// Trilinear interpolation for n samples (any n), multiplied by FootprintWeight and averaged over the positions of a sample.
// table: entries x features. out: `features` rows of stride >= n. features is 2 or 4.
void HashForward(const GridLevel& level, int features, const float* table, const Positions& at, int64_t n, float* out, size_t out_stride);

// Backward pass of HashForward: adds to table_gradient and sets touched[line] = 1 for every line of kLineFloats that it writes to.
// Samples whose gradient is all zero are skipped. Positions and footprints get no gradient.
void HashBackward(const GridLevel& level, int features, const Positions& at, int64_t n, const float* out_gradient, size_t out_stride,
                  float* table_gradient, uint8_t* touched);

// Derivatives of the features of HashForward by position, in 1 / unit length, for normals. All positions of a sample move together, and its footprint
// stays as it is. Inside a cell the slope along an axis does not change along that axis; at the cell's faces it jumps. It is 0 along an axis on which
// the position is clamped. Shapes as above; along and position_gradient: 3 rows of stride >= n, x first.

// The backward pass of HashForward to the positions: adds sum_f out_gradient[f][s] d out[f][s] / d position to position_gradient.
void HashSlope(const GridLevel& level, int features, const float* table, const Positions& at, int64_t n, const float* out_gradient, size_t out_stride,
               float* position_gradient, size_t position_stride);
// How the features grow when each sample moves by its `along`: out[f][s] = d out[f][s] / d position . along[s].
void HashTangent(const GridLevel& level, int features, const float* table, const Positions& at, int64_t n, const float* along, size_t along_stride,
                 float* out, size_t out_stride);
// Backward pass of HashTangent to the table, as HashBackward. Samples are also skipped when `along` is zero.
void HashTangentBackward(const GridLevel& level, int features, const Positions& at, int64_t n, const float* along, size_t along_stride,
                         const float* out_gradient, size_t out_stride, float* table_gradient, uint8_t* touched);

// The next six process whole vectors: n is a multiple of kPad. Results may replace their input.

// The largest `limit` of ExpShifted: exp of it is finite.
constexpr float kMaxExpLimit = 88.7F;
// out = exp(min(limit, x + bias)), limit <= kMaxExpLimit. Within 1.1 ulp for bias 0, for all x; x + bias is rounded to a float first, which can cost
// |x + bias| ulp more. NaN gives a finite number that depends on the instruction set: look for it with AllFinite.
void ExpShifted(const float* x, int64_t n, float bias, float limit, float* out);
// out = min(most, log(1 + exp(x + bias))), between 0 and most. Within 2.9 ulp for bias 0, for all x; x + bias is rounded to a float first, as
// in ExpShifted. NaN as there.
void SoftplusShifted(const float* x, int64_t n, float bias, float most, float* out);
// out = min(most, max(0, x + shift)), rounded once. NaN as in ExpShifted.
void ReluShifted(const float* x, int64_t n, float shift, float most, float* out);
// out = range / (1 + exp(-x)), between 0 and range. Within 2.6 ulp for x >= -80; below, the result stays at range * 1.8e-35. NaN as in ExpShifted.
void Sigmoid(const float* x, int64_t n, float range, float* out);
// sin(2 pi turns) and cos(2 pi turns). Within 3.1 ulp for all finite turns, which is at most 1.9e-7; the zeros are exact. Infinity and NaN give NaN.
void SineCosine(const float* turns, int64_t n, float* sine, float* cosine);
// Drops samples: moves the columns s with keep[s] > 0 of every row to the front, in order, and returns their number. With several rows the strides
// must be at least n. in and out may be the same. Up to kPad columns after the kept ones are overwritten, never past column n.
int64_t Compact(const float* keep, int64_t n, int rows, const float* in, size_t in_stride, float* out, size_t out_stride);

struct AdamStep {
  float learning_rate = 1e-2F;
  float beta1 = 0.9F;
  float beta2 = 0.99F;
  float epsilon = 1e-15F;
  float correction1 = 1.0F;  // 1 - beta1^t
  float correction2 = 1.0F;  // 1 - beta2^t
};

// One Adam step for those parameters of touched lines whose gradient is not zero; all others keep value and moments (as in tiny-cuda-nn).
// Then sets these gradients and `touched` to zero. The arrays have lines * kLineFloats values.
// Both Adams: the change of a parameter is within 4.8 ulp for gradients of size 1e-30 to 1e18, unless the two terms of moment1 cancel.
void AdamTouched(const AdamStep& step, int64_t lines, uint8_t* touched, float* table, float* table_gradient, float* moment1, float* moment2);
// One Adam step for n consecutive parameters; adds l2 * parameter to the gradient (L2 decay). Then sets the gradient to zero.
void AdamDense(const AdamStep& step, float l2, int64_t n, float* parameters, float* gradient, float* moment1, float* moment2);

}  // namespace skyquilt::kernel
