// Saves and loads the complete training state of one field, so that an interrupted training can be resumed with the same bits: parameters, Adam
// moments, occupancy, step, rays per step, what the guard against falls knows, and the hash of the configuration. Random numbers are functions of
// (seed, step), so the step is all of their state.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/brightness/response_learner.h"
#include "core/checkpoint/archive.h"
#include "worker/fall_guard.h"
#include "worker/field_trainer.h"
#include "worker/start/surface_interval.h"
#include "worker/trainer.h"

namespace skyquilt::worker {

// Progress of a training, over all its runs.
struct SessionRecord {
  double rate_factor = 1.0;  // on the learning rate, halved by every fall
  FallGuard::State guard;
  std::vector<Fall> falls;
  bool ended_early = false;  // fell too often, and ended at its best state
  std::optional<ContextComparison> comparison;
  double seconds = 0.0;
  int64_t samples = 0;
  int64_t rays = 0;
  int dropped_steps = 0;            // steps left out because they were not finite
  double mean_squared_error = 0.0;  // running mean over training rays, display values
  bool complete = false;            // the training is finished
};

// State of the context's training that blocks do not have.
struct ContextBrightness {
  brightness::Response* response = nullptr;
  brightness::ResponseLearner* learner = nullptr;
};

// Writes job.checkpoint. kind: "context" or "block". extras: null for blocks. findings: of a finished context, otherwise null. Throws
// base::InputError when the file cannot be written.
void SaveSession(const std::string& kind, const TrainJob& job, render::TrainedField& target, FieldTrainer& trainer, const SessionRecord& record,
                 const ContextBrightness* extras, const ContextResults* findings);

// PSNR of recent training rays, and of any mean squared error.
double RunningPsnr(const SessionRecord& record);
double PsnrOfError(double mean_squared_error);

// An undamaged checkpoint of this configuration.
struct SavedSession {
  std::filesystem::path file;
  checkpoint::ArchiveReader reader;
};

// Opens job.checkpoint, or the previous checkpoint with a warning when it is damaged. Empty when there is none, or (with a warning) when both are
// damaged: training then starts from the beginning. Throws base::UsageError when the file was made with another configuration.
std::optional<SavedSession> OpenSession(const std::string& kind, const TrainJob& job);

// The result of a finished training, otherwise empty. Reads only attributes, so that a resumed run skips finished fields quickly.
std::optional<TrainResult> FinishedResult(const SavedSession& session);

// Returns the attempt that the session belongs to. When it is a later one than the job's, which an interrupted run had begun, the job goes on with
// its attempt, seed and learning rate.
int ContinueAttempt(const SavedSession& session, TrainJob& job);

// Restores the state. Throws base::InputError when the sizes of the arrays do not fit the field.
void LoadSession(const SavedSession& session, render::TrainedField& target, FieldTrainer& trainer, SessionRecord* record,
                 const ContextBrightness* extras);

// The poses that a finished context's training refined; nothing when it did not. survey: as prepared. Throws as LoadContext.
std::optional<survey::RefinedPoses> LoadContextPoses(const std::filesystem::path& checkpoint, const survey::Survey& survey);

// Loads a context for training a block. Of its surface intervals only those of these photos are read (indices, in any order), so that memory does not
// grow with the survey; null: all. Throws base::InputError when neither the checkpoint nor the previous one can be read.
LoadedContext LoadContext(const std::filesystem::path& checkpoint, const std::vector<int>* photos = nullptr);

}  // namespace skyquilt::worker
