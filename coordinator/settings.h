// Every option of the program in one place, read in this order: defaults, the project's config.toml (commands that continue a project),
// --config FILE, --set section.key=value, command-line flags.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "coordinator/merge/merge_options.h"
#include "coordinator/pipeline_stamp.h"
#include "coordinator/prepare/prepare_options.h"
#include "coordinator/products/product_options.h"
#include "coordinator/report/evaluate.h"
#include "coordinator/run_options.h"
#include "coordinator/simulate/simulate_options.h"
#include "core/brightness/options.h"
#include "core/config/options.h"
#include "partition/partition_options.h"
#include "worker/train_options.h"

namespace skyquilt::coordinator {

struct Settings {
  RunOptions run;
  simulate::SimulateOptions simulate;
  PrepareOptions prepare;
  partition::PartitionOptions partition;
  brightness::BrightnessOptions brightness;
  worker::TrainOptions context;
  worker::TrainOptions train;
  MergeOptions merge;
  products::ProductOptions products;
  report::EvaluateOptions evaluate;

  // Holds references to this object.
  config::Sections AllSections();
  std::string Toml();
  FlatOptions Flat();
  // Throws base::UsageError for values that cannot be, alone or together.
  void Validate() const;
};

// An option as typed: "train.steps=4000".
struct Override {
  std::string key;    // "section.key"
  std::string value;  // as in TOML, strings without quotes; lists separated by commas
};
// Throws base::UsageError when the text has no '='.
Override ParseOverride(const std::string& text);
// Throws base::UsageError for an unknown section or key (naming the nearest) and for a value of the wrong type.
void ApplyOverride(Settings& settings, const Override& entry);

// `files` in order; ones that are not there are base::InputError. The result is validated.
Settings LoadSettings(const std::vector<std::filesystem::path>& files, const std::vector<Override>& overrides);

// What a stage's result depends on, for its stamp.
FlatOptions StageOptions(Settings& settings, const std::string& stage);

}  // namespace skyquilt::coordinator
