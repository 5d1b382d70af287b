#include "coordinator/planning/paying_width.h"

#include <algorithm>
#include <cmath>

namespace skyquilt::coordinator {
namespace {

// Training samples for each pixel of the training photos that wider photos must get. With 20 the same total gave less than smaller photos; more than
// 60 only long trainings have. Between them nothing was measured (docs/experiments/capacity-and-encodings.md).
constexpr double kSamplesPerPixel = 60.0;
constexpr double kStep = 0.8;
// Training has at least this share of a plan with wider photos: before there is a scene, the times of the stages after it are guesses, and where they
// turn out twice as long, detail of maps and surface would be given up for the width.
constexpr double kTrainingShareOfWider = 0.7;
constexpr double kMemoryShare = 0.5;
constexpr double kBytesPerPixel = 3.0;

// Whether the settings' width does.
bool Pays(const WorkSize& size, const Settings& settings, double samples, const Room& room) {
  const double pixels = size.PixelsAt(settings.run.image_width);
  const bool enough = std::isfinite(samples) && samples >= kSamplesPerPixel * pixels * size.TrainingPhotos();
  return enough && kBytesPerPixel * pixels * size.photos <= kMemoryShare * room.memory_limit && NeedsOf(size, settings).disk <= room.disk;
}

}  // namespace

std::vector<int> WidthsToChooseFrom(int photo_width) {
  std::vector<int> widths;
  for (int width = photo_width; width > kLeastAutoWidth; width = static_cast<int>(kStep * width)) widths.push_back(width);
  widths.push_back(kLeastAutoWidth);
  return widths;
}

int PayingWidth(const WorkSize& size, Settings settings, double samples, const Room& room) {
  for (const int width : WidthsToChooseFrom(size.photo_width)) {
    settings.run.image_width = width;
    if (Pays(size, settings, samples, room)) return width;
  }
  return kLeastAutoWidth;
}

Plan PlanWithPayingWidth(const Predictor& predictor, Settings settings, const Room& room, const std::function<Plan(const Settings&)>& plan_at) {
  if (settings.run.image_width != kAutoWidth) return plan_at(settings);
  const WorkSize& size = predictor.size();
  settings.run.image_width = kLeastAutoWidth;
  const Plan least = plan_at(settings);
  const auto is_given_up = [&least](const Reduction& one) {
    return std::any_of(least.reductions.begin(), least.reductions.end(), [&one](const Reduction& other) { return other.what == one.what; });
  };
  const double samples_per_s = predictor.rates().samples * size.Speedup() * (1.0 - settings.run.context_share);
  for (const int width : WidthsToChooseFrom(size.photo_width)) {
    if (width == kLeastAutoWidth) break;
    settings.run.image_width = width;
    Plan plan = plan_at(settings);
    const bool no_less = plan.feasible && plan.training_s >= kTrainingShareOfWider * plan.Seconds() &&
                         std::all_of(plan.reductions.begin(), plan.reductions.end(), is_given_up);
    if (no_less && Pays(size, settings, plan.training_s * samples_per_s, room)) return plan;
  }
  return least;
}

}  // namespace skyquilt::coordinator
