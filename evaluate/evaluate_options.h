// Options of section [evaluate] of the configuration: how a scene is scored on the held-out photos.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/config/options.h"

namespace skyquilt::evaluate {

struct EvaluateOptions {
  int image_width = 0;           // pixels; 0: the training width
  std::string lpips_network;     // ONNX file; empty: LPIPS is not measured
  int max_photos = 0;            // most held-out photos to score, evenly spread; 0: all
  bool exif_gain = true;         // render each photo at its EXIF exposure
  bool predicted_gain = true;    // multiplied by the residual gain predicted for it
  std::string normal_photos;     // folder of the same photos at normal exposure; empty: none
  double normal_stops = 0.0;     // -10..10, brightening of the rendering for that comparison
  bool resect = false;           // also score every photo with its pose fitted to the scene (photos/resect_photo.h)
  bool field_normals = false;    // also score normals of the density and of the head; needs true normals
  int report_photos = 40;        // photos shown in the report, evenly spread
  int report_image_width = 960;  // pixels
  double save_every_s = 20.0;    // between savings of the scores so far; does not change the result
  // Not in the configuration: where a study wants the scored pixels of every photo (scored_pixels.h). Empty: they are not written.
  std::filesystem::path scored_pixels_folder = {};

  static std::vector<config::Field<EvaluateOptions>> Fields();
  // Throws base::UsageError for options out of range.
  void Check() const;
  // Throws base::InputError when a file or folder that they name is not there. For the beginning of long work whose last stage reads them.
  void RequireFiles() const;
};

}  // namespace skyquilt::evaluate
