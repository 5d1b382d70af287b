#include "coordinator/stages/timed_run.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "coordinator/planning/measure_rates.h"
#include "coordinator/planning/paying_width.h"
#include "coordinator/planning/plan_text.h"
#include "coordinator/stages/measure_rays.h"
#include "coordinator/stages/stage.h"
#include "core/base/amounts.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/thread_pool.h"
#include "partition/block.h"
#include "prepare/prepare_options.h"
#include "prepare/video/video_frames.h"

namespace skyquilt::coordinator {
namespace {

constexpr double kSaveUsed_s = 5.0;
// Of the training time: blocks with their least time must fit.
constexpr double kLeastBlocksShare = 0.6;
constexpr double kLeastBlock_s = 0.1;

size_t IndexOf(const std::string& name) {
  const std::vector<Stage>& stages = Stages();
  const auto found = std::find_if(stages.begin(), stages.end(), [&name](const Stage& stage) { return stage.name == name; });
  return static_cast<size_t>(found - stages.begin());
}

bool GivesTraining(const Settings& settings) {
  return settings.run.time_budget_s > 0.0 || settings.train.steps > 0 || settings.train.seconds > 0.0;
}

WorkSize SizeOfRanks(const Pipeline& pipeline, WorkSize size) {
  size.threads = pipeline.settings.run.UsableThreads();
  size.ranks = pipeline.comm.size();
  const int here = std::max(1, pipeline.comm.local_size());
  size.machines = (size.ranks + here - 1) / here;
  return size;
}

std::vector<std::string> StagesOfRun() {
  std::vector<std::string> names;
  for (const Stage& stage : Stages()) {
    if (stage.separate_folder == nullptr) names.push_back(stage.name);
  }
  return names;
}

// Their number is needed for the plan. Stage "prepare" finds them finished.
void ProvideFramesOfVideos(Pipeline& pipeline) {
  if (pipeline.videos.empty()) return;
  if (pipeline.restart) {
    RemoveStagesFrom(pipeline.project, "prepare");
    pipeline.restart = false;
  }
  prepare::video::ProvideFrames(pipeline.videos, prepare::VideoOptionsOf(pipeline.settings.prepare), pipeline.project.SurveyFolder());
}

}  // namespace

RunLedger::Clock TimedRun::SystemClock() {
  return [] { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); };
}

TimedRun::TimedRun(Pipeline& pipeline, RunLedger::Clock clock)
    : ledger_(pipeline.project, std::move(clock), kSaveUsed_s),
      within_s_(pipeline.settings.run.within_s),
      training_is_given_(GivesTraining(pipeline.settings)),
      predictor_(SizeOfRanks(pipeline, {}), Rates::Usual(pipeline.settings.run.UsableThreads())) {
  if (pipeline.restart) ledger_.Forget();
  for (const StageRecord& record : ledger_.Stages()) {
    ApplyTo(pipeline, record.changes);
  }
  pipeline.settings.run.budget_has_everything = !training_is_given_;
  if (pipeline.level_settings) pipeline.level_settings->run.budget_has_everything = !training_is_given_;
}

void TimedRun::ApplyTo(Pipeline& pipeline, const std::vector<config::Override>& changes) const {
  for (const config::Override& change : changes) {
    pipeline.settings.Set(change);
    if (pipeline.level_settings) pipeline.level_settings->Set(change);
  }
}

bool TimedRun::IsDecided(const Pipeline& pipeline, const std::string& stage) const {
  if (pipeline.restart) return false;
  return ledger_.Of(stage).decided || LoadStamp(pipeline.project, stage).has_value();
}

bool TimedRun::IsDone(const Pipeline& pipeline, const std::string& stage) const {
  if (pipeline.restart) return false;
  const std::optional<StageStamp> stamp = LoadStamp(pipeline.project, stage);
  return stamp && stamp->state == StageStamp::kDone;
}

