#include "bench/numerics/hamlet_flight.h"

namespace skyquilt::bench {

coordinator::Settings HamletSettings(const HamletTraining& training, const NumericsOptions& options) {
  coordinator::Settings settings;
  settings.run.seed = training.seed;
  settings.run.threads = options.threads;
  settings.simulate.place = "hamlet";
  settings.simulate.samples_per_pixel = 1;
  settings.simulate.soft_shadows = false;
  settings.prepare.holdout = "every:4";
  settings.partition.blocks = "1x1";
  settings.context.steps = training.context_steps;
  settings.train.steps = training.train_steps;
  settings.context.batch_samples = settings.train.batch_samples = 8192;
  // The learning rate decays, so that results depend less on the seed.
  settings.context.final_learning_rate_share = settings.train.final_learning_rate_share = 0.02;
  return settings;
}

}  // namespace skyquilt::bench
