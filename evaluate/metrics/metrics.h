// Result of an evaluation, and its JSON form (report/metrics.json).
// NaN means "not measured" and becomes null in JSON; so does an infinite PSNR (identical images).
// PSNR in dB with display values in [0,1] (MAX = 1), higher better; SSIM at most 1, higher better; FLIP from 0 to
// 1 and LPIPS, a distance, lower better.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/scene/scene.h"
#include "core/survey/survey.h"
#include "evaluate/buildings/building_scores.h"
#include "evaluate/metrics/run_times.h"
#include "evaluate/ortho/ortho_scores.h"
#include "evaluate/photos/kept_points.h"
#include "evaluate/photos/photo_score.h"
#include "evaluate/surface/surface_scores.h"
#include "evaluate/trust/sparsification.h"

namespace skyquilt::evaluate::metrics {

struct BlockScore {
  std::string name;
  double psnr_db = kNotMeasured;  // pooled over the covered pixels of all test photos whose surface point is in the block
  int64_t pixels = 0;
};

// Errors of one class of surface in a simulated survey, pooled over the scored pixels of all test photos.
struct ClassScore {
  std::string name;                          // roof, wall, ground (roads included), road, tree
  int64_t pixels = 0;                        // with rendered and true depth
  int64_t missing_pixels = 0;                // without rendered depth
  double depth_bias_m = kNotMeasured;        // median of the errors: rendered minus true depth along the ray
  double depth_median_abs_m = kNotMeasured;  // median size of the errors
  double depth_nmad_m = kNotMeasured;        // 1.4826 times the median distance of the errors from the bias
  double depth_rmse_m = kNotMeasured;        // root mean square of the errors
  double normal_median_deg = kNotMeasured;   // angle between the normals of the rendered depth and the true ones
  double normal_mean_deg = kNotMeasured;
  // The same medians for the normals of the density's gradient and of the normal heads (EvaluateOptions::field_normals).
  double density_normal_median_deg = kNotMeasured;
  double head_normal_median_deg = kNotMeasured;
};

// What a reader must know before believing the figures, each without a full stop at its end.
struct Warning {
  std::string finding;
  std::string advice;  // what to do about it, or that nothing needs to be done

  bool operator==(const Warning&) const = default;
};

struct Metrics {
  // Means over the test photos of the values per photo, as usual in NeRF papers; photos without the value do not count.
  double psnr = kNotMeasured;
  double psnr_1000 = kNotMeasured;      // at a width of photos::kCommonWidth
  double psnr_posed = kNotMeasured;     // on every other tile, with the photos' poses as given; with evaluate.resect
  double psnr_resected = kNotMeasured;  // and as fitted on the tiles between them
  double psnr_exif_gain = kNotMeasured;
  double psnr_normal = kNotMeasured;
  double ssim_normal = kNotMeasured;
  double ssim = kNotMeasured;
  double flip = kNotMeasured;
  double coverage = kNotMeasured;  // pooled: all covered pixels / all used pixels
  double psnr_full_frame = kNotMeasured;
  double ssim_full_frame = kNotMeasured;
  double flip_full_frame = kNotMeasured;
  double psnr_right_half = kNotMeasured;
  double psnr_right_half_fitted = kNotMeasured;
  double psnr_tiles = kNotMeasured;  // PhotoScore::tiles_db and so on
  double psnr_tiles_gains = kNotMeasured;
  double psnr_tiles_shading = kNotMeasured;
  double psnr_normal_fitted = kNotMeasured;
  double lpips = kNotMeasured;
  std::string lpips_note;  // why lpips is null, or which network measured it
  std::vector<photos::PhotoScore> photos;
  std::vector<BlockScore> blocks;
  double psnr_interior_db = kNotMeasured;          // covered pixels deeper than the margin inside a block, pooled
  double psnr_seam_db = kNotMeasured;              // covered pixels where two or more blocks blend, pooled
  double psnr_matched_interior_db = kNotMeasured;  // interior, weighted to have the textures of the seams
  double seam_psnr_gap_db = kNotMeasured;          // matched interior minus seam; NaN with a single block
  double exposure_seam = kNotMeasured;             // brightness change at borders of photo footprints, display values (exposure_seams.h)
  double exposure_seam_control = kNotMeasured;
  double depth_rmse_m = kNotMeasured;  // pooled over the pixels of all test photos
  double depth_median_abs_m = kNotMeasured;
  double floater_opacity = kNotMeasured;                   // of the free space in front of the true surface, mean over rays (floater_opacity.h)
  std::vector<std::pair<double, double>> floater_profile;  // pairs (metres in front of the true surface, opacity up to there)
  std::vector<ClassScore> classes;                         // empty without true classes
  int flat_roofs = 0;                                      // that were measured
  double flat_roof_rms_m = kNotMeasured;                   // median over them of the rms about the plane that fits best (flat_roofs.h)
  double flat_roof_nmad_m = kNotMeasured;                  // and of the NMAD
  bool has_truth = false;                                  // simulated survey with true depth
  photos::KeptPointErrors kept_points;
  trust::TrustScores trust;                            // no pixels: not measured
  std::optional<surface::SurfaceScores> surface;       // nothing when no surface was made
  std::optional<buildings::BuildingScores> buildings;  // nothing when no buildings were searched
  std::optional<ortho::OrthoScores> ortho;             // nothing when no orthophoto was made
  std::optional<RunTimes> times;                       // of a run within a total time; nothing for other runs

  double train_seconds = kNotMeasured;
  double samples_per_second = kNotMeasured;
  int64_t peak_rss_bytes = 0;
  int64_t evaluate_peak_rss_bytes = 0;
  double evaluate_seconds = 0.0;
  int64_t parameters = 0;
  int ranks = 1;
  int threads = 0;
  std::string config;  // TOML text of the training
  scene::RenderStatistics rendering;

  bool georeferenced = false;
  survey::GeoFit geo_fit;
  survey::ControlFit control;              // no points: without ground control
  std::vector<std::string> problem_codes;  // of all Survey::problems
  double median_agl_m = kNotMeasured;
  double median_relative_altitude_m = kNotMeasured;  // from the XMP tags of the drone
  double gsd_m = kNotMeasured;
  int n_photos = 0;  // registered
  int n_unregistered = 0;
  int n_test = 0;
  bool resected_holdout = false;  // Survey::resected_holdout
  int image_width = 0;            // of the first scored photo, pixels
  std::string machine;
  std::string date;  // UTC
  std::vector<Warning> warnings;

  const BlockScore* FindBlock(const std::string& name) const;  // nullptr when none of that name was scored
};

extern const char* const kCoverageDefinition;
extern const char* const kPsnrDefinition;
extern const char* const kSeamDefinition;
extern const char* const kRightHalfDefinition;

// Text of metrics.json, keys as in the documentation. UTF-8; invalid bytes in file names are replaced.
std::string MetricsJson(const Metrics& metrics);
// Reads metrics.json, except for the statistics of rendering, ground control and times; of single photos only name and PSNR. An infinite PSNR is read
// as not measured. Throws base::InputError when the file cannot be read.
Metrics ReadMetrics(const std::filesystem::path& file);

}  // namespace skyquilt::evaluate::metrics
