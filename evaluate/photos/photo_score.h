// Scores of one held-out photo. PSNR in dB with display values in [0,1] (MAX = 1), higher better; SSIM at most 1, higher better; FLIP from 0 to 1 and
// LPIPS, a distance, lower better. NaN: not measured.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "evaluate/measured.h"

namespace skyquilt::evaluate::photos {

// At which scenes are compared that were trained at different widths, pixels.
constexpr int kCommonWidth = 1000;

struct PhotoScore {
  int photo = -1;  // index into Survey::photos
  std::string name;
  int width = 0;  // scored size, pixels
  int height = 0;
  int64_t used_pixels = 0;                                  // not masked
  int64_t covered_pixels = 0;                               // used and covered (coverage.h)
  double exposure_gain = 1.0;                               // linear light, from the tags
  std::array<double, 3> predicted_stops = {0.0, 0.0, 0.0};  // predicted gain, applied in addition, per colour
  double psnr_db = kNotMeasured;                            // over the covered pixels
  double psnr_1000_db = kNotMeasured;                       // the same, photo and rendering averaged to a width of kCommonWidth; wider ones only
  double expected_psnr_db = kNotMeasured;                   // the same, as trust expects it (core/trust/trust.h)
  double psnr_exif_gain_db = kNotMeasured;                  // over the covered pixels, with exposure_gain alone
  double psnr_normal_db = kNotMeasured;  // at normal brightness against a normally exposed photo (evaluate.normal_photos), covered pixels
  double ssim_normal = kNotMeasured;
  double psnr_normal_fitted_db = kNotMeasured;  // the same on the tiles that are not fitted, with gains per colour fitted on the others
  double ssim = kNotMeasured;
  double flip = kNotMeasured;
  double psnr_posed_db = kNotMeasured;     // over the covered pixels of every other tile, with the photo's pose as given (evaluate.resect),
  double psnr_resected_db = kNotMeasured;  // and with the pose fitted on the tiles between them (resect_photo.h),
  double resected_px = kNotMeasured;       // which moves the picture by this much, pixels
  double psnr_full_db = kNotMeasured;      // over all pixels that are not masked
  double ssim_full = kNotMeasured;
  double flip_full = kNotMeasured;
  double lpips = kNotMeasured;                           // full frame
  double right_half_db = kNotMeasured;                   // PSNR over the covered pixels of the right half,
  double right_half_fitted_db = kNotMeasured;            // and with gains per colour fitted to the left half
  std::array<double, 3> fitted_stops = {0.0, 0.0, 0.0};  // those gains, on top of exposure_gain
  // Over the covered pixels of the tiles that are not fitted (alternate_tiles.h): as rendered, with gains per colour fitted on the other tiles, and
  // with shading fitted there too (tile_fit.h).
  double tiles_db = kNotMeasured;
  double tiles_gains_db = kNotMeasured;
  double tiles_shading_db = kNotMeasured;
  double depth_rmse_m = kNotMeasured;  // simulated surveys only: z-depth error over covered pixels with both depths
  double depth_median_abs_m = kNotMeasured;
  double render_seconds = 0.0;

  // Covered share of the used pixels; NaN when none is used.
  double Coverage() const { return used_pixels > 0 ? static_cast<double>(covered_pixels) / static_cast<double>(used_pixels) : kNotMeasured; }
};

}  // namespace skyquilt::evaluate::photos