std::vector<std::string> TimedRun::Remaining(const Pipeline& pipeline, const std::string& first) const {
  std::vector<std::string> names = StagesOfRun();
  std::erase_if(names, [&](const std::string& name) { return IndexOf(name) < IndexOf(first) || (name != first && IsDone(pipeline, name)); });
  return names;
}

Plan TimedRun::PlanFrom(const Pipeline& pipeline, const std::string& first) const {
  PlanRequest request{.within_s = within_s_, .used_s = ledger_.UsedSeconds(), .stages = Remaining(pipeline, first), .settings = pipeline.settings};
  if (!training_is_given_) request.settings.run.time_budget_s = 0.0;
  request.seconds = [this](const std::string& stage, const Settings& settings) { return predictor_.Seconds(stage, settings); };
  const StageRecord train = ledger_.Of("train");
  if (training_is_given_) {
    request.fixed_training_s = std::max(1.0, predictor_.Seconds("train", pipeline.settings) - train.took_s);
  } else if (train.begun) {
    request.fixed_training_s = std::max(1.0, pipeline.settings.run.time_budget_s - train.took_s);
  }
  const Room room = RoomFor(pipeline.project.folder, pipeline.settings);
  return PlanWithPayingWidth(predictor_, request.settings, room, [&](const Settings& settings) {
    request.settings = settings;
    request.reductions = ReductionsOf(settings, predictor_.size());
    std::erase_if(request.reductions, [&](const Reduction& one) { return IndexOf(one.stage) < IndexOf(first) || IsDecided(pipeline, one.stage); });
    return MakePlan(request);
  });
}

void TimedRun::CheckRoom(const Pipeline& pipeline) const {
  // Of the least width: a wider one is chosen only where there is room for it.
  RequireRoom(NeedsOf(predictor_.size(), pipeline.settings), RoomFor(pipeline.project.folder, pipeline.settings), pipeline.project.folder);
}

void TimedRun::Start(Pipeline& pipeline, const std::filesystem::path& photos, const std::filesystem::path& model) {
  ledger_.Start();
  TakePhotos(pipeline, photos);
  ProvideFramesOfVideos(pipeline);
  base::ThreadPool threads(pipeline.settings.run.threads);
  predictor_.size() = SizeOfRanks(pipeline, CountPhotos(pipeline.photos, model, pipeline.settings, pipeline.project.folder, threads));
  const bool poses = !IsDone(pipeline, "prepare"), trains = !IsDone(pipeline, "train");
  if (!IsDecided(pipeline, "prepare")) CheckRoom(pipeline);
  if (trains) {
    const RateSource source{
        .photos = pipeline.photos, .model = model, .work_folder = pipeline.project.StateFolder() / "trial", .poses = poses, .photos_to_decode = true};
    predictor_.rates() = MeasureRates(predictor_.size(), pipeline.settings, source, threads);
  }
  LookAtProject(pipeline, "");
  for (const StageRecord& record : ledger_.Stages()) {
    if (record.done) predictor_.Correct(record.stage, record.predicted_s, record.took_s);
  }
  if (!trains) {
    if (const std::optional<scene::TrainReport> training = scene::TryReadTrainReport(pipeline.project.TrainReport())) TakeTrainingSpeed(*training);
  }
  std::vector<std::string> open = StagesOfRun();
  std::erase_if(open, [&](const std::string& name) { return IsDone(pipeline, name); });
  if (open.empty()) return;
  const Plan plan = PlanFrom(pipeline, open.front());
  for (const PlannedStage& stage : plan.stages) ledger_.SetPlanned(stage.name, stage.seconds);
  base::LogInfo("{}", PlanText(plan));
  Settings planned = pipeline.settings;
  planned.run.image_width = plan.image_width;
  base::LogInfo("{}", NeedsText(NeedsOf(predictor_.size(), planned), RoomFor(pipeline.project.folder, pipeline.settings)));
  if (!plan.feasible) base::LogWarning("{} are too short for these photos: the run will take longer", base::FormatDuration(within_s_));
  WritePlan(pipeline);
}

