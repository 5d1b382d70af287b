#include "worker/train_loop.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/log.h"
#include "worker/start/starting_occupancy.h"

namespace skyquilt::worker {
namespace {

constexpr int kOccupancyEvery = 16;      // steps
constexpr int kGrowEvery = 128;          // steps
constexpr double kGrowUntil = 0.6;       // share of the budget; later, new cells would mostly be empty and only cost samples
constexpr double kVisitsToJudge = 16.0;  // samples per occupied cell: with fewer, cells may be unsampled by chance
constexpr int kMaxDroppedInARow = 20;
constexpr double kReportEvery_s = 0.5;
constexpr size_t kMostFalls = 3;        // the last one ends the training
constexpr double kRateAfterFall = 0.5;  // factor on the learning rate

double Now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

int64_t TotalSteps(const TrainOptions& options) {
  if (options.steps > 0) return options.steps;
  return options.seconds > 0.0 ? 0 : kDefaultSteps;
}

}  // namespace

TrainLoop::TrainLoop(const std::string& kind, const TrainJob& job, render::TrainedField& target, FieldTrainer& trainer,
                     const ContextBrightness* extras, const SessionRecord& record, const Reporter& report)
    : kind_(kind),
      job_(job),
      target_(target),
      trainer_(trainer),
      extras_(extras),
      record_(record),
      report_(report),
      total_steps_(TotalSteps(job.options)),
      good_(target, trainer, extras, record_),
      diagnostics_(job.diagnostics) {
  guard_.SetState(record_.guard);
  // A resumed training continues from a good state.
  if (std::isfinite(record_.guard.best.mean)) good_.Keep();
}

bool TrainLoop::Run() {
  last_ = last_save_ = last_report_ = Now();
  seconds_before_ = record_.seconds;
  for (double fraction = Fraction(); fraction < 1.0; fraction = Fraction()) {
    if (record_.ended_early) break;
    if (base::CancelRequested()) {
      Save();
      throw base::Interrupted();
    }
    if (!Step(fraction)) return false;
    ReportIfDue(fraction);
    SaveIfDue();
  }
  if (!record_.ended_early && !good_.Empty() && guard_.EndsFallen()) EndAtBest();
  if (trainer_.sampler() != nullptr) {
    const double start = Now();
    trainer_.FindOccupied();
    record_.seconds += Now() - start;
  } else {
    MarkUnsampledCells();
  }
  if (recent_.seconds > 0.0) Report(1.0);
  return true;
}

TrainResult TrainLoop::SaveResult(const ContextResults* findings) {
  record_.complete = true;
  NoteGuard();
  SaveSession(kind_, job_, target_, trainer_, record_, extras_, findings);
  return Summarise();
}

TrainResult TrainLoop::Failure() const {
  TrainResult failed = Summarise();
  failed.ok = false;
  failed.reason = "loss or gradient was not finite in " + std::to_string(dropped_in_a_row_) + " steps in a row";
  return failed;
}

double TrainLoop::Fraction() const {
  if (total_steps_ > 0) return static_cast<double>(trainer_.state().step) / static_cast<double>(total_steps_);
  return record_.seconds / std::max(1e-3, job_.options.seconds);
}

bool TrainLoop::Step(double fraction) {
  const int64_t before = trainer_.state().step;
  const double rate = job_.learning_rate_scale * record_.rate_factor * (job_.rate_fault ? job_.rate_fault(before) : 1.0);
  diagnostics_.Before(target_.parameters.networks);
  const StepResult step = trainer_.Step(fraction, rate);
  const int64_t done = trainer_.state().step;
  diagnostics_.After(done, step, target_.parameters.networks, rate);
  if (done % kOccupancyEvery == 0) trainer_.UpdateOccupancy(done % kGrowEvery == 0 && fraction < kGrowUntil);
  if (!RecordError(step)) return false;
  RecordCounts(step);
  Judge(step);
  return true;
}

// Updates the running mean of the error and the number of non-finite steps in a row; false when there are too many of these.
bool TrainLoop::RecordError(const StepResult& step) {
  if (!step.finite) {
    ++record_.dropped_steps;
    if (++dropped_in_a_row_ < kMaxDroppedInARow) return true;
    if (good_.Empty()) return false;
    TakeBack(std::numeric_limits<double>::quiet_NaN());
    return true;
  }
  dropped_in_a_row_ = 0;
  const int64_t done = trainer_.state().step;
  const double keep = done <= 1 ? 0.0 : std::min(0.98, 1.0 - 1.0 / static_cast<double>(done));
  record_.mean_squared_error = keep * record_.mean_squared_error + (1.0 - keep) * step.squared_error;
  return true;
}

void TrainLoop::Judge(const StepResult& step) {
  if (!step.finite) return;
  const double live = static_cast<double>(std::max<int64_t>(1, step.n_live));
  switch (guard_.Add(trainer_.state().step, step.squared_error, static_cast<double>(step.saturated.densities) / live)) {
    case FallGuard::Verdict::kGood:
      if (good_.Empty() || trainer_.state().step - good_.step() >= GoodState::Interval(target_.ParameterCount(), job_.options.batch_samples)) {
        record_.guard = guard_.state();
        good_.Keep();
      }
      break;
    case FallGuard::Verdict::kFallen:
      if (!good_.Empty()) TakeBack(guard_.state().last.mean);
      break;
    case FallGuard::Verdict::kNone:
    case FallGuard::Verdict::kBad:
      break;
  }
}

void TrainLoop::RestoreGoodState() {
  good_.Restore();
  guard_.SetState(record_.guard);
  dropped_in_a_row_ = 0;
}

void TrainLoop::EndAtBest() {
  const FallGuard::State& guard = guard_.state();
  // A fall that two windows would have shown.
  if (guard.bad_in_a_row > 0) return TakeBack(guard.last.mean);
  base::LogInfo("{}: ends {:.1f} dB below its best, so the state of step {} is kept instead", Name(),
                PsnrOfError(guard.best.mean) - PsnrOfError(guard.last.mean), good_.step());
  RestoreGoodState();
}

void TrainLoop::TakeBack(double fell_to) {
  Fall fall;
  fall.step = trainer_.state().step;
  fall.best_psnr_db = PsnrOfError(guard_.state().best.mean);
  fall.psnr_db = PsnrOfError(fell_to);
  fall.restored_step = good_.step();
  RestoreGoodState();
  record_.falls.push_back(fall);
  record_.rate_factor *= kRateAfterFall;
  record_.ended_early = record_.falls.size() >= kMostFalls;
  const std::string what =
      std::isnan(fall.psnr_db) ? "gave values that are not finite" : fmt::format("fell from {:.1f} to {:.1f} dB", fall.best_psnr_db, fall.psnr_db);
  base::LogWarning("{}: training {} at step {} and is taken back to step {}{}", Name(), what, fall.step, fall.restored_step,
                   record_.ended_early ? ", where it ends" : ", with half the learning rate from there");
}

void TrainLoop::RecordCounts(const StepResult& step) {
  const double now = Now();
  const double step_s = now - last_;
  last_ = now;
  record_.seconds += step_s;
  record_.samples += step.n_samples;
  record_.rays += step.n_rays;
  recent_.seconds += step_s;
  recent_.rays += step.n_rays;
  recent_.samples += static_cast<double>(step.n_samples);
  loss_ = step.loss;
}

void TrainLoop::ReportIfDue(double fraction) {
  if (last_ - last_report_ < kReportEvery_s) return;
  Report(fraction);
  recent_ = {};
  last_report_ = last_;
}

void TrainLoop::Report(double fraction) {
  if (!report_) return;
  TrainStatus status;
  status.step = trainer_.state().step;
  status.fraction = std::min(1.0, fraction);
  status.total_steps = total_steps_ > 0 ? total_steps_ : static_cast<int64_t>(static_cast<double>(status.step) / std::max(1e-3, fraction));
  status.seconds = record_.seconds;
  status.run_seconds = std::max(0.0, record_.seconds - seconds_before_);
  status.loss = loss_;
  status.psnr_db = RunningPsnr(record_);
  status.rays_per_second = recent_.rays / std::max(1e-6, recent_.seconds);
  status.samples_per_second = recent_.samples / std::max(1e-6, recent_.seconds);
  status.samples_per_ray = recent_.samples / std::max(1.0, recent_.rays);
  report_(status);
}

void TrainLoop::NoteGuard() {
  if (good_.Empty()) record_.guard = guard_.state();
}

// Writes the last good state, or before there is one the present state.
void TrainLoop::Save() {
  NoteGuard();
  const auto save = [this] { SaveSession(kind_, job_, target_, trainer_, record_, extras_, nullptr); };
  const int64_t step = good_.Empty() ? trainer_.state().step : good_.step();
  if (step == saved_step_) return;
  if (good_.Empty()) {
    save();
  } else {
    good_.With(save);
  }
  saved_step_ = step;
}

void TrainLoop::SaveIfDue() {
  if (last_ - last_save_ < job_.options.checkpoint_every_s) return;
  Save();
  last_ = last_save_ = Now();  // saving is not training
}

// Frees cells at the edge of the photos that no ray has crossed: their densities and colours were never trained. A crossed cell has another tau,
// however wide the samples in it were.
void TrainLoop::MarkUnsampledCells() {
  field::OccupancyGrid& cells = target_.occupancy;
  if (static_cast<double>(record_.samples) > kVisitsToJudge * cells.OccupiedShare() * static_cast<double>(cells.CellCount())) {
    cells.MarkUnsampled(kStartTau);
  }
}

TrainResult TrainLoop::Summarise() const {
  TrainResult result;
  result.ok = true;
  result.steps = trainer_.state().step;
  result.seconds = record_.seconds;
  result.samples = record_.samples;
  result.rays = record_.rays;
  result.parameters = target_.ParameterCount();
  result.final_psnr_db = RunningPsnr(record_);
  result.dropped_steps = record_.dropped_steps;
  result.falls = record_.falls;
  result.ended_early = record_.ended_early;
  result.comparison = record_.comparison;
  result.phase_seconds = trainer_.PhaseSeconds();
  return result;
}

}  // namespace skyquilt::worker
