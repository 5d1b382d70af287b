// The inner loops of the field, one source for every instruction set, chosen at run time (Highway).
// All matrices are structures of arrays: row r of a batch starts at data + r * stride; a batch of n samples is padded with zeros to a
// multiple of kPad samples (stride >= padded n; the stride of a single row does not count). Shapes are checked once per batch: SKYQUILT_CHECK throws
// std::logic_error. No array needs an alignment. Scalar twins of the arithmetic: core/kernel/reference.h.
// Every kernel is single-threaded and gives the same bits on every call on one instruction set; instruction sets differ within the errors given here.
// Errors are in ulp, the distance between neighbouring floats at the exact result; tests/core/kernel/ulp_test.cpp holds every kernel to them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace skyquilt::kernel {

// Samples per vector group: a multiple of every supported vector width.
constexpr int kPad = 16;
// Rows of a weight matrix are padded to a multiple of this with zero rows.
constexpr int kRowPad = 4;
// One cache line of floats. Row strides that are multiples of a page put all rows on the same few cache sets and cost a factor of five;
// StrideFor avoids them.
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

// One cache line of table parameters: the unit in which touched entries are remembered. Tables are whole numbers of lines.
constexpr int kLineFloats = 16;

// Name of the instruction set in use: "avx3_zen4", "avx3", "avx2", "sse4", ...
std::string ActiveInstructionSet();
// All that this processor can run, best first; the last is the portable one. Asking changes nothing.
std::vector<std::string> InstructionSets();
// Runs every kernel on one of them from now on: a name of InstructionSets(), or "avx512", "avx2", "portable".
// Throws std::invalid_argument naming the choices. Not while kernels run.
void ForceInstructionSet(const std::string& name);

// out[o][s] = sum_i weights[o * n_in + i] * in[i][s], then max(0, .) when relu.
// n_out a multiple of kRowPad, n a multiple of kPad; weights n_out x n_in row-major. out overlaps neither weights nor in.
void Dense(const float* weights, int n_out, int n_in, const float* in, size_t in_stride, int64_t n, bool relu, float* out, size_t out_stride);

// The same without relu, with out[o][s] = 0 where gate[o][s] <= 0: the gradient that passes back through a relu of result `gate`.
void DenseGated(const float* weights, int n_out, int n_in, const float* in, size_t in_stride, int64_t n, const float* gate, size_t gate_stride,
                float* out, size_t out_stride);

// weight_gradient[o * n_in + i] += sum_s out_gradient[o][s] * in[i][s]. n_out and n_in multiples of kRowPad, n of kPad; padding columns count in
// the sum, so they must be zero in one of both.
void DenseWeightGradient(const float* out_gradient, size_t out_stride, int n_out, const float* in, size_t in_stride, int n_in, int64_t n,
                         float* weight_gradient);

// No infinity and no NaN among n values (any n).
bool AllFinite(const float* values, int64_t n);

// One level of the multi-resolution hash grid (Mueller et al. 2022, eq. 2-4), with its own size per axis.
struct HashLevel {
  float cells_per_unit = 1.0F;  // resolution: cells along an axis of length 1
  int32_t size[3] = {2, 2, 2};  // lattice points per axis, at least 2
  bool dense = true;            // every corner has its own entry
  uint32_t entries = 8;         // rows of the table: every lattice point's when dense, a power of two when hashed
};

// Entry of a lattice point: x + y * size0 + z * size0 * size1 when dense, else (x ^ y * 2654435761 ^ z * 805459861) mod entries.
uint32_t HashIndex(const HashLevel& level, uint32_t x, uint32_t y, uint32_t z);

// Trilinear lookup of n positions (any n). position: x, y, z rows of length n in [0, extent]; clamped into the lattice.
// table: entries x features. out: `features` rows of stride >= n. features is 2 or 4.
void HashForward(const HashLevel& level, int features, const float* table, const float* x, const float* y, const float* z, int64_t n, float* out,
                 size_t out_stride);

// Adds the gradient of the lookup to table_gradient and sets touched[line] = 1 for every line of kLineFloats that it writes to.
// Samples with an all-zero gradient are skipped.
void HashBackward(const HashLevel& level, int features, const float* x, const float* y, const float* z, int64_t n, const float* out_gradient,
                  size_t out_stride, float* table_gradient, uint8_t* touched);

// These four work on whole vectors: n is a multiple of kPad. Results may replace their input.

// exp of it is finite.
constexpr float kMaxExpLimit = 88.7F;
// out = exp(min(limit, x + bias)), limit <= kMaxExpLimit. Within 1.1 ulp for bias 0, for all x; x + bias is rounded to a float first, which can cost
// |x + bias| ulp more. NaN gives a finite number that depends on the instruction set: look for it with AllFinite.
void ExpShifted(const float* x, int64_t n, float bias, float limit, float* out);
// out = range / (1 + exp(-x)), between 0 and range. Within 2.6 ulp for x >= -80; below, the result stays at range * 1.8e-35. NaN as in ExpShifted.
void Sigmoid(const float* x, int64_t n, float range, float* out);
// Sine and cosine of 2 pi turns. Within 3.1 ulp for all finite turns, which is at most 1.9e-7; the zeros are exact. Infinity and NaN give NaN.
void SineCosine(const float* turns, int64_t n, float* sine, float* cosine);
// Moves the columns s with keep[s] > 0 of every row to the front, in order; returns how many. Strides of several rows at least n; in may be
// out. Up to kPad columns behind the kept ones are overwritten, never past column n.
int64_t Compact(const float* keep, int64_t n, int rows, const float* in, size_t in_stride, float* out, size_t out_stride);

struct AdamStep {
  float learning_rate = 1e-2F;
  float beta1 = 0.9F;
  float beta2 = 0.99F;
  float epsilon = 1e-15F;
  float correction1 = 1.0F;  // 1 - beta1^t
  float correction2 = 1.0F;  // 1 - beta2^t
};

// Adam on the parameters of touched lines whose gradient is not zero; the others keep value and moments (tiny-cuda-nn's rule).
// Clears gradients and marks. Arrays of lines * kLineFloats.
// Both Adams: the change of a parameter is within 4.8 ulp for gradients of size 1e-30 to 1e18, unless the two terms of moment1 cancel.
void AdamTouched(const AdamStep& step, int64_t lines, uint8_t* touched, float* table, float* table_gradient, float* moment1, float* moment2);
// Adam on n consecutive parameters (any n) with L2 decay; clears the gradient.
void AdamDense(const AdamStep& step, float l2, int64_t n, float* parameters, float* gradient, float* moment1, float* moment2);

}  // namespace skyquilt::kernel
