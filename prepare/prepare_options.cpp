#include "prepare/prepare_options.h"

#include "core/base/errors.h"
#include "prepare/georeference/scale_bars.h"
#include "prepare/georeference/stated_up.h"
#include "prepare/holdout.h"
#include "prepare/input/band_choice.h"
#include "prepare/input/glob.h"

namespace skyquilt::prepare {

std::vector<config::Field<PrepareOptions>> PrepareOptions::Fields() {
  using config::Range;
  using O = PrepareOptions;
  return {
      {"holdout", &O::holdout, Range(), "photos kept for testing, in name order: every:N, every:N:offset, list:FILE (one name per line) or none"},
      {"holdout_poses", &O::holdout_poses, Range::OneOf({"given", "resected"}),
       "poses of held-out photos. given: found together with all others; resected: these photos are removed before the final adjustment and placed "
       "afterwards by the points that remain, so that they help no other pose, lens or point (needs a model with observations)"},
      {"ransac_threshold_m", &O::ransac_threshold_m, Range{1e-3, 1e6},
       "largest distance in metres between fitted and tagged camera position; tags farther off are not used"},
      {"poses", &O::poses, Range::OneOf({"fast", "colmap"}),
       "fast: own choice and matching of pairs, fewer features, shorter adjustments, and COLMAP's settings where that is not enough; colmap: COLMAP "
       "alone, with its own settings"},
      {"seed_poses", &O::seed_poses, Range(),
       "with poses = fast: place photos by GPS, gimbal angles and matches where the result agrees with the matches, and by COLMAP's mapper "
       "otherwise; "
       "false: always by the mapper"},
      {"camera_model", &O::camera_model,
       Range::OneOf({"SIMPLE_PINHOLE", "PINHOLE", "SIMPLE_RADIAL", "RADIAL", "OPENCV", "FULL_OPENCV", "OPENCV_FISHEYE", "FOV",
                     "SIMPLE_RADIAL_FISHEYE", "RADIAL_FISHEYE", "THIN_PRISM_FISHEYE"}),
       "camera model for COLMAP; not used when a model is given"},
      {"colmap", &O::colmap, Range(), "the COLMAP program: a name to find on the PATH, or a path"},
      {"max_image_size", &O::max_image_size, Range::AtLeast(100), "COLMAP scales photos down to this longer side, in pixels, to find features"},
      {"max_features", &O::max_features, Range::AtLeast(100),
       "most features per photo; with poses = fast, 4096 for photos that have so many without being doubled in size"},
      {"use_gpu", &O::use_gpu, Range(), "let COLMAP use a GPU for features, and for its own matching (needs a COLMAP built for it)"},
      {"bands", &O::bands, Range(),
       "bands of TIFF photos for red, green and blue, or one for grey pictures, by numbers from 1 or by names, separated by commas, for instance "
       "3,2,1; empty: those named red, green and blue, or the first three of RGB photos"},
      {"photos", &O::photos, Range(),
       "which pictures are photos: patterns of their paths below the photo folder, separated by commas, such as *.JPG or flight1/**; empty: all but "
       "bands, pictures of heat, thumbnails and others that survey/input.csv lists with a reason"},
      {"video_overlap", &O::video_overlap, Range{0, 0.95}, "share of a frame of a video that the next frame that is taken shows too"},
      {"video_limit", &O::video_limit, Range::AtLeast(3).Or(0), "most frames that are taken of all videos together; 0: as many as the overlap needs"},
      {"video_size", &O::video_size, Range{100, 65535}.Or(0), "longer side in pixels of frames of larger videos; 0: that of the video"},
      {"video_clock_offset_s", &O::video_clock_offset_s, Range{-1e6, 1e6},
       "seconds that the clock of the videos is behind that of GPX and CSV files beside them"},
      {"panoramas", &O::panoramas, Range::OneOf({"auto", "all", "none"}),
       "which photos are panoramas of all directions (equirectangular), cut into views; auto: those whose GPano tags say so; all: and those twice as "
       "wide as high; none"},
      {"panorama_views", &O::panorama_views, Range{1, 36}, "views of a panorama around, in each ring"},
      {"panorama_pitches", &O::panorama_pitches, Range{-90, 90},
       "pitches of the rings in degrees, up from the horizon; -90 and 90 are one view each. 4 views with -90, 0 and 90 are the faces of a cube"},
      {"panorama_fov_deg", &O::panorama_fov_deg, Range{20, 140}, "angle of view of these square views in degrees"},
      {"panorama_width", &O::panorama_width, Range{64, 16384}.Or(0), "their width in pixels; 0: as sharp as the panorama"},
      {"nadir_mask_deg", &O::nadir_mask_deg, Range{0, 90},
       "half the angle in degrees of the cone straight down that is masked in panoramas, as it shows the tripod, the drone or who holds the camera; "
       "0: "
       "none"},
      {"rig", &O::rig, Range(),
       "COLMAP's rig_config.json of several cameras that take photos at once; empty: the one in or beside the photo folder, if there is one; none: "
       "every photo by itself"},
      {"masks", &O::masks, Range(),
       "folder of masks named PHOTO.jpg.png, or one mask for all photos; 0 = ignore; empty: those in and beside the photo folder by their names, and "
       "the photos' alpha; none: no masks"},
      {"alpha", &O::alpha, Range::OneOf({"mask", "white", "black"}),
       "what transparency in photos (PNG, TIFF) means. mask: transparent pixels are ignored; white, black: the photos are shown over white or black, "
       "as "
       "published results on synthetic scenes are"},
      {"geo_file", &O::geo_file, Range(),
       "OpenDroneMap's table of photo positions in any coordinate system; empty: geo.txt in the photo folder, or beside it when that is called "
       "images"},
      {"gcp", &O::gcp, Range(),
       "file of ground control points, of any of the formats of OpenDroneMap, OpenSfM, Pix4D and Metashape; empty: the place comes from GPS tags"},
      {"gcp_marks", &O::gcp_marks, Range(), "file of the control points' marks on photos, where the file of the points has none"},
      {"gcp_crs", &O::gcp_crs, Range(),
       "coordinate system of the control points, for instance EPSG:32632; empty: as the file says (tables that do not say need it)"},
      {"gcp_columns", &O::gcp_columns, Range(),
       "columns of a table of control points in their order, for instance label,east,north,up; empty: by its header"},
      {"gcp_heights", &O::gcp_heights, Range::OneOf({"crs", "ellipsoid", "egm96"}),
       "what the control points' heights are above; crs: as their coordinate system says, the ellipsoid where it does not"},
      {"check_points", &O::check_points, Range(),
       "points of the control file that are only compared with the result: labels separated by commas, or a file with a label per line"},
      {"flight_gap_s", &O::flight_gap_s, Range{1e-3, 1e9}, "a longer pause between photos, in seconds, starts a new flight"},
      {"flight_offsets", &O::flight_offsets, Range::OneOf({"auto", "off"}),
       "auto: tagged heights get an offset and a drift in time per flight where they need it; off: never"},
      {"tag_lag", &O::tag_lag, Range::OneOf({"auto", "off"}), "auto: estimate by how much time the GPS tags lag behind the photos; off: no lag"},
      {"up", &O::up, Range(),
       "direction of up, where photos, tags and points cannot tell it: x,y,z in the frame of the camera model, or cameras for the mean up of the "
       "photos; empty: found"},
      {"scale_bars", &O::scale_bars, Range(),
       "lengths measured on site: A,B,LENGTH in metres, several separated by |. A and B are labels of marks in photos (prepare.gcp, or "
       "prepare.gcp_marks "
       "alone), or points x;y;z of the camera model. They give a survey without a place on Earth its scale, and are compared with one that has it"},
      {"require_georeference", &O::require_georeference, Range(),
       "stop with status 3 when the place on Earth is uncertain, instead of going on with a warning"},
      {"keep_points", &O::keep_points, Range{2, 1e6}.Or(0),
       "one sparse point in so many, by a hash of its id, is kept from training, to measure depth errors with; 0: none"},
      {"seed", &O::seed, Range::AtLeast(0), "random seed of COLMAP and of the fit to GPS"},
  };
}

void PrepareOptions::Check() const {
  config::CheckRanges("prepare", *this);
  ParseHoldout(holdout);
  if (!photos.empty()) input::ParsePatterns(photos);
  input::CheckBandsOption(bands);
  georeference::CheckUpOption(up);
  georeference::ParseScaleBars(scale_bars);
  if (panorama_pitches.empty()) throw base::UsageError("prepare.panorama_pitches is empty: give one or more pitches, for instance 0,-35,35");
  if (colmap.empty()) throw base::UsageError("prepare.colmap is empty: set it to the name or path of the COLMAP program, for instance colmap");
}

poses::PoseOptions PoseOptionsOf(const PrepareOptions& options) {
  return {.fast = options.poses == "fast",
          .seed_poses = options.seed_poses,
          .colmap = options.colmap,
          .camera_model = options.camera_model,
          .max_image_size = options.max_image_size,
          .max_features = options.max_features,
          .use_gpu = options.use_gpu,
          .seed = options.seed};
}

control::ControlFiles ControlFilesOf(const PrepareOptions& options) {
  return {.points = options.gcp,
          .marks = options.gcp_marks,
          .crs = options.gcp_crs,
          .columns = options.gcp_columns,
          .heights = options.gcp_heights,
          .check_points = options.check_points};
}

georeference::PlaceOptions PlaceOptionsOf(const PrepareOptions& options) {
  return {.ransac_threshold_m = options.ransac_threshold_m,
          .flight_gap_s = options.flight_gap_s,
          .flight_offsets = options.flight_offsets,
          .tag_lag = options.tag_lag,
          .seed = options.seed};
}

video::VideoOptions VideoOptionsOf(const PrepareOptions& options) {
  return {.overlap = options.video_overlap, .limit = options.video_limit, .size = options.video_size, .clock_offset_s = options.video_clock_offset_s};
}

rigs::PanoramaOptions PanoramaOptionsOf(const PrepareOptions& options) {
  return {.which = options.panoramas,
          .per_ring = options.panorama_views,
          .pitches_deg = options.panorama_pitches,
          .fov_deg = options.panorama_fov_deg,
          .width = options.panorama_width,
          .nadir_mask_deg = options.nadir_mask_deg};
}

}  // namespace skyquilt::prepare
