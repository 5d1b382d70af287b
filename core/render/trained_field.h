// A field with its parameters, occupancy and place in the survey: what training leaves behind and rendering reads.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/checkpoint/archive.h"
#include "core/encoding/space_map.h"
#include "core/field/hash_field.h"
#include "core/field/occupancy_grid.h"

namespace skyquilt::render {

struct TrainedField {
  std::string name;
  field::FieldConfig config;
  encoding::SpaceMap map;
  Eigen::Vector3d core_min_enu = Eigen::Vector3d::Zero();  // without margin
  Eigen::Vector3d core_max_enu = Eigen::Vector3d::Zero();
  double margin_m = 0.0;  // trained beyond the core box, horizontally
  double blend_m = 0.0;   // half width of the ramp at its faces; Finish() makes it the margin, 0 is a hard border
  double step_m = 0.1;    // marching step inside the uncontracted part = the length that log density refers to
  std::vector<float> grid, networks;
  field::OccupancyGrid occupancy;
  // Training record.
  int64_t steps = 0;
  double seconds = 0.0;
  int64_t samples = 0;

  // Built from the above by Finish().
  std::unique_ptr<field::HashField> field;
  field::NetworkWeights weights;
  void Finish();
  int64_t ParameterCount() const { return static_cast<int64_t>(grid.size() + networks.size()); }
};

// Arrays under `prefix` ("" or "fields/r0c0/"). The field must outlive the writer's Commit.
void PutField(const TrainedField& field, const std::string& prefix, checkpoint::ArchiveWriter& writer);
// What rendering needs of a field that a checkpoint holds (under no prefix), for scenes: tables and networks are copied from there at Commit, the
// tables with this precision and without the entries that no occupied cell reads (field/reached_entries.h); of the occupancy only which cells are
// occupied. Throws base::InputError when the checkpoint's arrays disagree.
void PutFieldOf(const TrainedField& outline, const std::filesystem::path& checkpoint, const std::string& prefix, checkpoint::ArchiveWriter& writer,
                checkpoint::Precision tables = checkpoint::Precision::kFloat32);
// The same without the arrays.
void PutOutline(const TrainedField& field, const std::string& prefix, checkpoint::ArchiveWriter& writer);
// Place and shape of a field, without its arrays. Throws base::InputError for one that cannot be.
TrainedField GetOutline(const checkpoint::ArchiveReader& reader, const std::filesystem::path& file, const std::string& prefix);
// In memory, of a field of this shape.
int64_t HeldParameters(const TrainedField& outline);
// Of a field in a file, without reading its arrays.
int64_t StoredParameters(const checkpoint::ArchiveReader& reader, const std::string& prefix);
int64_t StoredCells(const checkpoint::ArchiveReader& reader, const std::string& prefix);
// occupancy.depth is empty for a field from a scene. Throws base::InputError when arrays and configuration disagree.
TrainedField GetField(const checkpoint::ArchiveReader& reader, const std::filesystem::path& file, const std::string& prefix);

}  // namespace skyquilt::render
