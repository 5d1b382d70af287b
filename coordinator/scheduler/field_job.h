// The job "train this field" that rank 0 gives to a rank, and its result. Both are sent as small JSON texts.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "coordinator/ranks/failure.h"
#include "worker/trainer.h"

namespace skyquilt::coordinator {

struct FieldJob {
  int block = -1;            // index into BlockSet::blocks; -1: the context
  std::string name;          // "context" or "block_<name>"
  int attempt = 0;           // 0, then one more after each failure
  int steps = 0;             // > 0: exactly this many
  double seconds = 0.0;      // budget when steps = 0; 0: the trainer's default
  double rate_factor = 1.0;  // multiplies the learning rate; halved with each attempt
  uint64_t seed = 1;
};

struct FieldOutcome {
  FieldJob job;
  worker::TrainResult result;
  Failure failure;
  int rank = 0;
  int threads = 1;
  double wall_s = 0.0;
  double setup_s = 0.0;  // of it, what was not training: set-up, and what is measured and saved after the last step
  int64_t peak_rss_bytes = 0;
  int64_t saved_bytes = -1;  // size of the finished field's checkpoint as that machine sees it; -1 when it trained on rank 0
};

// Trains one field and calls the reporter often. Tests replace it with a fake.
using FieldTrainer = std::function<worker::TrainResult(const FieldJob&, const worker::Reporter&)>;

// Runs the trainer. Exceptions become FieldOutcome::failure; never throws. `rank` and `threads` are copied into the outcome.
FieldOutcome RunField(const FieldTrainer& trainer, const FieldJob& job, const worker::Reporter& report, int rank, int threads);

std::string ToText(const FieldJob& job);
std::string ToText(const FieldOutcome& outcome);
std::string ToText(const worker::TrainStatus& status);
// Throw nlohmann::json::exception for text that is not of this form.
FieldJob JobFromText(const std::string& text);
FieldOutcome OutcomeFromText(const std::string& text);
worker::TrainStatus StatusFromText(const std::string& text);

}  // namespace skyquilt::coordinator
