#include "core/encoding/encoding.h"

#include <cmath>
#include <stdexcept>

#include "core/base/errors.h"
#include "core/encoding/frequency.h"
#include "core/encoding/hash_grid.h"
#include "core/encoding/plane_factors.h"
#include "core/encoding/voxel_grid.h"

namespace skyquilt::encoding {
namespace {

constexpr Kind kKinds[] = {Kind::kHash, Kind::kVoxels, Kind::kPlanes, Kind::kFrequency};

void RequireGrid(bool ok, const std::string& what) {
  if (!ok) throw std::invalid_argument("encoding: " + what);
}

}  // namespace

std::string Name(Kind kind) {
  switch (kind) {
    case Kind::kHash:
      return "hash";
    case Kind::kVoxels:
      return "voxels";
    case Kind::kPlanes:
      return "planes";
    case Kind::kFrequency:
      return "frequency";
  }
  throw std::invalid_argument("encoding: unknown kind " + std::to_string(static_cast<int>(kind)));
}

Kind KindNamed(const std::string& name) {
  std::string choices;
  for (const Kind kind : kKinds) {
    if (Name(kind) == name) return kind;
    choices += (choices.empty() ? "\"" : ", \"") + Name(kind) + "\"";
  }
  throw std::invalid_argument("encoding must be one of " + choices + ", got \"" + name + "\"");
}

void HashGridConfig::Check() const {
  RequireGrid(levels >= 1 && levels <= 16, "levels must be 1..16, got " + std::to_string(levels));
  RequireGrid(features == 2 || features == 4, "features must be 2 or 4, got " + std::to_string(features));
  RequireGrid(levels * features % kernel::kRowPad == 0, "levels * features must be a multiple of 4");
  RequireGrid(log2_table_size >= 1 && log2_table_size <= 24, "log2_table_size must be 1..24, got " + std::to_string(log2_table_size));
  RequireGrid(base_resolution >= 1.0 && std::isfinite(base_resolution), "base_resolution must be at least 1");
  RequireGrid(finest_resolution >= base_resolution && finest_resolution <= 1e6, "finest_resolution must be from base_resolution to 1e6");
  for (const double edge : extent) RequireGrid(edge > 0.0 && edge <= 1.0, "extent must be in (0, 1]");
}

void Encoding::Initialize(base::Random& random, std::span<float> parameters) const {
  for (float& value : parameters) value = static_cast<float>(random.Uniform(-1e-4, 1e-4));
}

void Encoding::AddPart(int rows, int64_t floats) {
  rows_.push_back(rows_.back() + rows);
  offsets_.push_back(offsets_.back() + (floats + kernel::kLineFloats - 1) / kernel::kLineFloats * kernel::kLineFloats);
}

const kernel::GridLevel& Encoding::RequireLattice(int part) const {
  const kernel::GridLevel* const lattice = InterpolatesIn(part);
  if (lattice == nullptr) {
    throw base::UsageError("the encoding \"" + Name(kind()) +
                           "\" has no normals of the density: choose \"hash\" or \"voxels\" (train.encoding), or " + "normals of the depth");
  }
  return *lattice;
}

void Encoding::Slope(int part, const float* table, const kernel::Positions& at, int64_t n, const float* out_gradient, size_t out_stride,
                     float* position_gradient, size_t position_stride) const {
  kernel::HashSlope(RequireLattice(part), RowsOf(part), table, at, n, out_gradient, out_stride, position_gradient, position_stride);
}

void Encoding::Tangent(int part, const float* table, const kernel::Positions& at, int64_t n, const float* along, size_t along_stride, float* out,
                       size_t out_stride) const {
  kernel::HashTangent(RequireLattice(part), RowsOf(part), table, at, n, along, along_stride, out, out_stride);
}

void Encoding::TangentBackward(int part, const kernel::Positions& at, int64_t n, const float* along, size_t along_stride, const float* out_gradient,
                               size_t out_stride, float* table_gradient, uint8_t* touched) const {
  kernel::HashTangentBackward(RequireLattice(part), RowsOf(part), at, n, along, along_stride, out_gradient, out_stride, table_gradient, touched);
}

std::unique_ptr<const Encoding> MakeEncoding(Kind kind, const HashGridConfig& config) {
  switch (kind) {
    case Kind::kHash:
      return std::make_unique<HashGrid>(config);
    case Kind::kVoxels:
      return std::make_unique<VoxelGrid>(config);
    case Kind::kPlanes:
      return std::make_unique<PlaneFactors>(config);
    case Kind::kFrequency:
      return std::make_unique<Frequency>(config);
  }
  throw std::invalid_argument("encoding: unknown kind " + std::to_string(static_cast<int>(kind)));
}

}  // namespace skyquilt::encoding
