// Writes scene files with all that scene::Scene::Load reads.
#pragma once

#include <filesystem>

#include "core/brightness/response.h"
#include "core/checkpoint/archive.h"
#include "core/geo/geodetic.h"
#include "core/scene/background.h"
#include "core/scene/field_file.h"
#include "core/scene/scene_file.h"
#include "tests/support/random_field.h"

namespace skyquilt::viewer {

constexpr geo::Geodetic kSceneOrigin = {41.0, 2.0, 100.0};

struct WholeScene {
  geo::Geodetic origin = kSceneOrigin;
  bool georeferenced = true;
  uint64_t seed = 10;
  double density_bias = -0.5;
  bool solid = false;  // the block is filled evenly, so that its top, z = 4, is the surface
  bool cones = false;
};

// One block, (0, 0, 0) to (5, 5, 4) metres, in front of a blue background.
inline void WriteWholeScene(const std::filesystem::path& file, const WholeScene& what = {}) {
  render::TrainedField block =
      render::RandomField(what.seed, Eigen::Vector3d::Zero(), Eigen::Vector3d(5.0, 5.0, 4.0), 0.0, what.solid ? 6.0 : what.density_bias);
  block.name = "r0c0";
  if (what.cones) {
    block.config.multisample = 1;
    block.footprint_min_m = 0.01;
    block.footprint_max_m = 0.1;
  }
  if (what.solid) {
    std::fill(block.parameters.grid.begin(), block.parameters.grid.end(), 0.0F);
    std::fill(block.occupancy.occupied.begin(), block.occupancy.occupied.end(), true);
  }
  const brightness::Response response = brightness::Response::Neutral(2, 1);
  scene::Background background;
  background.mean_srgb = {0.1F, 0.3F, 0.8F};
  checkpoint::ArchiveWriter writer(scene::kSceneKind, scene::kSceneVersion);
  writer.SetAttribute("origin_latitude_deg", what.origin.latitude_deg);
  writer.SetAttribute("origin_longitude_deg", what.origin.longitude_deg);
  writer.SetAttribute("origin_height_m", what.origin.height_m);
  writer.SetAttribute("georeferenced", static_cast<int64_t>(what.georeferenced ? 1 : 0));
  brightness::PutResponse(response, writer);
  scene::PutBackground(background, writer);
  writer.SetAttribute("gsd_m", 0.05);
  writer.SetAttribute("config", "");
  writer.SetAttribute("blocks", int64_t{1});
  scene::PutField(block, scene::BlockPrefix(0), writer);
  writer.Commit(file);
}

}  // namespace skyquilt::viewer
