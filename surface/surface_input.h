// What the surface of a scene is made from, and where it has surface.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include "core/base/thread_pool.h"
#include "core/geo/block_box.h"
#include "core/gis/boundary.h"
#include "core/image/pixel_cache.h"
#include "core/scene/scene.h"
#include "core/survey/survey.h"
#include "surface/piece_service.h"
#include "surface/surface_options.h"

namespace skyquilt::surface {

// Renders any number of rays (ENU, metres); both spans have the same length. May throw base::Interrupted.
using RayCaster = std::function<void(std::span<const render::Ray>, std::span<render::RayColor>)>;

// The pointers must outlive it.
struct SurfaceInput {
  SurfaceOptions options;
  const scene::SceneInfo* info = nullptr;
  const survey::Survey* survey = nullptr;
  RayCaster caster;                                   // of the scene, at the brightness that the texture shall have
  RayCaster depth_caster;                             // the same where only depths are asked for, up to options.min_opacity; none: caster
  const image::PixelCache* photos = nullptr;          // to refine depths, and for fine detail of the texture; entry i belongs to survey->photos[i]
  std::optional<gis::Boundary> boundary;              // in coordinates of the maps; none: the whole scene
  geo::Vertical vertical = geo::Vertical::kAsTagged;  // of all files but the 3D tiles
  double map_resolution_m = 0.0;                      // cells of the maps
  double memory_bytes = 0.0;                          // the limit, of which the fields of the scene may take half
  double mesh_bytes = 0.0;                            // of them for the mesh of the whole survey; 0: half
  PieceService* pieces = nullptr;                     // makes pieces of the mesh beside this process; null: nobody does
  std::string work_key;                               // identity of scene and options: results of another key are not used
  std::filesystem::path work_folder;                  // results of finished steps, for going on after an interruption
  std::filesystem::path out_folder;
};

// Where a scene has surface that is worth meshing: its blocks with their margins, in which fields are trained too. Beyond them there is only the
// coarse context. Survey ENU, metres.
struct SurfaceBox {
  Eigen::Vector3d min_enu, max_enu;
};

// The box around all blocks; that of the scene where it has none.
inline SurfaceBox SurfaceBoxOf(const scene::SceneInfo& info) {
  SurfaceBox box{info.min_enu, info.max_enu};
  for (const scene::SceneBlock& block : info.blocks) {
    box.min_enu = box.min_enu.cwiseMin(block.TrainMin());
    box.max_enu = box.max_enu.cwiseMax(block.TrainMax());
  }
  return box;
}

}  // namespace skyquilt::surface
