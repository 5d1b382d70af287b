// The life of one field on disk: parameters, moments, occupancy, step, adaptive batch and the configuration hash.
// Random numbers are functions of (seed, step), so the step is all their state.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/brightness/response_learner.h"
#include "core/checkpoint/archive.h"
#include "worker/field_trainer.h"
#include "worker/surface_band.h"
#include "worker/trainer.h"

namespace skyquilt::worker {

struct SessionRecord {
  double seconds = 0.0;
  int64_t samples = 0;
  int64_t rays = 0;
  int dropped_steps = 0;
  double mean_squared_error = 0.0;  // running mean of training rays
  bool complete = false;
};

// What the context has beside its field.
struct ContextExtras {
  brightness::Response* response = nullptr;
  brightness::ResponseLearner* learner = nullptr;
};

// kind: "context" or "block". extras: the context's, null for blocks. findings: the finished context's, else null. Throws base::InputError.
void SaveSession(const std::string& kind, const TrainJob& job, render::TrainedField& target, FieldTrainer& trainer, const SessionRecord& record,
                 const ContextExtras* extras, const ContextFindings* findings);

// PSNR of recent training rays.
double RunningPsnr(const SessionRecord& record);

// A whole checkpoint of this configuration.
struct SavedSession {
  std::filesystem::path file;
  checkpoint::ArchiveReader reader;
};

// Damaged files fall back to the previous one with a warning; nothing when there is none, or (with a warning) when both are damaged: training
// starts anew then. Throws base::UsageError when the file belongs to another configuration.
std::optional<SavedSession> OpenSession(const std::string& kind, const TrainJob& job);

// What it came to, when it is of a finished field: asked before anything else is loaded, so that a resumed training passes over those quickly.
std::optional<TrainResult> FinishedResult(const SavedSession& session);

// Throws base::InputError when it does not fit the field.
void LoadSession(const SavedSession& session, render::TrainedField& target, FieldTrainer& trainer, SessionRecord* record,
                 const ContextExtras* extras);

// Throws base::InputError when neither the file nor its predecessor can be read.
LoadedContext LoadContext(const std::filesystem::path& checkpoint);

}  // namespace skyquilt::worker
