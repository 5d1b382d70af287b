// Scores of products/orthophoto.tif.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/image/image.h"
#include "evaluate/measured.h"

namespace skyquilt::evaluate::ortho {

// NaN and -1: not measured. Figures against the true map only for simulated surveys that have one.
struct OrthoScores {
  double cell_m = kNotMeasured;
  int64_t cells = 0;                   // with data
  double share_photos = kNotMeasured;  // of the cells: colours from photos
  double share_field = kNotMeasured;   // of the cells: colours from the field
  int64_t photos_in_use = -1;          // that gave a cell its colours
  // Where the map lies relative to the true one, metres east and north; the error of the geo-reference. All scores are of the map moved back by it.
  double shift_east_m = kNotMeasured;
  double shift_north_m = kNotMeasured;
  double psnr_db = kNotMeasured;             // cells between the outermost training cameras where both maps have data
  double ssim = kNotMeasured;                //
  double light_error_stops = kNotMeasured;   // of the map's light over squares of some metres: spread about its median (compare_maps.h)
  int64_t cells_compared = 0;                // there
  int64_t edge_targets = 0;                  // on which the sharpness of the map was measured
  double mtf50_per_cell = kNotMeasured;      // cycles per cell, median over them (slanted_edge.h)
  double mtf50_per_m = kNotMeasured;         // cycles per metre
  double photo_mtf50_per_px = kNotMeasured;  // the same of the photo that looks down on each target most nearly from above
  double photo_mtf50_per_m = kNotMeasured;
  double seam_levels = kNotMeasured;        // mean over pairs of photos of the step of map minus truth across their borders, of 255
  double seam_levels_worst = kNotMeasured;  // largest of them
  int64_t seams = -1;                       // pairs of photos
  int64_t moving_car_cells = -1;            // under a moving car, or its shadow, of a photo in use
  double moving_car_share = kNotMeasured;   // of them: differ from the truth by more than 20 of 255 in any colour
};

// A part of the map beside the same part of the truth, cell by cell.
struct OrthoCrop {
  image::Image8 map, truth;
  std::string what;  // "Where they differ most"
  double psnr_db = kNotMeasured;
};

struct OrthoResult {
  OrthoScores scores;
  std::vector<OrthoCrop> crops;  // none without truth
};

}  // namespace skyquilt::evaluate::ortho
