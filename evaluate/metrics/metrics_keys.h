// Keys of metrics.json and the numbers that they name, for writing and reading.
#pragma once

#include <array>
#include <utility>

#include "evaluate/metrics/metrics.h"

namespace skyquilt::evaluate::metrics {

using KeyedNumber = std::pair<const char*, double Metrics::*>;

// Numbers of the whole evaluation.
inline constexpr std::array<KeyedNumber, 22> kScores = {{{"psnr", &Metrics::psnr},
                                                         {"psnr_1000", &Metrics::psnr_1000},
                                                         {"psnr_posed", &Metrics::psnr_posed},
                                                         {"psnr_resected", &Metrics::psnr_resected},
                                                         {"ssim", &Metrics::ssim},
                                                         {"flip", &Metrics::flip},
                                                         {"coverage", &Metrics::coverage},
                                                         {"psnr_full_frame", &Metrics::psnr_full_frame},
                                                         {"ssim_full_frame", &Metrics::ssim_full_frame},
                                                         {"flip_full_frame", &Metrics::flip_full_frame},
                                                         {"psnr_exif_gain", &Metrics::psnr_exif_gain},
                                                         {"exposure_seam", &Metrics::exposure_seam},
                                                         {"exposure_seam_control", &Metrics::exposure_seam_control},
                                                         {"psnr_normal", &Metrics::psnr_normal},
                                                         {"ssim_normal", &Metrics::ssim_normal},
                                                         {"psnr_right_half", &Metrics::psnr_right_half},
                                                         {"psnr_right_half_fitted", &Metrics::psnr_right_half_fitted},
                                                         {"psnr_tiles", &Metrics::psnr_tiles},
                                                         {"psnr_tiles_gains", &Metrics::psnr_tiles_gains},
                                                         {"psnr_tiles_shading", &Metrics::psnr_tiles_shading},
                                                         {"psnr_normal_fitted", &Metrics::psnr_normal_fitted},
                                                         {"lpips", &Metrics::lpips}}};
inline constexpr std::array<KeyedNumber, 4> kSeams = {{{"seam_psnr_gap_db", &Metrics::seam_psnr_gap_db},
                                                       {"psnr_block_interior", &Metrics::psnr_interior_db},
                                                       {"psnr_block_interior_matched", &Metrics::psnr_matched_interior_db},
                                                       {"psnr_seam", &Metrics::psnr_seam_db}}};
inline constexpr std::array<KeyedNumber, 3> kAgainstTruth = {
    {{"depth_rmse_m", &Metrics::depth_rmse_m}, {"depth_median_abs_m", &Metrics::depth_median_abs_m}, {"floater_opacity", &Metrics::floater_opacity}}};
inline constexpr std::array<KeyedNumber, 2> kTraining = {
    {{"train_seconds", &Metrics::train_seconds}, {"samples_per_second", &Metrics::samples_per_second}}};
inline constexpr std::array<KeyedNumber, 3> kHeights = {
    {{"median_agl_m", &Metrics::median_agl_m}, {"median_relative_altitude_m", &Metrics::median_relative_altitude_m}, {"gsd_m", &Metrics::gsd_m}}};

inline constexpr std::array<std::pair<const char*, double photos::KeptPointErrors::*>, 7> kKeptPoints = {
    {{"median_m", &photos::KeptPointErrors::median_m},
     {"median_abs_m", &photos::KeptPointErrors::median_abs_m},
     {"nmad_m", &photos::KeptPointErrors::nmad_m},
     {"median_gsd", &photos::KeptPointErrors::median_gsd},
     {"median_abs_gsd", &photos::KeptPointErrors::median_abs_gsd},
     {"nmad_gsd", &photos::KeptPointErrors::nmad_gsd},
     {"share_beyond_10_gsd", &photos::KeptPointErrors::share_beyond_10_gsd}}};

// Keys of the fit to GPS here and in survey.json.
inline constexpr std::array<std::pair<const char*, const char*>, 13> kFitKeys = {{{"photos_with_gps", "n_matches"},
                                                                                  {"inliers", "n_inliers"},
                                                                                  {"rmse_m", "rmse_m"},
                                                                                  {"rmse_horizontal_m", "rmse_horizontal_m"},
                                                                                  {"rmse_vertical_m", "rmse_vertical_m"},
                                                                                  {"scale_m_per_model_unit", "scale"},
                                                                                  {"tag_lag_s", "tag_lag_s"},
                                                                                  {"tag_lag_sigma_s", "tag_lag_sigma_s"},
                                                                                  {"flight_vertical_offset_m", "flight_vertical_offset_m"},
                                                                                  {"flight_vertical_drift_m", "flight_vertical_drift_m"},
                                                                                  {"accuracy", "accuracy"},
                                                                                  {"gravity", "gravity"},
                                                                                  {"tags_alone_tilt_deg", "tags_alone_tilt_deg"}}};

}  // namespace skyquilt::evaluate::metrics
