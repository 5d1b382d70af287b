// Options of section [prepare] of the configuration: how photos become a survey. Fields() describes each one.
#pragma once

#include <string>
#include <vector>

#include "core/config/options.h"
#include "prepare/control/reading/read_control.h"
#include "prepare/georeference/place_options.h"
#include "prepare/poses/pose_options.h"
#include "prepare/rigs/cut_panoramas.h"
#include "prepare/video/video_frames.h"

namespace skyquilt::prepare {

struct PrepareOptions {
  std::string holdout = "every:8";
  std::string holdout_poses = "given";
  double ransac_threshold_m = 10.0;
  std::string poses = "fast";
  bool seed_poses = true;
  std::string camera_model = "OPENCV";
  std::string colmap = "colmap";
  int max_image_size = 1600;
  int max_features = 8192;
  bool use_gpu = false;
  std::string photos;
  double video_overlap = 0.75;
  int video_limit = 500;
  int video_size = 0;
  double video_clock_offset_s = 0.0;
  std::string panoramas = "auto";
  int panorama_views = 4;
  std::vector<double> panorama_pitches = {0.0, -35.0, 35.0};
  double panorama_fov_deg = 90.0;
  int panorama_width = 0;
  double nadir_mask_deg = 0.0;
  std::string rig;
  std::string bands;
  std::string masks;
  std::string alpha = "mask";
  std::string geo_file;
  std::string gcp;
  std::string gcp_marks;
  std::string gcp_crs;
  std::string gcp_columns;
  std::string gcp_heights = "crs";
  std::string check_points;
  double flight_gap_s = 900.0;
  std::string flight_offsets = "auto";
  std::string tag_lag = "auto";
  std::string up;
  std::string scale_bars;
  bool require_georeference = false;
  int keep_points = 10;
  int seed = 1;

  static std::vector<config::Field<PrepareOptions>> Fields();
  // Throws base::UsageError that names the option, its value and what is allowed.
  void Check() const;
};

// The parts that the search for poses, the reading of control points, the geo-reference, the choice of frames and the cutting of panoramas need.
poses::PoseOptions PoseOptionsOf(const PrepareOptions& options);
control::ControlFiles ControlFilesOf(const PrepareOptions& options);
georeference::PlaceOptions PlaceOptionsOf(const PrepareOptions& options);
video::VideoOptions VideoOptionsOf(const PrepareOptions& options);
rigs::PanoramaOptions PanoramaOptionsOf(const PrepareOptions& options);

}  // namespace skyquilt::prepare
