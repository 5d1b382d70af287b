#include "evaluate/page/brightness_report.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <numeric>

#include "core/base/errors.h"
#include "core/base/json_text.h"
#include "core/brightness/captured_photos.h"
#include "core/brightness/predict_gains.h"
#include "core/camera/corner_radius.h"
#include "core/image/srgb.h"
#include "evaluate/page/page_parts.h"

namespace skyquilt::evaluate::page {

namespace {

constexpr int kGrid = 48;           // sampled pixels per row and per column of a photo
constexpr double kOffStops = 0.15;  // smaller differences are hard to see

struct LightOfPhotos {
  std::vector<double> before_stops, after_stops;  // log2 of the mean light of each photo
  BrightnessHistogram before = {}, after = {};    // pixels
};

size_t BinOf(float display_value) {
  if (!(display_value < 1.0F)) return kBrightnessBins - 1;
  return static_cast<size_t>(std::max(display_value, 0.0F) * static_cast<float>(kBrightnessBins));
}

void AddPhoto(const brightness::Response& response, const camera::Camera& cached_camera, const image::PixelCache& pixels, size_t photo,
              LightOfPhotos* light) {
  const camera::CornerRadius radius(cached_camera);
  double before = 0.0, after = 0.0, values = 0.0;
  for (int row = 0; row < kGrid; ++row) {
    for (int column = 0; column < kGrid; ++column) {
      const int x = (2 * column + 1) * cached_camera.width / (2 * kGrid), y = (2 * row + 1) * cached_camera.height / (2 * kGrid);
      uint8_t rgb[3];
      const size_t pixel = static_cast<size_t>(y) * static_cast<size_t>(cached_camera.width) + static_cast<size_t>(x);
      if (!pixels.Pixel(photo, pixel, rgb)) continue;
      const std::array<float, 3> log_gain = response.LogGain(photo, radius.Squared({x + 0.5, y + 0.5}));
      const float log_shading = response.LogShading(photo, {(static_cast<float>(x) + 0.5F) / static_cast<float>(cached_camera.width),
                                                            (static_cast<float>(y) + 0.5F) / static_cast<float>(cached_camera.height)});
      float shown_before = 0.0F, shown_after = 0.0F;
      for (size_t c = 0; c < 3; ++c) {
        const float display = static_cast<float>(rgb[c]) / 255.0F;
        const float recorded = image::LinearFromSrgb(display);
        const float at_reference = recorded * std::exp(-log_gain[c] - log_shading);
        before += static_cast<double>(recorded);
        after += static_cast<double>(at_reference);
        shown_before += display / 3.0F;
        shown_after += image::SrgbFromLinear(at_reference) / 3.0F;
      }
      values += 3.0;
      light->before[BinOf(shown_before)] += 1.0;
      light->after[BinOf(shown_after)] += 1.0;
    }
  }
  // A black photo has no exposure.
  if (!(before > 0.0)) return;
  light->before_stops.push_back(std::log2(before / values));
  light->after_stops.push_back(std::log2(after / values));
}

double SpreadOf(const std::vector<double>& values) {
  if (values.size() < 2) return kNotMeasured;
  const auto n = static_cast<double>(values.size());
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  double squares = 0.0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  return std::sqrt(squares / n);
}

BrightnessHistogram Shares(BrightnessHistogram counts) {
  const double total = std::accumulate(counts.begin(), counts.end(), 0.0);
  for (double& count : counts) count /= std::max(total, 1.0);
  return counts;
}

std::vector<VignettingCurve> VignettingOfCameras(const std::vector<float>& vignetting) {
  if (std::all_of(vignetting.begin(), vignetting.end(), [](float f) { return f == 0.0F; })) return {};
  std::vector<VignettingCurve> curves;
  for (size_t at = 0; at + 3 <= vignetting.size(); at += 3) {
    brightness::Response one = brightness::Response::Neutral(1, 1);
    std::copy_n(vignetting.begin() + static_cast<std::ptrdiff_t>(at), 3, one.vignetting.begin());
    VignettingCurve& curve = curves.emplace_back();
    for (size_t i = 0; i < curve.size(); ++i) {
      const float radius = static_cast<float>(i) / static_cast<float>(curve.size() - 1);
      curve[i] = std::exp(static_cast<double>(one.LogVignetting(0, radius * radius)));
    }
  }
  return curves;
}

// Rows of columns.
std::vector<std::vector<float>> ShadingRows(const brightness::ShadingGrid& grid, const std::vector<float>& stops) {
  std::vector<std::vector<float>> rows;
  for (auto row = stops.begin(); row != stops.end(); row += grid.columns) rows.emplace_back(row, row + grid.columns);
  return rows;
}

std::string LuminanceSentence(const scene::SceneInfo& info) {
  if (!info.luminance.On()) return "";
  const std::string target = FormatFixed(info.luminance.target, 2);
  const std::string omega = FormatFixed(info.luminance_state.mean_log_gain / std::numbers::ln2, 2, "stops");
  if (info.luminance.mode == brightness::LuminanceMode::kUnder) {
    return fmt::format(
        "The survey as a whole is too dark. The scene at normal exposure is brightened to a mean display value of {}; a learned concealing field "
        "darkens it to what the photos recorded (mean \xCE\xA9 {}).",
        target, omega);
  }
  return fmt::format(
      "The survey as a whole is too bright. A learned concealing field darkens what the photos recorded (mean \xCE\xA9 {}), so that the scene at "
      "normal exposure has a mean display value of {}.",
      omega, target);
}

}  // namespace

BrightnessReport CollectBrightness(const scene::SceneInfo& info, const survey::Survey& survey, const image::PixelCache& pixels) {
  BrightnessReport report;
  const brightness::Response& response = info.response;
  if (response.photos() != survey.photos.size() || survey.photos.empty()) return report;
  SKYQUILT_CHECK(pixels.size() == survey.photos.size(), "the pixel cache must have one entry per photo of the survey");
  report.timed = brightness::AllTimed(survey);
  const std::vector<brightness::CapturedPhoto> captured = brightness::CapturedPhotos(survey);
  std::vector<size_t> order(captured.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return captured[a].order < captured[b].order; });

