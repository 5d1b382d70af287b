#include "surface/surface_options.h"

#include <string>

#include "core/base/errors.h"

namespace skyquilt::surface {

std::vector<config::Field<SurfaceOptions>> SurfaceOptions::Fields() {
  using config::Range;
  using O = SurfaceOptions;
  return {
      {"enabled", &O::enabled, Range(), "make mesh, point cloud, tiles and maps in 'skyquilt run'; 'skyquilt surface' makes them in any case"},
      {"voxel_gsd", &O::voxel_gsd, Range{0.25, 100}, "cells in which depths are fused, in ground sampling distances of the finest block"},
      {"view_gsd", &O::view_gsd, Range{0.25, 100}, "pixels of the pictures of depth, in ground sampling distances"},
      {"refine", &O::refine, Range(), "improve the depths of photos by comparing the photos with each other"},
      {"virtual_views", &O::virtual_views, Range(), "also look at the scene from above and obliquely where photos leave gaps"},
      {"min_opacity", &O::min_opacity, Range{0.85, 0.999}, "depths of pixels with a lower opacity are not used"},
      {"max_spread_voxels", &O::max_spread_voxels, Range{0.1, 1e6},
       "nor depths where the surface is blurred by more than this along the ray; where photos look level, across the surface"},
      {"min_views", &O::min_views, Range{1, 100}, "parts of the surface that fewer views saw are dropped"},
      {"edge_photos", &O::edge_photos, Range{0, 100},
       "the surface ends where fewer photos see the ground, or two where photos overlap little; 0: where the scene ends. Not where photos look "
       "level, "
       "nor with a boundary or ignored ground"},
      {"min_island_m2", &O::min_island_m2, Range{0, 1e9}, "separate pieces of the surface with a smaller area are dropped, square metres"},
      {"fill_gaps", &O::fill_gaps, Range(), "close gaps, such as panes and woods, with a coarser surface, except where photos look level"},
      {"texel_gsd", &O::texel_gsd, Range{0.1, 1000}, "pixels of the texture, in ground sampling distances"},
      {"photo_texture", &O::photo_texture, Range(), "take the fine detail of the texture from photos; otherwise all of it is the trained scene's"},
      {"jpeg_quality", &O::jpeg_quality, Range{1, 100}, "of the texture"},
      {"glb", &O::glb, Range(), "write mesh.glb (glTF 2.0)"},
      {"obj", &O::obj, Range(), "write mesh.obj with its materials and textures"},
      {"ply", &O::ply, Range(), "write mesh.ply, with colours per vertex"},
      {"cloud", &O::cloud, Range(), "write the point cloud: cloud.las (LAS 1.4) and cloud.ply"},
      {"tiles", &O::tiles, Range(), "write tiles/tileset.json (3D Tiles 1.1) and its tiles"},
      {"maps", &O::maps, Range(), "make the terrain model, height above ground, hillshade and contours"},
      {"terrain_cell_m", &O::terrain_cell_m, Range{0.01, 100}, "terrain: cells in which ground is told from what stands on it, metres"},
      {"terrain_window_m", &O::terrain_window_m, Range{1, 1e4}, "terrain: size of the largest building, metres"},
      {"terrain_slope", &O::terrain_slope, Range{0, 10}, "terrain: steepest ground, metres of height per metre"},
      {"terrain_low_m", &O::terrain_low_m, Range{0.01, 10}, "terrain: what rises less than this above the ground belongs to it, metres"},
      {"terrain_high_m", &O::terrain_high_m, Range{0.1, 100}, "terrain: what rises more than this above the ground never belongs to it, metres"},
      {"contour_interval_m", &O::contour_interval_m, Range{0, 1e4}, "height between contours, metres; 0: chosen from the relief"},
  };
}

std::vector<config::FixedOption> SurfaceOptions::Fixed() {
  return {{"max_angle_deg", kMaxAngle_deg},
          {"max_hole_m2", kMaxHole_m2},
          {"odm_names", false},  // 'skyquilt odm' provides OpenDroneMap's names
          {"simplify_voxels", kSimplifyVoxels}};
}

void SurfaceOptions::Check() const {
  config::CheckRanges("surface", *this);
  if (terrain_high_m < terrain_low_m) {
    throw base::UsageError("surface.terrain_high_m = " + std::to_string(terrain_high_m) +
                           " is not allowed: it must not be below terrain_low_m = " + std::to_string(terrain_low_m));
  }
}

}  // namespace skyquilt::surface
