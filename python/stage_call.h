// One call of `run` or of a single stage, as the commands of the same names make it, in this process alone. Nothing here knows Python.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "app/settings/chosen_settings.h"

namespace skyquilt::python {

struct StageCall {
  std::string stage;                // "run", or a stage of coordinator::Stages() other than "tour"
  std::filesystem::path folder;     // the project's; of "simulate" the survey's
  std::vector<std::string> photos;  // of "run" and "prepare": folders or videos; empty in "run": a survey is simulated
  std::filesystem::path model;      // of the same; empty: COLMAP is run
  app::Choice choice;               // configuration and options
  bool restart = false;             // remove earlier results of this stage and of later ones first
  bool quiet = false;               // only warnings and errors go to standard error and to the project's log.txt
  bool verbose = false;
  std::function<void(const std::string& label, double share)> progress;  // as base::Progress::SetListener; empty: shown on standard error
};

// Works on the calling thread. One at a time in a process, because log, progress and cancelling are the process's: throws base::UsageError when
// another call is at work, and under an MPI launcher with several ranks. Throws what the stage throws, base::BlockError when blocks failed,
// base::Interrupted after base::RequestCancel: the same call then continues.
void CallStage(const StageCall& call);

}  // namespace skyquilt::python
