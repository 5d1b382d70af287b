// The colour behind all fields: a coarse height map with blurred colours. Where only one photo or none saw the ground, no geometry can be learned,
// but a rough colour is known or can be interpolated. That looks better than a hole, and is too blurred to be mistaken for surveyed ground.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/checkpoint/archive.h"
#include "core/scene/height_map.h"

namespace skyquilt::scene {

struct Background {
  HeightMap surface;                                    // empty: the mean colour everywhere
  std::vector<float> rgb_srgb;                          // [row][column][channel] of the cells of `surface`, display values at reference exposure
  std::array<float, 3> mean_srgb = {0.0F, 0.0F, 0.0F};  // the survey's mean colour, for rays that do not meet the surface
  // [elevation][azimuth][channel], display values at reference exposure, for rays that rise; elevations from the horizon to the zenith, azimuths from
  // east over north all round. Empty: no photo shows sky.
  static constexpr int kSkyRows = 9, kSkyColumns = 36;
  std::vector<float> sky_srgb = {};
  // [row][column] of the cells of `surface`: training photos that show the cell, 255 for more. Empty: not known, as where photos
  // look level, and in scenes of older programs.
  std::vector<uint8_t> photos = {};

  // Display values where the ray meets the surface, or of the sky in its direction; the mean colour when it does neither.
  std::array<float, 3> Color(const Eigen::Vector3d& origin_enu, const Eigen::Vector3d& direction_enu) const;
};

// Where a direction that rises is in the sky, each 0 to 1: from east over north all round, and from the horizon to the zenith.
Eigen::Vector2d SkyShares(const Eigen::Vector3d& direction_enu);

// The background must outlive the writer's Commit.
void PutBackground(const Background& background, checkpoint::ArchiveWriter& writer);
// Black where the file has none. Throws base::InputError when arrays and attributes disagree.
Background GetBackground(const checkpoint::ArchiveReader& reader, const std::filesystem::path& file);

}  // namespace skyquilt::scene
