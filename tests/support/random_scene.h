// Writes a scene file of random fields side by side, with a context around them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/checkpoint/archive.h"
#include "core/scene/field_file.h"
#include "core/scene/scene_file.h"
#include "tests/support/random_field.h"

namespace skyquilt::scene {

constexpr double kRandomBlock_m = 5.0;  // edge of a block

// rows x columns blocks, 4 m high, starting at (0, 0): eastwards, row by row from the south. The file contains everything that FieldStore reads.
inline void WriteRandomScene(const std::filesystem::path& file, int rows, int columns, double margin_m, double density_bias, bool with_context) {
  std::vector<render::TrainedField> blocks;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const Eigen::Vector3d low(kRandomBlock_m * column, kRandomBlock_m * row, 0.0);
      const auto seed = 10 + static_cast<uint64_t>(row) * static_cast<uint64_t>(columns) + static_cast<uint64_t>(column);
      blocks.push_back(render::RandomField(seed, low, low + Eigen::Vector3d(kRandomBlock_m, kRandomBlock_m, 4.0), margin_m, density_bias));
      blocks.back().name = "r" + std::to_string(row) + "c" + std::to_string(column);
    }
  }
  const Eigen::Vector3d far_corner(kRandomBlock_m * columns, kRandomBlock_m * rows, 4.0);
  render::TrainedField context = render::RandomField(5, Eigen::Vector3d::Zero(), far_corner, 0.0, density_bias - 1.0, true);
  context.name = "context";
  checkpoint::ArchiveWriter writer(kSceneKind, kSceneVersion);
  writer.SetAttribute("blocks", static_cast<int64_t>(blocks.size()));
  for (size_t i = 0; i < blocks.size(); ++i) PutField(blocks[i], BlockPrefix(static_cast<int64_t>(i)), writer);
  if (with_context) PutField(context, kContextPrefix, writer);
  writer.Commit(file);
}

}  // namespace skyquilt::scene
