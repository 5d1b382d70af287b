// How the poses of photos are found: the part of prepare's options that COLMAP and the matching need, and the settings of the fast way.
#pragma once

#include <cstddef>
#include <string>

namespace skyquilt::prepare::poses {

struct PoseOptions {
  bool fast = true;        // own pairs and own matching; false: COLMAP does everything, with its own settings
  bool seed_poses = true;  // in the fast way, poses by tags and matches where that works; false: always by COLMAP's mapper
  std::string colmap = "colmap";
  std::string camera_model = "OPENCV";
  int max_image_size = 1600;  // pixels
  int max_features = 8192;    // per photo
  bool use_gpu = false;       // of COLMAP, for features; for matches only where COLMAP matches
  int seed = 1;
};

// COLMAP's settings in the fast way. Its own defaults stand beside them.
struct FastColmapFlags {
  int first_octave = 0;     // -1: the photo is doubled in size first, which takes most of the time and gives the smallest features
  int max_features = 4096;  // 8192; prepare.max_features holds when it is smaller
  // Smooth photos (fields, snow) give few features so; with fewer than this, a photo is searched once more by COLMAP's own settings.
  int few_features = 4096;
  // Global bundle adjustments end when they change the cost by less than this share (0: never), happen when photos or points have grown by these
  // ratios (1.1), and are repeated so many times after outliers are removed (5).
  double ba_global_function_tolerance = 1e-6;
  double ba_global_images_ratio = 1.3;
  double ba_global_points_ratio = 1.3;
  int ba_global_max_refinements = 2;
};

// Which photos are matched in the fast way.
struct PairRules {
  size_t all_below = 30;          // with fewer photos: every pair
  size_t neighbors = 14;          // nearest photos by what they look at
  size_t sectors = 8;             // of azimuth; the nearest photo in each comes first
  double sector_reach = 2.5;      // a sector's nearest counts up to so many times the distance of the last of the nearest photos
  size_t position_neighbors = 4;  // nearest by position of the camera, where gimbal angles move what is looked at: the tags may be wrong
  size_t similar = 24;            // most similar photos, for photos without a usable position
  size_t name_neighbors = 2;      // photos before and after in name order, for the same
  size_t shot_neighbors = 6;      // nearest shots of rigs, all of whose photos that look the same way are matched
  size_t links = 4;               // pairs that connect groups which have none in common
};

// After the fast way has found too few poses.
constexpr PairRules kMorePairs{
    .all_below = 60, .neighbors = 24, .position_neighbors = 8, .similar = 48, .name_neighbors = 4, .shot_neighbors = 10, .links = 8};

// The fast way's result is accepted when it has at least this share of the photos.
constexpr double kEnoughRegistered = 0.9;

}  // namespace skyquilt::prepare::poses