  LightOfPhotos light;
  for (const size_t i : order) {
    const survey::Photo& photo = survey.photos[i];
    BrightnessPhoto& entry = report.photos.emplace_back();
    entry.name = photo.name;
    entry.group = captured[i].group;
    entry.time_s = captured[i].order - captured[order.front()].order;
    entry.held_out = photo.is_test;
    entry.exif_stops = std::log2(static_cast<double>(response.exif_gain[i]));
    for (size_t c = 0; c < 3; ++c) entry.learned_stops[c] = static_cast<double>(response.log_gain[3 * i + c]) / std::numbers::ln2;
    if (photo.is_test) continue;
    const size_t knots = response.shading_grid.knots();
    for (size_t k = i * knots; k < (i + 1) * knots; ++k) entry.shading_stops.push_back(response.shading[k] / std::numbers::ln2_v<float>);
    const camera::Camera& camera = survey.cameras[static_cast<size_t>(photo.camera)];
    AddPhoto(response, camera.Resized(pixels.Width(i), pixels.Height(i)), pixels, i, &light);
  }
  report.trust_in_tags = brightness::TagReliability(response, captured);
  report.spread_before_stops = SpreadOf(light.before_stops);
  report.spread_after_stops = SpreadOf(light.after_stops);
  report.histogram_before = Shares(light.before);
  report.histogram_after = Shares(light.after);
  report.vignetting = VignettingOfCameras(response.vignetting);
  report.shading_grid = response.shading_grid;
  report.luminance = LuminanceSentence(info);
  return report;
}

std::string BrightnessJson(const BrightnessReport& report) {
  using Json = nlohmann::ordered_json;
  Json json;
  json["about"] =
      "light recorded by a photo relative to the survey's reference exposure, in stops: exif_stops + learned_stops (red, green, blue). For held-out "
      "photos learned_stops are predicted from the photos before and after. shading_stops: of training photos, with shading: knots of the light "
      "within the photo, rows from the top. vignetting: per camera, factor on light at 0, 0.1 ... 1 of the distance "
      "from the principal point to the farthest corner";
  json["trust_in_tags"] = base::NumberOrNull(report.trust_in_tags);
  json["spread_before_stops"] = base::NumberOrNull(report.spread_before_stops);
  json["spread_after_stops"] = base::NumberOrNull(report.spread_after_stops);
  json["vignetting"] = report.vignetting;
  json["photos"] = Json::array();
  for (const BrightnessPhoto& photo : report.photos) {
    json["photos"].push_back({{"name", photo.name},
                              {"held_out", photo.held_out},
                              {"exif_stops", base::NumberOrNull(photo.exif_stops)},
                              {"learned_stops", photo.learned_stops}});
    if (!photo.shading_stops.empty()) json["photos"].back()["shading_stops"] = ShadingRows(report.shading_grid, photo.shading_stops);
  }
  return base::JsonText(json, 1) + "\n";
}

double ExposureStops(const brightness::Response& response, size_t photo) {
  double sum = 0.0;
  for (const float log_gain : response.LogGain(photo)) sum += static_cast<double>(log_gain);
  return sum / (3.0 * std::numbers::ln2);
}

std::vector<int> ChooseViews(const scene::SceneInfo& info, const survey::Survey& survey, const std::vector<int>& held_out) {
  if (held_out.empty() || info.response.photos() != survey.photos.size()) return {};
  const auto stops = [&](int photo) { return ExposureStops(info.response, static_cast<size_t>(photo)); };
  const auto darkest = std::min_element(held_out.begin(), held_out.end(), [&](int a, int b) { return stops(a) < stops(b); });
  const auto brightest = std::max_element(held_out.begin(), held_out.end(), [&](int a, int b) { return stops(a) < stops(b); });
  std::vector<int> views;
  if (std::abs(stops(*darkest)) > kOffStops) views.push_back(*darkest);
  if (brightest != darkest && std::abs(stops(*brightest)) > kOffStops) views.push_back(*brightest);
  if (!views.empty()) return views;
  return {std::abs(stops(*darkest)) > std::abs(stops(*brightest)) ? *darkest : *brightest};
}

}  // namespace skyquilt::evaluate::page
