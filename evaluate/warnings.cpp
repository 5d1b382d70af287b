#include "evaluate/warnings.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

namespace skyquilt::evaluate {

namespace {

// "a, b, c and 4 more"
std::string Names(const std::vector<std::string>& names) {
  constexpr size_t kShown = 8;
  std::string text;
  for (size_t i = 0; i < names.size() && i < kShown; ++i) text += (i == 0 ? "" : ", ") + names[i];
  if (names.size() > kShown) text += fmt::format(" and {} more", names.size() - kShown);
  return text;
}

std::string Photos(size_t n) {
  return fmt::format("{} {}", n, n == 1 ? "photo" : "photos");
}

}  // namespace

std::vector<std::string> CollectWarnings(const survey::Survey& survey, const partition::BlockSet& blocks, const scene::TrainReport* training,
                                         const Metrics& metrics) {
  std::vector<std::string> warnings;
  if (!survey.unregistered.empty()) {
    warnings.push_back(fmt::format("{} without a pose were not used (unreadable, or with too little overlap with other photos): {}",
                                   Photos(survey.unregistered.size()), Names(survey.unregistered)));
  }
  if (!survey.georeferenced) {
    warnings.emplace_back(
        "No geo-reference, because too few photos have usable GPS tags. Positions are in a local frame of unknown scale; lengths are not metres");
  } else {
    std::vector<std::string> outliers;
    for (const survey::Photo& photo : survey.photos) {
      if (photo.gps && std::isfinite(photo.gps_residual_m) && !photo.gps_inlier) outliers.push_back(photo.name);
    }
    if (!outliers.empty()) {
      warnings.push_back(fmt::format("The GPS tags of {} do not fit the camera positions and were not used for the geo-reference: {}",
                                     Photos(outliers.size()), Names(outliers)));
    }
  }
  std::vector<std::string> unfinished;
  for (const partition::Block& block : blocks.blocks) {
    if (block.empty) {
      warnings.push_back(fmt::format("Block {} is empty and was not trained: {}", block.name, block.empty_reason));
    } else if (training != nullptr && training->Find(block.name) == nullptr) {
      unfinished.push_back(block.name);
    }
  }
  if (!unfinished.empty()) warnings.push_back("train.json has no entry for these blocks, run `skyquilt train` again: " + Names(unfinished));
  static const scene::TrainReport kUnknown;
  for (const scene::FieldTraining& field : (training == nullptr ? kUnknown : *training).fields) {
    if (!field.ok)
      warnings.push_back(fmt::format("Training of {} failed: {}. Run `skyquilt train` again to repeat it", field.name,
                                     field.reason.empty() ? "no reason was given" : field.reason));
    if (field.ok && field.dropped_steps > 0) {
      warnings.push_back(fmt::format("Training of {} skipped {} steps whose loss or gradient was not finite", field.name, field.dropped_steps));
    }
  }
  if (training == nullptr) warnings.emplace_back("There is no train.json, so training time, speed and memory are unknown");
  if (metrics.photos.empty()) {
    warnings.emplace_back("No held-out photo was scored, so there are no quality scores; hold out photos with prepare.holdout");
  } else if (std::isfinite(metrics.coverage) && metrics.coverage < 0.5) {
    warnings.push_back(
        fmt::format("Only {:.0f} % of the held-out pixels are seen by at least two training photos; the scores are over these pixels only",
                    100.0 * metrics.coverage));
  }
  if (!metrics.photos.empty() && metrics.photos.size() < static_cast<size_t>(metrics.n_test)) {
    warnings.push_back(fmt::format("Only {} of {} held-out photos were scored (see evaluate.max_photos)", metrics.photos.size(), metrics.n_test));
  }
  return warnings;
}

}  // namespace skyquilt::evaluate
