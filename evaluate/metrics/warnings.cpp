#include "evaluate/metrics/warnings.h"

#include <fmt/core.h>

#include <cmath>
#include <map>
#include <string>

#include "partition/altitude.h"

namespace skyquilt::evaluate::metrics {

namespace {

constexpr double kLowCoverage = 0.5;

// "a, b, c and 4 more"
std::string Names(const std::vector<std::string>& names) {
  constexpr size_t kShown = 8;
  std::string text;
  for (size_t i = 0; i < names.size() && i < kShown; ++i) text += (i == 0 ? "" : ", ") + names[i];
  if (names.size() > kShown) text += fmt::format(" and {} more", names.size() - kShown);
  return text;
}

std::string Decibels(double value, int decimals) {
  return std::isfinite(value) ? fmt::format("{:.{}f} dB", value, decimals) : "values that are not finite";
}

// "Block a is", "Blocks a and 3 more are"
std::string BlocksAre(const std::vector<std::string>& names) {
  return fmt::format("{} {} {}", names.size() == 1 ? "Block" : "Blocks", Names(names), names.size() == 1 ? "is" : "are");
}

void AboutPlacedPhotos(const survey::Survey& survey, std::vector<Warning>* warnings) {
  if (survey.unregistered.empty()) return;
  const size_t n = survey.unregistered.size();
  warnings->push_back(
      {fmt::format("{} of {} photos {} not placed: the COLMAP model has no camera position for {}", n, survey.photos.size() + n,
                   n == 1 ? "was" : "were", Names(survey.unregistered)),
       "The map is made without them. If they matter, check that they are sharp and show firm ground rather than water, add photos that overlap them "
       "more, and run the same command with --restart. If skyquilt ran COLMAP, its log is survey/colmap/colmap.log"});
}

// What prepare found. A wrong place makes all else wrong, so problems with it come first.
void AboutSurvey(const survey::Survey& survey, std::vector<Warning>* warnings) {
  for (const bool about_place : {true, false}) {
    for (const survey::Problem& problem : survey.problems) {
      if (problem.about_place == about_place) warnings->push_back({problem.finding, problem.advice});
    }
  }
}

void AboutBlocks(const partition::BlockSet& blocks, const scene::TrainReport* training, std::vector<Warning>* warnings) {
  std::map<std::string, std::vector<std::string>> empty;  // by reason
  std::vector<std::string> untrained;
  for (const partition::Block& block : blocks.blocks) {
    if (block.empty) {
      empty[block.empty_reason].push_back(block.name);
    } else if (training != nullptr && training->Find(block.name) == nullptr) {
      untrained.push_back(block.name);
    }
  }
  for (const partition::Block& block : blocks.blocks) {
    if (block.empty) continue;
    if (const std::string doubt = partition::AltitudeDoubt(block); !doubt.empty()) {
      warnings->push_back({fmt::format("Block {}: {}", block.name, doubt),
                           "Leave out --altitudes to use the heights that were flown, or give the right ones, and run again with --restart"});
    }
  }
  for (const auto& [reason, names] : empty) {
    warnings->push_back({fmt::format("{} empty and not trained: {}", BlocksAre(names), reason.empty() ? "no reason was given" : reason),
                         "Nothing needs to be done if this ground lies outside the survey or is water. Otherwise add photos of it, so that at least "
                         "two see every place, or cut fewer and larger blocks with --blocks"});
  }
  if (!untrained.empty()) {
    warnings->push_back({fmt::format("{} without a record of training", BlocksAre(untrained)),
                         "The map is coarse there or has a hole. Run 'skyquilt train' on the project folder again: only what is missing is trained"});
  }
}

// A training that was taken back, and a block that does not show its own field.
void AboutFalls(const std::string& name, const scene::FieldTraining& field, std::vector<Warning>* warnings) {
  if (!field.falls.empty()) {
    const scene::FieldFall& last = field.falls.back();
    warnings->push_back(
        {fmt::format("Training of {} fell apart {} (the last time from {} to {} of training PSNR at step {}) and was taken back to "
                     "step {}{}",
                     name, field.falls.size() == 1 ? "once" : fmt::format("{} times", field.falls.size()), Decibels(last.best_psnr_db, 1),
                     Decibels(last.psnr_db, 1), last.step, last.restored_step, field.ended_early ? ", where it ended" : ""),
         "What is shown is its best state. If it looks poor, lower train.learning_rate and train again with --restart"});
  }
  if (field.shows_context) {
    warnings->push_back(
        {fmt::format("Block {} shows its photos worse than the coarse context does ({} instead of {} on the same training pixels), so "
                     "the context is shown in its place",
                     field.name, Decibels(field.block_psnr_db, 2), Decibels(field.context_psnr_db, 2)),
         fmt::format("It was trained for {} steps. Train longer with --time-budget, or cut fewer blocks with --blocks", field.steps)});
  }
}

void AboutTraining(const scene::TrainReport* training, std::vector<Warning>* warnings) {
  if (training == nullptr) {
    warnings->push_back({"There is no train.json: training time, speed and memory are unknown",
                         "The other figures are not affected. Run 'skyquilt train' on the project folder to have these too"});
    return;
  }
  for (const scene::FieldTraining& field : training->fields) {
    const std::string name = field.block < 0 && field.name == "context" ? "the context" : "block " + field.name;
    if (!field.ok) {
      warnings->push_back({fmt::format("Training of {} failed: {}", name, field.reason.empty() ? "no reason was given" : field.reason),
                           "The map is coarse there or has a hole. Run the same command again: only what failed is trained. If it fails again, lower "
                           "train.learning_rate, or cut smaller blocks with --blocks; log.txt has the details"});
    } else if (field.dropped_steps > 0) {
      warnings->push_back({fmt::format("Training of {} left out {} {} with a loss or gradient that was not finite", name, field.dropped_steps,
                                       field.dropped_steps == 1 ? "step" : "steps"),
                           "A few do no harm. If there are many, lower train.learning_rate and train again with --restart"});
    }
    AboutFalls(name, field, warnings);
  }
}

void AboutScores(const Metrics& metrics, std::vector<Warning>* warnings) {
  if (metrics.photos.empty()) {
    warnings->push_back({"No held-out photo was scored, so there are no figures of quality",
                         "Keep some photos out of training with --holdout every:8, and run the same command with --restart"});
    return;
  }
  if (std::isfinite(metrics.coverage) && metrics.coverage < kLowCoverage) {
    warnings->push_back(
        {fmt::format("Only {:.0f} % of the held-out pixels show ground that two training photos or more see. The scores count only these pixels",
                     100.0 * metrics.coverage),
         "Add photos with more overlap, so that every place is seen from at least two positions"});
  }
  if (metrics.photos.size() < static_cast<size_t>(metrics.n_test)) {
    warnings->push_back({fmt::format("Only {} of {} held-out photos were scored", metrics.photos.size(), metrics.n_test),
                         "Run 'skyquilt evaluate' with --max-photos 0 --restart to score all of them"});
  }
}

}  // namespace

std::vector<Warning> CollectWarnings(const survey::Survey& survey, const partition::BlockSet& blocks, const scene::TrainReport* training,
                                     const Metrics& metrics) {
  std::vector<Warning> warnings;
  AboutSurvey(survey, &warnings);
  AboutPlacedPhotos(survey, &warnings);
  AboutBlocks(blocks, training, &warnings);
  AboutTraining(training, &warnings);
  AboutScores(metrics, &warnings);
  return warnings;
}

}  // namespace skyquilt::evaluate::metrics
