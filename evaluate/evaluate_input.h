// Input of an evaluation. The pointers must outlive it; all but `trust`, `training` and `times` must be set.
#pragma once

#include <filesystem>
#include <string>

#include "core/image/pixel_cache.h"
#include "core/scene/scene.h"
#include "core/scene/train_report.h"
#include "core/survey/survey.h"
#include "core/trust/trust.h"
#include "evaluate/evaluate_options.h"
#include "evaluate/metrics/run_times.h"
#include "partition/block.h"

namespace skyquilt::evaluate {

struct EvaluateInput {
  const scene::Scene* scene = nullptr;
  const survey::Survey* survey = nullptr;
  const partition::BlockSet* blocks = nullptr;
  const image::PixelCache* pixels = nullptr;          // entry i belongs to survey->photos[i]
  std::filesystem::path project_folder;               // report/ is written here; checkpoints/ and products/ are read
  const skyquilt::trust::Trust* trust = nullptr;      // of the scene; null: not measured
  const scene::TrainReport* training = nullptr;       // null: unknown, then the report says nothing about training
  std::string config_text;                            // TOML; empty: the configuration stored in the scene
  geo::Vertical vertical = geo::Vertical::kAsTagged;  // of the heights in the project's files, which the report repeats
  EvaluateOptions options;
  // Where the scores so far are saved, for an evaluation of the same key to continue from; its folder must exist. Empty: they are not saved.
  std::filesystem::path progress_file = {};
  std::string progress_key = {};             // names whatever the scores depend on but the list of photos
  const metrics::RunTimes* times = nullptr;  // of a run within a total time, up to this stage; null: of no such run

  std::filesystem::path ReportFolder() const { return project_folder / "report"; }
};

}  // namespace skyquilt::evaluate
