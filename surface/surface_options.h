// Options of section [surface] of the configuration: how the mesh, the point cloud, the tiles and the maps of a scene are made.
#pragma once

#include <vector>

#include "core/config/options.h"

namespace skyquilt::surface {

// Depths where the surface is seen at a larger angle from its normal are not used: along it, a pixel's depth spans many voxels.
constexpr double kMaxAngle_deg = 85.0;
// Holes in the ground up to this area are closed: those under cars and trees, which no photo sees. Larger ones stay open, as nothing tells their
// ground. Where photos look level, so are holes in walls and ceilings.
constexpr double kMaxHole_m2 = 30.0;
// Largest error of the simplification, in voxels: below half a voxel the fused depths say nothing about the surface.
constexpr double kSimplifyVoxels = 0.5;

struct SurfaceOptions {
  bool enabled = true;              // made by 'skyquilt run'
  double voxel_gsd = 1.5;           // cells in which depths are fused, in ground sampling distances of the finest block
  double view_gsd = 2.0;            // pixels of the pictures of depth, in ground sampling distances
  bool refine = true;               // depths of photos are improved by comparing the photos
  bool virtual_views = true;        // also look from above and obliquely where photos leave gaps
  double min_opacity = 0.85;        // depths of pixels with a lower opacity are not used; at least 0.85, where a ray reaches the back of a surface
  double max_spread_voxels = 20.0;  // nor where the surface is blurred by more than this along the ray; where photos look level, across the surface
  int min_views = 3;                // faces seen by fewer views are dropped
  int edge_photos = 3;              // the surface ends where fewer see the ground; 0: not for that reason
  double min_island_m2 = 1.0;       // as are separate pieces with a smaller area; where photos look level, also at most 12 x 12 voxels
  bool fill_gaps = true;            // what is left open is closed by a coarser surface; not where photos look level
  double texel_gsd = 1.0;           // pixels of the texture, in ground sampling distances
  bool photo_texture = true;        // its fine detail is that of photos; otherwise all of it is the field's
  int jpeg_quality = 88;            // of the texture
  bool glb = true, obj = true, ply = true, cloud = true, tiles = true;  // files
  bool maps = true;                                                     // terrain model, height above ground, hillshade, contours
  double terrain_cell_m = 0.5;      // cells in which ground is told from what stands on it; see maps/find_terrain.h for the others
  double terrain_window_m = 60.0;   // size of the largest building
  double terrain_slope = 0.3;       // steepest ground, metres of height per metre
  double terrain_low_m = 0.3;       // what rises less than this above the ground belongs to it
  double terrain_high_m = 3.0;      // what rises more than this never does
  double contour_interval_m = 0.0;  // 0: chosen from the relief

  static std::vector<config::Field<SurfaceOptions>> Fields();
  static std::vector<config::FixedOption> Fixed();
  // Throws base::UsageError that names the option, its value and the rule it breaks.
  void Check() const;
};

}  // namespace skyquilt::surface
