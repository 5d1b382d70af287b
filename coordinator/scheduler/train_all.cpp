#include "coordinator/scheduler/train_all.h"

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <optional>

#include "coordinator/ranks/rank_group.h"
#include "coordinator/ranks/rank_messages.h"
#include "coordinator/ranks/shared_folder.h"
#include "coordinator/scheduler/block_queue.h"
#include "coordinator/scheduler/context_preview.h"
#include "coordinator/scheduler/coordinate.h"
#include "coordinator/scheduler/field_context.h"
#include "coordinator/scheduler/plan_brightness.h"
#include "coordinator/scheduler/reject_pixels.h"
#include "coordinator/scheduler/train_ledger.h"
#include "coordinator/scheduler/train_progress.h"
#include "core/base/amounts.h"
#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/json_text.h"
#include "core/base/log.h"
#include "core/base/progress.h"
#include "core/survey/refined_poses.h"
#include "worker/block_session.h"

namespace skyquilt::coordinator {
namespace {

using nlohmann::json;

constexpr int kMaxTries = 3;
// Of a time budget for all of the stage.
constexpr double kMostSetupShare = 0.25, kPreviewShare = 0.02;

void RequireMemory(const partition::BlockSet& blocks, const survey::Survey& survey, const Settings& settings, int threads, int per_host) {
  const double limit = settings.run.MemoryLimitBytes(), of_survey = SurveyBytes(survey);
  for (const partition::Block& block : blocks.blocks) {
    if (block.empty) continue;
    const double bytes = ExpectedTrainingBytes(block, settings.train, threads) + of_survey;
    if (bytes * per_host > limit) {
      throw base::UsageError(
          "block " + block.name + " needs about " + base::FormatCount(bytes) + "B of memory to train, " + base::FormatCount(of_survey) +
          "B of it for photos and points of the survey, but the limit for " + std::to_string(per_host) + " rank(s) on one machine is " +
          base::FormatCount(limit) +
          "B (run.memory_gb). Raise --memory, use fewer ranks per machine, more and smaller blocks, or a smaller partition.max_log2_table_size");
    }
  }
}

class Training {
 public:
  Training(comm::Communicator& comm, const TrainInput& input, const Settings& settings, const Project& project)
      : comm_(comm), input_(input), settings_(settings), project_(project), ledger_(project, input.config_hash), spent_before_s_(ledger_.spent_s()) {}

  scene::TrainReport Run() {
    std::filesystem::create_directories(project_.CheckpointFolder());
    std::filesystem::create_directories(project_.PixelCacheFile().parent_path());
    const int all_threads = settings_.run.UsableThreads();
    base::ThreadPool pool(all_threads);
    image::PixelCache pixels = image::PixelCache::Open(project_.PixelCacheFile(), PixelSources(*input_.survey), settings_.run.image_width, pool);
    pixels.Stream(MustStream(pixels, *input_.survey, *input_.blocks, settings_, all_threads, comm_.local_size()));
    if (pixels.streaming()) {
      base::LogInfo("pixels of the photos ({}B) are read from disk on demand: with a block they exceed the memory limit of {}B (--memory)",
                    base::FormatCount(static_cast<double>(pixels.FileBytes())), base::FormatCount(settings_.run.MemoryLimitBytes()));
    }
    // Decoding is not training: the budget starts here, unless it is for all of the stage.
    if (!settings_.run.budget_has_everything) start_ = std::chrono::steady_clock::now();
    std::optional<SharedFolder> shared;
    if (comm_.size() > 1) shared.emplace(project_.CheckpointFolder());
    const json setup = {{"project", project_.folder.string()},
                        {"shared", shared ? shared->Proof() : json()},
                        {"pixels", pixels.identity()},
                        {"settings", Settings(settings_).Toml()},
                        {"config_hash", input_.config_hash},
                        {"verbose", input_.verbose},
                        {"quiet", input_.quiet}};
    RankGroup group(comm_, kTagSetup, base::JsonText(setup));
    const std::optional<brightness::Response> earlier = EarlierResponse(project_);
    const BrightnessPlan plan = PlanBrightness(*input_.survey, settings_.brightness, earlier ? &*earlier : nullptr);
    if (!plan.remark.empty()) base::LogInfo("{}", plan.remark);
    const FieldTrainer trainer = MakeFieldTrainer(*input_.survey, *input_.blocks, pixels, settings_, project_, input_.config_hash, pool);
    int per_host = 1;
    int threads = all_threads;
    if (comm_.size() > 1) {
      threads = AssignThreads(group.WaitForRanks(), &per_host);
    }
    RequireMemory(*input_.blocks, *input_.survey, settings_, threads, per_host);
    TrainContext(trainer, all_threads);
    ProvideRefinedPoses();
    ProvideRejectedPixels(Trained(), *input_.blocks, pixels, settings_, project_, input_.config_hash, pool);
    ShowContext(pool);
    TrainBlocks(trainer, threads);
    ledger_.SetSpent(Now(), true);
    scene::TrainReport report = ledger_.Report(comm_.size(), threads);
    scene::WriteTrainReport(report, project_.TrainReport());
    return report;
  }