// Replaces guesses by what is known by now. stage: the next one; "": when the run starts.
void TimedRun::LookAtProject(Pipeline& pipeline, const std::string& stage) {
  if (pipeline.restart) return;
  if ((stage.empty() || stage == "partition") && IsDone(pipeline, "prepare"))
    CountSurvey(survey::LoadSurvey(pipeline.project.SurveyFolder()), &predictor_.size());
  if ((stage.empty() || stage == "train") && IsDone(pipeline, "partition")) {
    CountBlocks(partition::LoadBlocks(pipeline.project.BlocksFile()), &predictor_.size());
  }
  const bool renders = stage == "products" || stage == "surface" || stage == "buildings" || stage == "tour" || stage == "evaluate";
  if (!renders || rays_measured_ || !std::filesystem::exists(pipeline.project.SceneFile())) return;
  const double rays = MeasureRays(pipeline);
  rays_measured_ = true;
  if (!(rays > 0.0)) return;
  // As of one machine: the predictor counts the others.
  predictor_.TakeRays(rays / predictor_.size().Speedup());
  base::LogInfo("the scene is rendered with {} rays/s", base::FormatCount(rays));
}

void TimedRun::Decide(Pipeline& pipeline, const std::string& stage) {
  // A run that was ended before it had blocks chooses their width anew.
  const bool has_width = stage != "partition" || pipeline.settings.run.image_width != kAutoWidth;
  if (IsDecided(pipeline, stage) && has_width) return;
  LookAtProject(pipeline, stage);
  const Plan plan = PlanFrom(pipeline, stage);
  std::vector<config::Override> changes;
  std::vector<Reduction> now;
  for (const Reduction& reduction : plan.reductions) {
    // Scoring ends by itself when its time is up, so what was reserved for fewer photos is used by as many as it takes.
    if (IndexOf(reduction.stage) <= IndexOf(stage) && reduction.what != "scores") now.push_back(reduction);
  }
  if (!training_is_given_ && stage == "partition") {
    // Only how many blocks can be trained follows from it.
    ApplyTo(pipeline, {{"run.time_budget_s", fmt::format("{:.3f}", plan.training_s)}});
  }
  if (stage == "partition" && pipeline.settings.run.image_width == kAutoWidth) {
    // No change of an option: the stage's stamp has it from now on.
    ApplyTo(pipeline, {{"run.image_width", std::to_string(plan.image_width)}});
    base::LogInfo("photos are trained at a width of {} pixels at most, for {} of training", plan.image_width, base::FormatDuration(plan.training_s));
  }
  if (!training_is_given_ && stage == "train") {
    changes.push_back({"run.time_budget_s", fmt::format("{:.3f}", plan.training_s)});
    const WorkSize& size = predictor_.size();
    const int workers = std::max(1, std::min(size.ranks - 1, size.blocks));
    const double most = kLeastBlocksShare * plan.training_s * workers / size.blocks;
    if (pipeline.settings.run.shortest_block_s > most) {
      const double least_s = std::max(kLeastBlock_s, most);
      now.push_back({"blocks",
                     stage,
                     fmt::format("{} blocks train for {} each at least (run.shortest_block_s)", size.blocks, base::FormatDuration(least_s)),
                     {{"run.shortest_block_s", fmt::format("{:.3f}", least_s)}}});
    }
  }
  std::vector<GivenUp> given_up;
  for (const Reduction& reduction : now) {
    changes.insert(changes.end(), reduction.changes.begin(), reduction.changes.end());
    given_up.push_back({reduction.what, stage, reduction.text});
  }
  ApplyTo(pipeline, changes);
  const PlannedStage* planned = plan.Find(stage);
  ledger_.SetGivenUp(stage, given_up);
  double predicted_s = planned == nullptr ? 0.0 : planned->seconds;
  if (stage == "evaluate" && planned != nullptr) {
    const double left_s = kPlannedShare * within_s_ - plan.used_s;
    predicted_s = std::max(predicted_s, std::min(left_s, predictor_.Seconds(stage, pipeline.settings)));
  }
  ledger_.Decide(stage, predicted_s, changes);
  for (const std::string& text : TextsOf(now)) base::LogWarning("for {} in all: {}", base::FormatDuration(within_s_), text);
  if (!plan.feasible && planned != nullptr) {
    base::LogWarning("{} of {} are used, and the rest is predicted to end after {}", base::FormatDuration(plan.used_s),
                     base::FormatDuration(within_s_), base::FormatDuration(plan.EndS()));
  }
}

