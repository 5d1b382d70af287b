// Scores the merged scene on the held-out photos and writes report/metrics.json, report/brightness.json and report/index.html.
#pragma once

#include <filesystem>
#include <string>

#include "core/base/thread_pool.h"
#include "core/config/options.h"
#include "core/image/pixel_cache.h"
#include "core/scene/scene.h"
#include "core/survey/survey.h"
#include "evaluate/metrics.h"
#include "partition/block.h"

namespace skyquilt::evaluate {

struct EvaluateOptions {
  int image_width = 0;           // pixels; 0: the training width
  std::string lpips_network;     // ONNX file; empty: LPIPS is not measured
  int max_photos = 0;            // score at most so many held-out photos, evenly spread; 0: all
  bool exif_gain = true;         // render each photo at its EXIF exposure
  bool predicted_gain = true;    // and with the residual gain predicted for it
  std::string normal_photos;     // folder of the same photos at normal exposure; empty: none
  double normal_stops = 0.0;     // -10..10, by which what is shown is raised before that comparison
  int report_photos = 40;        // photos with pictures in the report, evenly spread
  int report_image_width = 960;  // pixels

  void Visit(config::OptionVisitor& v);
};

struct EvaluateInput {
  const scene::Scene* scene = nullptr;
  const survey::Survey* survey = nullptr;
  const partition::BlockSet* blocks = nullptr;
  const image::PixelCache* pixels = nullptr;  // entry i belongs to survey->photos[i]
  std::filesystem::path project_folder;       // report/ is written here; checkpoints/ and products/ are read
  std::filesystem::path train_json;           // empty: train.json of the project
  int ranks = 0;                              // 0: as train.json says, else 1
  std::string config_text;                    // TOML; empty: what the scene was trained with
  EvaluateOptions options;
};

// Renders every held-out photo and compares. Deterministic for any number of threads.
// Throws base::UsageError for options out of range, base::InputError for files that cannot be read or written, base::Interrupted.
Metrics Evaluate(const EvaluateInput& input, base::ThreadPool& threads);

}  // namespace skyquilt::evaluate
