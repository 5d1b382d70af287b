#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "bench/study/light_parts.h"
#include "bench/study/picture_sheet.h"
#include "bench/study/study_tables.h"
#include "core/base/file.h"
#include "core/page/curve_chart.h"

namespace skyquilt::bench {
namespace {

constexpr double kNone = LightScore::kNone;
// Shadows fade when mixed codes come less than this share of the way from a cross-fade to the light's own code.
constexpr double kFades = 0.5;
// Codes that show less than this of their movement, where their light was trained, do not hold shadows.
constexpr double kHolds = 0.25;

double Of(const VariantResult& result, const std::string& light, const std::string& look, double LightScore::*member) {
  const LightScore* score = FindScore(result, light, look);
  return score == nullptr ? kNone : score->*member;
}

// By the light's own code where it was trained, else by mixed codes.
double EverySecond(const LightSet& set, const std::string& light, double LightScore::*member) {
  const double own = Of(set.every_second, light, kOwnLook, member);
  return std::isfinite(own) ? own : Of(set.every_second, light, kBetweenLook, member);
}

double BetterOfTwo(const VariantResult& result, const std::string& light, double LightScore::*member) {
  const double lower = Of(result, light, kLowerLook, member), upper = Of(result, light, kUpperLook, member);
  return std::isnan(lower) ? upper : std::isnan(upper) ? lower : std::max(lower, upper);
}

// What the mean of the renderings with both neighbours' codes would follow: `followed` is linear in the rendering.
double CrossFade(const VariantResult& result, const std::string& light) {
  return 0.5 * (Of(result, light, kLowerLook, &LightScore::followed) + Of(result, light, kUpperLook, &LightScore::followed));
}

// Means over the lights between by their moved pixels.
struct Followed {
  double cross_fade = kNone, mixed = kNone, own = kNone;
};
Followed FollowedBetween(const LightSet& set) {
  double weights = 0.0;
  Followed sums{0.0, 0.0, 0.0};
  for (size_t i = 1; i + 1 < set.lights.size(); i += 2) {
    const std::string& light = set.lights[i];
    const double weight = Of(set.every_second, light, kBetweenLook, &LightScore::moved_share);
    if (!(weight > 0.0)) continue;
    weights += weight;
    sums.cross_fade += weight * CrossFade(set.every_second, light);
    sums.mixed += weight * Of(set.every_second, light, kBetweenLook, &LightScore::followed);
    sums.own += weight * Of(set.all, light, kOwnLook, &LightScore::followed);
  }
  if (weights == 0.0) return {};
  return {sums.cross_fade / weights, sums.mixed / weights, sums.own / weights};
}

bool HasCorrected(const LightSet& set) {
  return !set.corrected.lights.empty();
}

// Slope of the line through (true stops, found stops) of all lights: 1 where all of the change was found.
double FoundOfStops(const LightSet& set) {
  double n = 0.0, sum_x = 0.0, sum_y = 0.0, sum_xx = 0.0, sum_xy = 0.0;
  for (const std::string& light : set.lights) {
    const double x = std::log2(LightValue(light)), y = Of(set.corrected, light, kNoLook, &LightScore::stops);
    if (!std::isfinite(y)) continue;
    n += 1.0;
    sum_x += x;
    sum_y += y;
    sum_xx += x * x;
    sum_xy += x * y;
  }
  const double spread = n * sum_xx - sum_x * sum_x;
  return spread > 0.0 ? (n * sum_xy - sum_x * sum_y) / spread : kNone;
}

double Mean(const LightSet& set, const VariantResult& result, const std::string& look, double LightScore::*member) {
  double sum = 0.0;
  for (const std::string& light : set.lights) sum += Of(result, light, look, member);
  return set.lights.empty() ? kNone : sum / static_cast<double>(set.lights.size());
}

}  // namespace

double LightValue(const std::string& folder) {
  double value = kNone;
  const size_t begin = folder.rfind('_') + 1;
  std::from_chars(folder.data() + begin, folder.data() + folder.size(), value);
  return value;
}

const LightScore* FindScore(const VariantResult& result, const std::string& light, const std::string& look) {
  const auto at =
      std::find_if(result.lights.begin(), result.lights.end(), [&](const LightScore& score) { return score.light == light && score.look == look; });
  return at == result.lights.end() ? nullptr : &*at;
}

double MeanBetween(const LightSet& set, const VariantResult& result, const std::string& look, double LightScore::*member) {
  double sum = 0.0;
  int lights = 0;
  for (size_t i = 1; i + 1 < set.lights.size(); i += 2, ++lights) sum += Of(result, set.lights[i], look, member);
  return lights > 0 ? sum / lights : kNone;
}

double MovementOfShadows(const LightSet& set) {
  const Followed followed = FollowedBetween(set);
  if (!(followed.own >= kHolds) || !(followed.own > followed.cross_fade)) return kNone;
  return (followed.mixed - followed.cross_fade) / (followed.own - followed.cross_fade);
}

BenchTable LightTable(const LightSet& set, const std::string& name, const std::string& unit) {
  BenchTable table{
      .name = name,
      .title = "PSNR of held-out photos under each light",
      .note =
          "Every second light is trained; there the code is the light's own. Better neighbour: the code of the light below or above, "
          "whichever shows this light better. All lights: another training, in which every light has a code of its own.",
      .columns = {unit, "trained", "own or mixed code", "better neighbour", "all lights", "no codes", "SSIM, own or mixed", "SSIM, all lights"},
      .rows = {}};
  if (HasCorrected(set)) table.columns.insert(table.columns.end(), {"corrected brightness, no codes", "found stops"});
  for (size_t i = 0; i < set.lights.size(); ++i) {
    const std::string& light = set.lights[i];
    constexpr auto psnr_db = &LightScore::psnr_db;
    std::vector<BenchCell> row = {
        BenchCell::Number(LightValue(light), HasCorrected(set) ? 2 : 0),   BenchCell::Text(i % 2 == 0 ? "yes" : "no"),
        BenchCell::Number(EverySecond(set, light, psnr_db), 2, "dB"),      BenchCell::Number(BetterOfTwo(set.every_second, light, psnr_db), 2, "dB"),
        BenchCell::Number(Of(set.all, light, kOwnLook, psnr_db), 2, "dB"), BenchCell::Number(Of(set.plain, light, kNoLook, psnr_db), 2, "dB"),
        BenchCell::Number(EverySecond(set, light, &LightScore::ssim), 3),  BenchCell::Number(Of(set.all, light, kOwnLook, &LightScore::ssim), 3)};
    if (HasCorrected(set)) {
      row.push_back(BenchCell::Number(Of(set.corrected, light, kNoLook, psnr_db), 2, "dB"));
      row.push_back(BenchCell::Number(Of(set.corrected, light, kNoLook, &LightScore::stops), 2));
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

BenchTable MovedTable(const LightSet& set, const std::string& name) {
  BenchTable table{.name = name,
                   .title = "Where shadows moved",
                   .note = fmt::format(
                       "Moved pixels: the photo's brightness differs from the mean of the photos under both neighbouring lights by more than {:g} of "
                       "the range. Followed: how much of that difference the rendering shows; 0: the mean of both, 1: the photo. Cross-fade: "
                       "the mean of the renderings with both neighbours' codes, as shadows would fade. All lights: by the code of this light.",
                       kMoved),
                   .columns = {"sun (degrees)", "moved pixels", "followed, cross-fade", "followed, mixed code", "followed, all lights",
                               "PSNR there, mixed code", "PSNR there, better neighbour", "PSNR there, all lights"},
                   .rows = {}};
  for (size_t i = 1; i + 1 < set.lights.size(); i += 2) {
    const std::string& light = set.lights[i];
    constexpr auto followed = &LightScore::followed;
    constexpr auto psnr_db = &LightScore::moved_psnr_db;
    table.rows.push_back(
        {BenchCell::Number(LightValue(light), 0), BenchCell::Percent(Of(set.every_second, light, kBetweenLook, &LightScore::moved_share)),
         BenchCell::Number(CrossFade(set.every_second, light), 2), BenchCell::Number(Of(set.every_second, light, kBetweenLook, followed), 2),
         BenchCell::Number(Of(set.all, light, kOwnLook, followed), 2), BenchCell::Number(Of(set.every_second, light, kBetweenLook, psnr_db), 2, "dB"),
         BenchCell::Number(BetterOfTwo(set.every_second, light, psnr_db), 2, "dB"),
         BenchCell::Number(Of(set.all, light, kOwnLook, psnr_db), 2, "dB")});
  }
  return table;
}

std::string LightChart(const LightSet& set, const std::string& title, const std::string& x_label) {
  page::Curve mixed{.name = "every second light trained", .emphasised = true, .marks = true}, all{.name = "all lights trained", .marks = true},
      none{.name = "no codes", .marks = true}, corrected{.name = "corrected brightness, no codes", .marks = true};
  for (const std::string& light : set.lights) {
    const double x = LightValue(light);
    mixed.points.emplace_back(x, EverySecond(set, light, &LightScore::psnr_db));
    all.points.emplace_back(x, Of(set.all, light, kOwnLook, &LightScore::psnr_db));
    none.points.emplace_back(x, Of(set.plain, light, kNoLook, &LightScore::psnr_db));
    corrected.points.emplace_back(x, Of(set.corrected, light, kNoLook, &LightScore::psnr_db));
  }
  std::vector<page::Curve> curves = {mixed, all, none};
  if (HasCorrected(set)) curves.push_back(corrected);
  return page::CurveChart(curves, {.title = title, .x_label = x_label, .y_label = "PSNR (dB)"});
}

std::vector<std::string> SunVerdicts(const LightSet& set) {
  const Followed followed = FollowedBetween(set);
  if (!std::isfinite(followed.mixed) || !std::isfinite(followed.own) || !std::isfinite(followed.cross_fade)) {
    return {"Shadows hardly move between these lights, so nothing is said of them."};
  }
  const double way = MovementOfShadows(set);
  std::vector<std::string> verdicts = {
      fmt::format("Of what moving shadows change beyond the mean of both neighbours, a cross-fade of both renderings shows {:.0f} %, mixed codes "
                  "{:.0f} %, and a code "
                  "of the light itself {:.0f} %.",
                  100.0 * followed.cross_fade, 100.0 * followed.mixed, 100.0 * followed.own)};
  if (!std::isfinite(way)) {
    verdicts.emplace_back("So shadows are hardly held by codes, even where their light was trained, and mixing says little here.");
  } else {
    verdicts.push_back(fmt::format("So mixed codes come {:.0f} % of the way from fading to moving shadows: {}.", 100.0 * way,
                                   way < kFades ? "they fade more than they move, as MatrixCity's supplement says"
                                                : "they move more than they fade, other than MatrixCity's supplement says"));
  }
  const double mixed_db = MeanBetween(set, set.every_second, kBetweenLook, &LightScore::psnr_db);
  double neighbour_db = 0.0;
  int lights = 0;
  for (size_t i = 1; i + 1 < set.lights.size(); i += 2, ++lights) neighbour_db += BetterOfTwo(set.every_second, set.lights[i], &LightScore::psnr_db);
  verdicts.push_back(
      fmt::format("Lights between the trained ones: mixed codes {:.2f} dB, the better neighbour's code {:.2f} dB, codes of all lights {:.2f} dB, no "
                  "codes {:.2f} dB.",
                  mixed_db, neighbour_db / std::max(lights, 1), MeanBetween(set, set.all, kOwnLook, &LightScore::psnr_db),
                  MeanBetween(set, set.plain, kNoLook, &LightScore::psnr_db)));
  return verdicts;
}

std::vector<std::string> IntensityVerdicts(const LightSet& set) {
  constexpr auto psnr_db = &LightScore::psnr_db;
  std::vector<std::string> verdicts;
  if (const double found = FoundOfStops(set); std::isfinite(found)) {
    verdicts.push_back(fmt::format(
        "Intensity: the brightness correction finds {:.0f} % of the stops between the lights by itself; held-out photos have {:.2f} dB with it, "
        "{:.2f} dB without it and {:.2f} dB with a code of every light instead.",
        100.0 * found, Mean(set, set.corrected, kNoLook, psnr_db), Mean(set, set.plain, kNoLook, psnr_db), Mean(set, set.all, kOwnLook, psnr_db)));
  }
  const double mixed_db = MeanBetween(set, set.every_second, kBetweenLook, psnr_db);
  if (std::isfinite(mixed_db)) {
    verdicts.push_back(fmt::format("Intensities between the trained ones: mixed codes {:.2f} dB, codes of all lights {:.2f} dB.", mixed_db,
                                   MeanBetween(set, set.all, kOwnLook, psnr_db)));
  }
  return verdicts;
}

BenchSection WriteLightPictures(const LightSet& set, const std::filesystem::path& folder) {
  BenchSection section{
      .id = "pictures",
      .title = "Pictures",
      .lead =
          "One held-out view. Upper row: photos under a light between and its two neighbours. Lower row: the code of the light below, the "
          "mixed code, the code of the light above, and the light's own code of the training with all lights.",
      .charts = {},
      .tables = {},
      .pictures = {},
      .magnified = false};
  std::vector<std::vector<CaptionedImage>> rows;
  const auto add = [&](const VariantResult& result, const std::string& light, const std::string& kind, const std::string& caption) {
    const std::string file = result.light_pictures + "/" + LightPicture(light, kind);
    if (result.light_pictures.empty() || !std::filesystem::is_regular_file(folder / file)) return;
    section.pictures.push_back({file, caption});
    rows.back().push_back({caption, image::LoadRgb8(folder / file)});
  };
  constexpr std::array<size_t, 3> kShown = {1, 3, 7};  // a low sun moves shadows most
  for (const size_t k : kShown) {
    if (k + 1 >= set.lights.size()) continue;
    rows.emplace_back();
    for (const size_t i : {k - 1, k, k + 1}) add(set.every_second, set.lights[i], "photo", "photo, " + set.lights[i]);
    rows.emplace_back();
    add(set.every_second, set.lights[k], kLowerLook, "code of " + set.lights[k - 1]);
    add(set.every_second, set.lights[k], kBetweenLook, "mixed code");
    add(set.every_second, set.lights[k], kUpperLook, "code of " + set.lights[k + 1]);
    add(set.all, set.lights[k], kOwnLook, "own code, all lights");
  }
  std::erase_if(rows, [](const auto& row) { return row.empty(); });
  if (!rows.empty()) image::SavePng(PictureSheet(rows), folder / "light.png");
  return section;
}

}  // namespace skyquilt::bench