void TimedRun::Began(const std::string& stage) {
  ledger_.Begin(stage);
}

void TimedRun::Ended(Pipeline& pipeline, const std::string& stage) {
  const bool before = ledger_.Of(stage).done;
  ledger_.End(stage);
  WritePlan(pipeline);
  if (before) return;
  const StageRecord record = ledger_.Of(stage);
  predictor_.Correct(stage, record.predicted_s, record.took_s);
  if (stage == "train") TakeTrainingSpeed(pipeline.training);
  base::LogInfo("{} took {} (predicted: {}); {} of {} are used", stage, base::FormatDuration(record.took_s), base::FormatDuration(record.predicted_s),
                base::FormatDuration(ledger_.UsedSeconds()), base::FormatDuration(within_s_));
}

// Hours of training tell more of the machine's speed than a trial of a second.
void TimedRun::TakeTrainingSpeed(const scene::TrainReport& training) {
  double samples = 0.0, thread_seconds = 0.0;
  for (const scene::FieldTraining& field : training.fields) {
    samples += static_cast<double>(field.samples);
    thread_seconds += field.seconds * field.threads;
  }
  if (samples > 0.0 && thread_seconds > 0.0) predictor_.rates().TakeSamples(samples / thread_seconds * predictor_.size().threads);
}

void TimedRun::GaveUp(const std::string& stage, const std::string& what, const std::string& text) {
  std::vector<GivenUp> all = ledger_.AllGivenUp();
  std::erase_if(all, [&](const GivenUp& one) { return one.stage != stage || one.what == what; });
  all.push_back({what, stage, text});
  ledger_.SetGivenUp(stage, all);
}

evaluate::metrics::RunTimes TimedRun::Times() const {
  evaluate::metrics::RunTimes times{
      .within_s = within_s_, .scored_until_s = kPlannedShare * within_s_, .used_s = ledger_.UsedSeconds(), .stages = {}, .given_up = {}};
  for (const std::string& name : StagesOfRun()) {
    const StageRecord record = ledger_.Of(name);
    if (!record.begun && !std::isfinite(record.planned_s)) continue;
    times.stages.push_back({name, record.planned_s, record.predicted_s, record.done ? record.took_s : evaluate::kNotMeasured});
  }
  std::vector<Reduction> given_up;
  for (const GivenUp& one : ledger_.AllGivenUp()) given_up.push_back({one.what, one.stage, one.text, {}});
  times.given_up = TextsOf(given_up);
  return times;
}

void TimedRun::WritePlan(const Pipeline& pipeline) const {
  base::WriteFileAtomically(pipeline.project.PlanFile(), TimesJson(Times()));
}

void UseTotalTime(Pipeline& pipeline) {
  if (pipeline.settings.run.within_s > 0.0) pipeline.timed = std::make_shared<TimedRun>(pipeline);
}

Plan PlanOfNewRun(const Predictor& predictor, const Settings& settings, double within_s, const Room& room) {
  PlanRequest request{.within_s = within_s, .used_s = 0.0, .stages = StagesOfRun(), .settings = settings};
  request.seconds = [&predictor](const std::string& stage, const Settings& changed) { return predictor.Seconds(stage, changed); };
  return PlanWithPayingWidth(predictor, settings, room, [&](const Settings& with_width) {
    request.settings = with_width;
    request.reductions = ReductionsOf(with_width, predictor.size());
    if (GivesTraining(with_width)) request.fixed_training_s = predictor.Seconds("train", with_width);
    return MakePlan(request);
  });
}

}  // namespace skyquilt::coordinator
