// Interface of the encodings, which map a position to the features that are the input of the density network: the hash grid, and baselines to compare
// it with. A new encoding is a new subclass.
// An encoding consists of parts (for a hash grid its levels). Each part has its own range of one flat parameter buffer (maybe empty) and writes its
// own rows of the features, so that different threads can work on different parts and the table of one part stays in cache. Batches are structures of
// arrays (core/kernel/kernels.h), positions in [0, extent]; positions outside are clamped, NaN counts as 0. Functions are const, keep no state and
// give the same bits on every call.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/base/random.h"
#include "core/kernel/kernels.h"

namespace skyquilt::encoding {

enum class Kind {
  kHash,       // multi-resolution hash grid: hash_grid.h
  kVoxels,     // one dense lattice: voxel_grid.h
  kPlanes,     // planes times lines: plane_factors.h
  kFrequency,  // sines and cosines, no parameters: frequency.h
};

// "hash", "voxels", "planes", "frequency".
std::string Name(Kind kind);
// Throws std::invalid_argument that lists the choices.
Kind KindNamed(const std::string& name);

// Describes a hash grid. The other kinds derive their size from it, so that fields with the same configuration are comparable.
struct HashGridConfig {
  int levels = 8;                      // 1..16
  int features = 4;                    // per entry: 2 or 4
  int log2_table_size = 17;            // 1..24; entries per hashed level
  double base_resolution = 16;         // cells per unit length of the coarsest level, >= 1
  double finest_resolution = 512;      // of the finest, >= base
  double extent[3] = {1.0, 1.0, 1.0};  // box edges in (0, 1], the longest is 1

  // Throws std::invalid_argument with the member that is out of range.
  void Check() const;
};

// Cells per unit length of a level: from base to finest in equal ratios.
double LevelResolution(const HashGridConfig& config, int level);

class Encoding {
 public:
  virtual ~Encoding() = default;

  virtual Kind kind() const = 0;
  int parts() const { return static_cast<int>(rows_.size()) - 1; }
  // First feature row of a part; FirstRow(parts()) is the number of all rows, a multiple of kernel::kRowPad.
  int FirstRow(int part) const { return rows_[static_cast<size_t>(part)]; }
  int OutputRows() const { return rows_.back(); }
  // Start of a part in the flat parameter buffer, in floats; a multiple of kernel::kLineFloats. The padding before it is never used.
  int64_t Offset(int part) const { return offsets_[static_cast<size_t>(part)]; }
  int64_t ParameterCount() const { return offsets_.back(); }

  // Sets the initial values of all ParameterCount() parameters. By default uniform in +-1e-4 (Mueller et al. 2022, section 4).
  virtual void Initialize(base::Random& random, std::span<float> parameters) const;
  // Computes the part's feature rows for n samples (any n); footprints weaken features that are finer than they are. table: the part's parameters.
  // out: the part's first row.
  virtual void Forward(int part, const float* table, const kernel::Positions& at, int64_t n, float* out, size_t out_stride) const = 0;
  // Backward pass: adds to table_gradient and sets touched[line] = 1 for every line of kernel::kLineFloats that it writes to. Samples whose gradient
  // is all zero are skipped. table as in Forward; out_gradient: the part's first row.
  virtual void Backward(int part, const float* table, const kernel::Positions& at, int64_t n, const float* out_gradient, size_t out_stride,
                        float* table_gradient, uint8_t* touched) const = 0;

  // The lattice in which a part interpolates all its features; null for encodings that do something else.
  virtual const kernel::GridLevel* InterpolatesIn(int /*part*/) const { return nullptr; }
  // The features' derivatives by position, for normals, as kernel::HashSlope, HashTangent and HashTangentBackward. Only encodings whose parts
  // interpolate in a lattice (`hash`, `voxels`) have them; the functions throw base::UsageError for others.
  bool HasSlope() const { return InterpolatesIn(0) != nullptr; }
  void Slope(int part, const float* table, const kernel::Positions& at, int64_t n, const float* out_gradient, size_t out_stride,
             float* position_gradient, size_t position_stride) const;
  void Tangent(int part, const float* table, const kernel::Positions& at, int64_t n, const float* along, size_t along_stride, float* out,
               size_t out_stride) const;
  void TangentBackward(int part, const kernel::Positions& at, int64_t n, const float* along, size_t along_stride, const float* out_gradient,
                       size_t out_stride, float* table_gradient, uint8_t* touched) const;

 protected:
  // For constructors: appends a part with this many feature rows and parameters (rounded up to whole lines of kernel::kLineFloats).
  void AddPart(int rows, int64_t floats);

 private:
  const kernel::GridLevel& RequireLattice(int part) const;
  int RowsOf(int part) const { return FirstRow(part + 1) - FirstRow(part); }

  std::vector<int> rows_ = {0};         // parts + 1
  std::vector<int64_t> offsets_ = {0};  // parts + 1
};

// Throws std::invalid_argument with the member of the configuration that is out of range.
std::unique_ptr<const Encoding> MakeEncoding(Kind kind, const HashGridConfig& config);

}  // namespace skyquilt::encoding
