// What an evaluation works on.
#pragma once

#include <filesystem>
#include <string>

#include "core/image/pixel_cache.h"
#include "core/scene/scene.h"
#include "core/scene/train_report.h"
#include "core/survey/survey.h"
#include "evaluate/evaluate_options.h"
#include "partition/block.h"

namespace skyquilt::evaluate {

struct EvaluateInput {
  const scene::Scene* scene = nullptr;
  const survey::Survey* survey = nullptr;
  const partition::BlockSet* blocks = nullptr;
  const image::PixelCache* pixels = nullptr;     // entry i belongs to survey->photos[i]
  std::filesystem::path project_folder;          // report/ is written here; checkpoints/ and products/ are read
  const scene::TrainReport* training = nullptr;  // null: nothing is known of it
  std::string config_text;                       // TOML; empty: what the scene was trained with
  EvaluateOptions options;

  std::filesystem::path ReportFolder() const { return project_folder / "report"; }
};

}  // namespace skyquilt::evaluate
