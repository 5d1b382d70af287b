#include "bench/study/light_scores.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <optional>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/text.h"
#include "evaluate/photos/choose_photos.h"
#include "evaluate/photos/held_out_scorer.h"
#include "evaluate/photos/load_held_out_photo.h"

namespace skyquilt::bench {
namespace {

double Brightness(const uint8_t* rgb) {
  return (static_cast<double>(rgb[0]) + static_cast<double>(rgb[1]) + static_cast<double>(rgb[2])) / (3.0 * 255.0);
}

// The photo of the same name under another light; nothing when there is none.
std::optional<int> PhotoUnder(const survey::Survey& survey, const std::string& light, const std::string& photo) {
  const std::string name = light + "/" + std::filesystem::path(photo).filename().string();
  for (size_t i = 0; i < survey.photos.size(); ++i) {
    if (survey.photos[i].name == name) return static_cast<int>(i);
  }
  return std::nullopt;
}

std::vector<int> HeldOutOf(const survey::Survey& survey, const std::string& light) {
  std::vector<int> chosen;
  for (const int photo : evaluate::photos::HeldOutPhotos(survey)) {
    if (survey.photos[static_cast<size_t>(photo)].name.starts_with(light + "/")) chosen.push_back(photo);
  }
  return chosen;
}

double MeanStops(const evaluate::photos::PhotoScore& score) {
  const double learned = std::accumulate(score.predicted_stops.begin(), score.predicted_stops.end(), 0.0) / 3.0;
  return std::log2(score.exposure_gain) + learned;
}

void AddMoved(const evaluate::EvaluateInput& input, const LightOptions& options, size_t light, const evaluate::photos::ScoredPhoto& scored,
              MovedSums* sums) {
  if (light % 2 == 0 || light + 1 >= options.lights.size()) return;
  const std::string& name = scored.findings.score.name;
  std::array<image::Image8, 2> beside;
  for (size_t side = 0; side < 2; ++side) {
    const std::optional<int> index = PhotoUnder(*input.survey, options.lights[side == 0 ? light - 1 : light + 1], name);
    if (!index) return;
    beside[side] = evaluate::photos::LoadHeldOutPhoto(*input.survey, *input.pixels, *index, input.options.image_width).photo;
  }
  const MovedSums own = CompareMoved(beside[0], scored.task.photo, beside[1], scored.findings.render, scored.findings.scored);
  sums->pixels += own.pixels;
  sums->moved += own.moved;
  sums->squared_error += own.squared_error;
  sums->along += own.along;
  sums->whole += own.whole;
}

}  // namespace

std::string LightOptions::Identity() const {
  return "lights " + base::Join(lights);
}

std::vector<LookPlan> PlanLooks(const std::vector<std::string>& lights, const std::vector<bool>& trained, bool codes) {
  SKYQUILT_CHECK(trained.size() == lights.size(), "one entry per light");
  std::vector<LookPlan> plans;
  const auto add = [&plans](const std::string& look, size_t light, const char* kind) {
    auto at = std::find_if(plans.begin(), plans.end(), [&look](const LookPlan& plan) { return plan.look == look; });
    if (at == plans.end()) at = plans.insert(plans.end(), {look, {}});
    at->shown_for.emplace_back(light, kind);
  };
  for (size_t light = 0; light < lights.size(); ++light) {
    if (!codes) {
      add("", light, kNoLook);
      continue;
    }
    if (trained[light]) {
      add(lights[light], light, kOwnLook);
      continue;
    }
    std::optional<size_t> below, above;
    for (size_t other = 0; other < lights.size(); ++other) {
      if (!trained[other]) continue;
      if (other < light) below = other;
      if (other > light && !above) above = other;
    }
    if (below) add(lights[*below], light, kLowerLook);
    if (above) add(lights[*above], light, kUpperLook);
    if (!below || !above) continue;
    const double t = static_cast<double>(light - *below) / static_cast<double>(*above - *below);
    add(fmt::format("{}:{},{}:{}", lights[*below], 1.0 - t, lights[*above], t), light, kBetweenLook);
  }
  return plans;
}

MovedSums CompareMoved(const image::Image8& below, const image::Image8& photo, const image::Image8& above, const image::Image8& render,
                       const image::Image8& scored) {
  for (const image::Image8* other : {&below, &above, &render, &scored}) {
    SKYQUILT_CHECK(other->width == photo.width && other->height == photo.height, "images of one size");
  }
  MovedSums sums;
  for (int y = 0; y < photo.height; ++y) {
    for (int x = 0; x < photo.width; ++x) {
      if (*scored.At(x, y) == 0) continue;
      ++sums.pixels;
      const double mean = 0.5 * (Brightness(below.At(x, y)) + Brightness(above.At(x, y)));
      const double change = Brightness(photo.At(x, y)) - mean;
      if (std::abs(change) <= kMoved) continue;
      ++sums.moved;
      sums.along += (Brightness(render.At(x, y)) - mean) * change;
      sums.whole += change * change;
      for (int c = 0; c < 3; ++c) {
        const double error = (static_cast<double>(render.At(x, y)[c]) - static_cast<double>(photo.At(x, y)[c])) / 255.0;
        sums.squared_error += error * error / 3.0;
      }
    }
  }
  return sums;
}

std::vector<LightScore> ScoreLook(const evaluate::EvaluateInput& input, const LightOptions& options, const LookPlan& plan,
                                  const std::filesystem::path& folder, base::ThreadPool& threads) {
  base::RequireWritableFolder(folder);
  evaluate::photos::HeldOutScorer scorer(input);
  std::vector<LightScore> scores;
  for (const auto& [light, kind] : plan.shown_for) {
    LightScore score{.light = options.lights[light], .look = kind};
    const std::vector<int> photos = HeldOutOf(*input.survey, score.light);
    MovedSums moved;
    double psnr_db = 0.0, ssim = 0.0, stops = 0.0;
    for (size_t i = 0; i < photos.size(); ++i) {
      base::ThrowIfCancelled();
      const evaluate::photos::ScoredPhoto scored = scorer.Score(photos[i], false, threads);
      psnr_db += scored.findings.score.psnr_db;
      ssim += scored.findings.score.ssim;
      stops += MeanStops(scored.findings.score);
      AddMoved(input, options, light, scored, &moved);
      if (i != photos.size() / 2) continue;
      image::SavePng(scored.task.photo, folder / LightPicture(score.light, "photo"));
      image::SavePng(scored.findings.render, folder / LightPicture(score.light, kind));
    }
    score.photos = static_cast<int>(photos.size());
    const auto n = static_cast<double>(photos.size());
    if (!photos.empty()) {
      score.psnr_db = psnr_db / n;
      score.ssim = ssim / n;
      score.stops = stops / n;
    }
    if (moved.pixels > 0) score.moved_share = static_cast<double>(moved.moved) / static_cast<double>(moved.pixels);
    if (moved.moved > 0) {
      score.moved_psnr_db = -10.0 * std::log10(moved.squared_error / static_cast<double>(moved.moved));
      score.followed = moved.along / moved.whole;
    }
    scores.push_back(std::move(score));
  }
  return scores;
}

std::string LightPicture(const std::string& light, const std::string& kind) {
  return light + "_" + kind + ".png";
}

}  // namespace skyquilt::bench
