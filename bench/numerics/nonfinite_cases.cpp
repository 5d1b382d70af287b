// NaN and infinity in batches and parameters: they must never spread to other parameters.
#include <fmt/core.h>

#include "bench/numerics/edge_survey.h"
#include "bench/numerics/groups.h"
#include "bench/numerics/hamlet_flight.h"
#include "bench/numerics/synthetic_trainer.h"

namespace skyquilt::bench {
namespace {

constexpr float kNotANumber = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();
const worker::StepOptions kPoisonOptions{.learning_rate = 1e-2, .network_l2 = 1e-6, .distortion = 1e-2};

using Poison = std::function<void(worker::RayBatch& batch, TrainingState& state)>;

// A few normal steps, one with a non-finite value, and a normal one.
CaseResult PoisonedStep(const Poison& poison) {
  SyntheticTrainer trainer({}, 9, 1);
  base::Random random(43);
  for (int step = 0; step < 5; ++step) trainer.Train(trainer.Draw({.rays = 200}, random), kPoisonOptions);
  const TrainingState before = trainer.state();
  worker::RayBatch batch = trainer.Draw({.rays = 200}, random);
  poison(batch, trainer.state());
  const bool poisoned_state = !AllFinite(trainer.state());
  const worker::StepResult result = trainer.Train(batch, kPoisonOptions);
  // A non-finite parameter is restored, as from the last good checkpoint; the others must not have changed.
  if (poisoned_state) {
    trainer.state().parameters.grid[0] = before.parameters.grid[0];
    trainer.state().parameters.networks[0] = before.parameters.networks[0];
  }
  const bool untouched = SameParameters(before, trainer.state());
  const worker::StepResult after = trainer.Train(trainer.Draw({.rays = 200}, random), kPoisonOptions);
  const bool continues = after.finite && AllFinite(trainer.state()) && !SameParameters(before, trainer.state());
  return {.seen = fmt::format("step {}, parameters and moments {}, the next step {}", result.finite ? "taken" : "dropped",
                              untouched ? "unchanged" : "changed", continues ? "trains" : "does not train"),
          .worst = kNoNumber,
          .holds = !result.finite && untouched && continues};
}

// NaN positions count as a corner of the box. The parameters must stay finite, whether the step is taken or dropped.
CaseResult NanPositions() {
  SyntheticTrainer trainer({}, 9, 1);
  base::Random random(43);
  bool finite = true;
  for (const float bad : {kNotANumber, kInfinity, -kInfinity, 1e30F}) {
    worker::RayBatch batch = trainer.Draw({.rays = 200}, random);
    for (size_t s = 0; s < batch.x.size(); s += 7) batch.x[s] = batch.z[s] = bad;
    trainer.Train(batch, kPoisonOptions);
    finite = finite && AllFinite(trainer.state());
  }
  return {.seen = finite ? "parameters and moments finite" : "not finite", .worst = kNoNumber, .holds = finite};
}

// The gain of every photo is NaN, so training must fail.
CaseResult FailsWithReason(const NumericsOptions& options) {
  const QuietStages quiet(options.silent);
  const EdgeSurvey survey(options.work_folder / "photos", 48, 36, [](int, int x, int y) {
    const auto value = static_cast<uint8_t>(100 + (x + y) % 50);
    return std::array<uint8_t, 3>{value, value, value};
  });
  brightness::Response response = brightness::Response::Neutral(EdgeSurvey::kPhotos, 1);
  for (float& value : response.log_gain) value = kNotANumber;
  base::ThreadPool threads(options.threads);
  const EdgeSurvey::Outcome outcome = survey.Train(response, 100, threads);
  return {.seen = outcome.context.ok ? "trained" : outcome.context.reason,
          .worst = static_cast<double>(outcome.context.dropped_steps),
          .holds = !outcome.context.ok && outcome.context.dropped_steps == 20};
}

}  // namespace

NumericGroup NonFiniteGroup(const NumericsOptions& options) {
  NumericGroup group{
      .id = "nonfinite",
      .title = "Not a number",
      .lead =
          "NaN and infinity in a batch or in the parameters of a field in training. The step must be dropped and counted, nothing else may "
          "change, and training must continue."};
  const auto add = [&group](const std::string& name, const Poison& poison) {
    group.cases.push_back({.name = name,
                           .expected = "the step is dropped, parameters and moments stay bit-identical, the next step trains",
                           .run = [poison] { return PoisonedStep(poison); }});
  };
  add("A pixel that is NaN", [](worker::RayBatch& batch, TrainingState&) { batch.rays[7].ray.target_srgb[1] = kNotANumber; });
  add("A pixel that is infinite", [](worker::RayBatch& batch, TrainingState&) { batch.rays[7].ray.target_srgb[1] = -kInfinity; });
  add("A background that is NaN", [](worker::RayBatch& batch, TrainingState&) { batch.rays[7].background[0] = kNotANumber; });
  add("A ray whose direction is NaN", [](worker::RayBatch& batch, TrainingState&) { batch.rays[7].ray.direction_enu.setConstant(std::nan("")); });
  add("A gain that is NaN", [](worker::RayBatch& batch, TrainingState&) { batch.rays[7].ray.exposure[2] = {kNotANumber, kNotANumber, kNotANumber}; });
  add("A gain that is infinite", [](worker::RayBatch& batch, TrainingState&) { batch.rays[7].ray.exposure[2] = {100.0F, kInfinity, kInfinity}; });
  add("An interval whose length is NaN", [](worker::RayBatch& batch, TrainingState&) { batch.unit_length[3] = kNotANumber; });
  add("A network parameter that is NaN", [](worker::RayBatch&, TrainingState& state) { state.parameters.networks[0] = kNotANumber; });
  add("A network parameter that is infinite", [](worker::RayBatch&, TrainingState& state) { state.parameters.networks[0] = kInfinity; });
  add("A table that is NaN", [](worker::RayBatch&, TrainingState& state) { state.parameters.grid[0] = kNotANumber; });
  group.cases.push_back(
      {.name = "Positions that are NaN, infinite or far outside", .expected = "parameters and moments stay finite", .run = NanPositions});
  group.cases.push_back({.name = "A field whose every step fails",
                         .expected = "training ends after 20 dropped steps in a row and gives the reason",
                         .unit = "steps dropped",
                         .limit = 20.0,
                         .run = [options] { return FailsWithReason(options); }});
  return group;
}

}  // namespace skyquilt::bench