 private:
  // Seconds of this configuration's training, earlier runs included.
  // Set-up is not training: what ranks spend on it is not taken from the time budget, unless that is for all of the stage.
  void SetAside(double seconds) {
    if (settings_.run.budget_has_everything) return;
    start_ += std::chrono::duration_cast<std::chrono::steady_clock::duration>(std::chrono::duration<double>(seconds));
  }
  // By when the blocks must be trained. The last one still has its own set-up before it, about as long as that of the context.
  double Deadline() const {
    const double budget = settings_.run.time_budget_s;
    return settings_.run.budget_has_everything ? budget - std::min(context_setup_s_, kMostSetupShare * std::max(0.0, budget - Now())) : budget;
  }
  double Now() const { return spent_before_s_ + std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

  // Tells each rank how many threads it has. Returns the smallest number, and in *per_host the largest number of ranks that share a machine.
  int AssignThreads(const std::vector<GroupMember>& members, int* per_host) {
    int fewest = 1 << 20;
    *per_host = 1;
    for (const GroupMember& member : members) {
      comm_.Send(member.rank, kTagThreads, std::to_string(member.threads));
      fewest = std::min(fewest, member.threads);
      *per_host = std::max(*per_host, member.ranks_on_host);
    }
    return fewest;
  }

  void TrainContext(const FieldTrainer& trainer, int threads) {
    QueueOptions options;
    options.steps = ContextSteps(settings_);
    options.seconds = settings_.run.time_budget_s > 0.0 ? settings_.run.time_budget_s * settings_.run.context_share : settings_.context.seconds;
    if (settings_.run.time_budget_s > 0.0) options.steps = settings_.context.steps;
    options.seed = static_cast<uint64_t>(settings_.run.seed);
    options.max_tries = kMaxTries;
    BlockQueue queue({{-1, "context", 1.0, 0.0}}, options);
    TrainProgress progress("context", 1.0, 1);
    while (queue.HasWaiting()) {
      base::ThrowIfCancelled();
      const FieldJob job = queue.TakeNext(Now(), {});
      const auto report = [&](const worker::TrainStatus& status) {
        progress.Update(job, 1.0, status);
        ledger_.SetSpent(Now(), false);
      };
      const FieldOutcome outcome = RunField(trainer, job, report, 0, threads);
      RethrowIfFatal(outcome);
      SetAside(outcome.setup_s);
      if (queue.RecordOutcome(outcome)) {
        base::LogWarning("the context failed and is tried again with half the learning rate: {}", outcome.failure.reason);
        progress.FieldRestarted(job);
      }
    }
    progress.FieldDone(queue.outcomes().front().job, 1.0);
    progress.Finish();
    const FieldOutcome& outcome = queue.outcomes().front();
    ledger_.AddOutcome(outcome);
    if (outcome.failure.kind != Failure::kNone)
      throw base::BlockError("the context failed " + std::to_string(kMaxTries) + " times: " + outcome.failure.reason);
    LogField(outcome);
    context_s_ = outcome.result.seconds;
    context_setup_s_ = outcome.setup_s;
  }

  // Those that the context refined are kept beside the survey; of an earlier training there are none any more.
  void ProvideRefinedPoses() {
    survey::RemoveRefinedPoses(project_.SurveyFolder());
    if (!settings_.train.refine_poses) return;
    const std::optional<survey::RefinedPoses> poses = worker::LoadContextPoses(project_.ContextCheckpoint(), *input_.survey);
    if (!poses) return;
    survey::SaveRefinedPoses(*poses, *input_.survey, project_.SurveyFolder());
    refined_ = *input_.survey;
    survey::ApplyRefinedPoses(*poses, *refined_);
    base::LogInfo("{}", poses->Summary());
  }
  // With the poses that the fields are trained with.
  const survey::Survey& Trained() const { return refined_ ? *refined_ : *input_.survey; }

  // The time that this takes is not taken from the blocks' budget, unless that is for all of the stage; then it is a small part of it.
  void ShowContext(base::ThreadPool& pool) {
    const auto begin = std::chrono::steady_clock::now();
    const double most_s = settings_.run.budget_has_everything ? kPreviewShare * settings_.run.time_budget_s : context_s_;
    ProvideContextPreview(Trained(), *input_.blocks, settings_, project_, std::min(context_s_, most_s), pool);
    SetAside(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  }

  bool IsKept(const std::string& name) const {
    return std::any_of(input_.kept.begin(), input_.kept.end(), [&name](const FieldOutcome& outcome) { return outcome.job.name == name; });
  }

  void TrainBlocks(const FieldTrainer& trainer, int threads) {
    for (const FieldOutcome& outcome : input_.kept) ledger_.AddOutcome(outcome);
    std::vector<QueueBlock> waiting;
    for (const partition::Block& block : input_.blocks->blocks) {
      const std::string name = "block_" + block.name;
      if (block.empty) {
        base::LogInfo("{} is empty and skipped: {}", name, block.empty_reason);
      } else if (!IsKept(name)) {
        waiting.push_back({block.id, name, block.cost, ledger_.AssignedSeconds(name)});
      }
    }
    if (comm_.size() - 1 > static_cast<int>(waiting.size())) {
      base::LogInfo("{} ranks train {} blocks: {} of them have no block of their own. Use more and smaller blocks (--blocks) or fewer ranks",
                    comm_.size() - 1, waiting.size(), comm_.size() - 1 - static_cast<int>(waiting.size()));
    }
    QueueOptions options;
    options.steps = settings_.run.time_budget_s > 0.0 ? 0 : settings_.train.steps;
    options.has_deadline = settings_.run.time_budget_s > 0.0;
    options.deadline_s = Deadline();
    options.shortest_s = settings_.run.shortest_block_s;
    options.seconds = settings_.train.seconds;
    options.n_workers = std::max(1, std::min(comm_.size() - 1, static_cast<int>(waiting.size())));
    options.max_tries = kMaxTries;
    options.seed = static_cast<uint64_t>(settings_.run.seed);
    BlockQueue queue(waiting, options);
    TrainProgress progress("blocks", queue.TotalCost(), static_cast<int>(waiting.size()));
    CoordinateHooks hooks;
    hooks.now_s = [this] { return Now(); };
    hooks.handed_out = [&](const FieldJob& job, int rank) {
      if (options.has_deadline) ledger_.AssignSeconds(job.name, job.seconds);
      base::LogDebug("{} is given to {}{}", job.name, comm_.NameOf(rank), job.seconds > 0.0 ? " for " + base::FormatDuration(job.seconds) : "");
    };
    hooks.status = [&](const FieldJob& job, const worker::TrainStatus& status) {
      progress.Update(job, queue.Cost(job.block), status);
      ledger_.SetSpent(Now(), false);
    };
    hooks.finished = [&](const FieldOutcome& outcome, bool retried) {
      SetAside(outcome.setup_s / options.n_workers);
      if (retried) {
        base::LogWarning("{}{} {} and is tried again with half the learning rate", outcome.job.name, On(outcome),
                         outcome.failure ? "failed (" + outcome.failure.reason + ")" : "shows its photos worse than the context");
        progress.FieldRestarted(outcome.job);
        return;
      }
      progress.FieldDone(outcome.job, queue.Cost(outcome.job.block));
      RequireSaved(outcome);
      ledger_.AddOutcome(outcome);
      if (outcome.failure.kind == Failure::kNone) {
        LogField(outcome);
      } else {
        base::LogError("{}{} failed after {} tries: {}", outcome.job.name, On(outcome), outcome.job.attempt + 1, outcome.failure.reason);
      }
    };
    hooks.moved = [this](const FieldJob& job, int from_rank, int to_rank) {
      if (to_rank == from_rank) {
        base::LogInfo("{} stays on {}: no other rank would finish it earlier", job.name, comm_.NameOf(from_rank));
      } else {
        base::LogInfo("{} continues on {}: {} is slow", job.name, comm_.NameOf(to_rank), comm_.NameOf(from_rank));
      }
    };
    try {
      CoordinateBlocks(comm_, queue, trainer, threads, hooks);
    } catch (...) {
      ledger_.SetSpent(Now(), true);
      throw;
    }
    progress.Finish();
  }

  // " on rank 2 on node7"; nothing for this process alone.
  std::string On(const FieldOutcome& outcome) const { return comm_.size() > 1 ? " on " + comm_.NameOf(outcome.rank) : ""; }

  // A block that another machine finished must be on this machine's disk too.
  void RequireSaved(const FieldOutcome& outcome) const {
    if (outcome.saved_bytes < 0) return;
    const std::filesystem::path file = project_.CheckpointFolder() / (outcome.job.name + ".h5");
    const int64_t here = BytesSeen(file);
    if (here == outcome.saved_bytes) return;
    throw base::InputError(file,
                           "was finished by " + comm_.NameOf(outcome.rank) + " and has " + std::to_string(outcome.saved_bytes) +
                               " bytes there, but this machine sees " + (here < 0 ? "no such file" : std::to_string(here) + " bytes"),
                           "Put the project on a disk that all machines share, under the same path on each, and run the same command again");
  }

  void RethrowIfFatal(const FieldOutcome& outcome) {
    if (outcome.failure.kind != Failure::kNone) ledger_.SetSpent(Now(), true);
    ThrowIfEndsCommand(outcome);
  }

  static void LogField(const FieldOutcome& outcome) {
    const worker::TrainResult& r = outcome.result;
    base::LogInfo("{}: {} steps in {}, {} samples, {} parameters, training PSNR {:.2f} dB{}", outcome.job.name, r.steps,
                  base::FormatDuration(r.seconds), base::FormatCount(static_cast<double>(r.samples)),
                  base::FormatCount(static_cast<double>(r.parameters)), r.final_psnr_db,
                  r.dropped_steps > 0 ? ", " + std::to_string(r.dropped_steps) + " steps dropped because of non-finite values" : "");
    if (r.ShowsContext()) {
      base::LogWarning("{}: {:.2f} dB on its training photos, where the context alone has {:.2f} dB: the scene will show the context there",
                       outcome.job.name, r.comparison->block_psnr_db, r.comparison->context_psnr_db);
    }
  }

  comm::Communicator& comm_;
  const TrainInput& input_;
  const Settings& settings_;
  const Project& project_;
  TrainLedger ledger_;
  double spent_before_s_;
  std::optional<survey::Survey> refined_;
  double context_s_ = 0.0;  // training time of the context
  double context_setup_s_ = 0.0;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace

scene::TrainReport TrainAll(comm::Communicator& comm, const TrainInput& input, const Settings& settings, const Project& project) {
  SKYQUILT_CHECK(comm.rank() == 0, "rank 0 coordinates");
  return Training(comm, input, settings, project).Run();
}

void ServeTraining(comm::Communicator& comm, const std::string& setup_text) {
  ServeRankGroup(comm, [&](json& hello) {
    const json setup = base::ParseJson(setup_text);
    base::InitLog(setup.at("verbose").get<bool>(), "rank " + std::to_string(comm.rank()));
    if (setup.at("quiet").get<bool>()) base::SetLogLevel(base::LogLevel::kWarning);
    base::Progress::SetQuiet(true);
    const Project project{setup.at("project").get<std::string>()};
    RequireSharedFolder(setup.at("shared"));
    Settings settings;
    config::ReadTomlText(setup.at("settings").get<std::string>(), "settings from rank 0", settings.AllSections());
    const survey::Survey survey = survey::LoadSurvey(project.SurveyFolder());
    const partition::BlockSet blocks = partition::LoadBlocks(project.BlocksFile());
    image::PixelCache pixels = image::PixelCache::OpenBuilt(project.PixelCacheFile(), setup.at("pixels").get<std::string>());
    pixels.Stream(MustStream(pixels, survey, blocks, settings, settings.run.UsableThreads(), comm.local_size()));
    hello["threads"] = settings.run.UsableThreads();
    const int threads = std::stoi(Register(comm, hello, kTagThreads));
    base::ThreadPool pool(threads);
    ServeBlocks(comm, MakeFieldTrainer(survey, blocks, pixels, settings, project, setup.at("config_hash").get<std::string>(), pool), threads,
                project.CheckpointFolder());
  });
}

}  // namespace skyquilt::coordinator
