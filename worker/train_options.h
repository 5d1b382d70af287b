// Options of training, [train] and [context] in the configuration.
#pragma once

#include <string>

#include "core/config/options.h"

namespace skyquilt::worker {

struct TrainOptions {
  int steps = 0;                    // > 0: exactly this many; 0: as many as the time budget allows
  double seconds = 0.0;             // time budget of this field; 0 with steps = 0: the default number of steps
  int batch_samples = 1 << 16;
  int levels = 8;
  int features = 4;
  int base_resolution = 16;
  int hidden = 64;
  int color_hidden_layers = 1;
  double learning_rate = 1e-2;
  double checkpoint_every_s = 60.0;
  std::string coupling = "guided";  // "guided" or "independent"
  bool exif_gain = true;

  void Visit(config::OptionVisitor& v);
};

}  // namespace skyquilt::worker
