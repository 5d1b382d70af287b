#include "core/brightness/luminance.h"

#include <algorithm>
#include <cmath>

#include "core/image/srgb.h"

namespace skyquilt::brightness {
namespace {

constexpr double kUnderMean = 0.2, kOverMean = 0.75, kOverClipped = 0.1;
constexpr double kLeastLogGain = -6.9, kMostLogGain = -0.05;

LuminanceMode ModeOf(const BrightnessOptions& options, const BrightnessStatistics& statistics) {
  if (!options.Luminance()) return LuminanceMode::kNone;
  if (options.luminance_mode == "under") return LuminanceMode::kUnder;
  if (options.luminance_mode == "over") return LuminanceMode::kOver;
  if (statistics.mean_srgb < kUnderMean) return LuminanceMode::kUnder;
  return statistics.mean_srgb > kOverMean || statistics.clipped > kOverClipped ? LuminanceMode::kOver : LuminanceMode::kNone;
}

}  // namespace

Luminance PlanLuminance(const BrightnessOptions& options, const BrightnessStatistics& statistics) {
  Luminance luminance;
  luminance.mode = ModeOf(options, statistics);
  luminance.product = options.luminance_form == "product";
  luminance.toned = options.luminance_loss == "toned";
  luminance.patches = options.luminance_neighbours == "patch";
  luminance.target = options.target_brightness;
  const double wanted = static_cast<double>(image::LinearFromSrgb(static_cast<float>(options.target_brightness)));
  const double seen = std::max(1e-6, static_cast<double>(image::LinearFromSrgb(static_cast<float>(statistics.mean_srgb))));
  const double log_gain = luminance.mode == LuminanceMode::kUnder ? std::log(seen / wanted) : std::log(wanted / seen);
  luminance.start_log_gain = std::clamp(log_gain, kLeastLogGain, kMostLogGain);
  return luminance;
}

void PutLuminance(const Luminance& luminance, const LuminanceState& state, checkpoint::ArchiveWriter& writer) {
  writer.SetAttribute("luminance_mode", static_cast<int>(luminance.mode));
  writer.SetAttribute("luminance_product", luminance.product ? 1 : 0);
  writer.SetAttribute("luminance_patches", luminance.patches ? 1 : 0);
  if (!luminance.toned) writer.SetAttribute("luminance_plain_loss", 1);
  writer.SetAttribute("luminance_target", luminance.target);
  writer.SetAttribute("luminance_start", luminance.start_log_gain);
  writer.SetAttribute("luminance_mean_shown", state.mean_shown);
  writer.SetAttribute("luminance_mean_log_gain", state.mean_log_gain);
}

void GetLuminance(const checkpoint::ArchiveReader& reader, Luminance* luminance, LuminanceState* state) {
  *luminance = {};
  *state = {};
  if (!reader.HasAttribute("luminance_mode")) return;
  const int64_t mode = reader.IntAttribute("luminance_mode");
  luminance->mode = mode == 1 ? LuminanceMode::kUnder : mode == 2 ? LuminanceMode::kOver : LuminanceMode::kNone;
  luminance->product = reader.IntAttribute("luminance_product") != 0;
  luminance->patches = reader.IntAttribute("luminance_patches") != 0;
  luminance->toned = !reader.HasAttribute("luminance_plain_loss");
  luminance->target = reader.DoubleAttribute("luminance_target");
  luminance->start_log_gain = reader.DoubleAttribute("luminance_start");
  state->mean_shown = reader.DoubleAttribute("luminance_mean_shown");
  state->mean_log_gain = reader.DoubleAttribute("luminance_mean_log_gain");
}

}  // namespace skyquilt::brightness
