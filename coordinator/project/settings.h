// Every option of the program, one member per section of the configuration file.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "buildings/buildings_options.h"
#include "coordinator/project/run_options.h"
#include "coordinator/project/stamp.h"
#include "core/brightness/brightness_options.h"
#include "core/config/options.h"
#include "core/config/override.h"
#include "core/trust/trust_options.h"
#include "evaluate/evaluate.h"
#include "masks/mask_options.h"
#include "merge/merge_options.h"
#include "partition/partition_options.h"
#include "prepare/prepare_options.h"
#include "products/product_options.h"
#include "simulate/simulate_options.h"
#include "surface/surface_options.h"
#include "tour/export/tour_options.h"
#include "worker/prior_options.h"
#include "worker/robust/robust_options.h"
#include "worker/train_options.h"

namespace skyquilt::coordinator {

struct Settings {
  RunOptions run;
  simulate::SimulateOptions simulate;
  prepare::PrepareOptions prepare;
  masks::MaskOptions masks;
  partition::PartitionOptions partition;
  brightness::BrightnessOptions brightness;
  worker::TrainOptions context;
  worker::TrainOptions train;
  worker::PriorOptions priors;
  worker::RobustOptions robust;
  trust::TrustOptions trust;
  merge::MergeOptions merge;
  products::ProductOptions products;
  surface::SurfaceOptions surface;
  buildings::BuildingsOptions buildings;
  tour::TourOptions tour;
  evaluate::EvaluateOptions evaluate;
  std::set<std::string> named_in_context;  // keys of [context] that a configuration named; the others follow [train], but for the two budgets

  // The result holds references to this object.
  config::Sections AllSections();
  std::string Toml() const;
  FlatOptions Flat() const;
  // Throws base::UsageError as config::ApplyOverride does.
  void Set(const config::Override& entry);
  // Throws base::UsageError for values that are not allowed, alone or in combination.
  void Check() const;
};

}  // namespace skyquilt::coordinator
