// What shows where no field has matter: a coarse plan of heights and blurred colours. A place that a single photo saw, or none, has no
// geometry to learn, but its rough colour is known or can be guessed from around it; better than a hole, and never taken for a survey.
#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <vector>

#include "core/checkpoint/archive.h"
#include "core/scene/height_map.h"

namespace skyquilt::scene {

struct Background {
  HeightMap surface;                                    // empty: the mean colour everywhere
  std::vector<float> rgb_srgb;                          // [row][column][channel] of the surface's cells, display values at reference exposure
  std::array<float, 3> mean_srgb = {0.0F, 0.0F, 0.0F};  // the survey's mean colour: sky, level rays

  // Where the ray meets the surface; the mean colour when it does not.
  std::array<float, 3> Color(const Eigen::Vector3d& origin_enu, const Eigen::Vector3d& direction_enu) const;
};

// The background must outlive the writer's Commit.
void PutBackground(const Background& background, checkpoint::ArchiveWriter& writer);
// Black where the file has none. Throws base::InputError when arrays and attributes disagree.
Background GetBackground(const checkpoint::ArchiveReader& reader, const std::filesystem::path& file);

}  // namespace skyquilt::scene
