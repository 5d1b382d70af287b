// What was done about exposure differences between the photos: the facts behind the report's section "Brightness".
// Exposures in stops (log2 of linear light) relative to the reference exposure: 0 at the reference, 1 twice its light.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "core/image/image.h"
#include "core/image/pixel_cache.h"
#include "core/scene/scene.h"
#include "core/survey/survey.h"
#include "evaluate/metrics.h"

namespace skyquilt::evaluate {

struct BrightnessPhoto {
  std::string name;
  int group = 0;        // flight and camera: light and settings of another are unrelated
  double time_s = 0.0;  // seconds since the first photo, >= 0; place in the survey when not all photos have a time
  bool held_out = false;
  double exif_stops = 0.0;                                // from the tags
  std::array<double, 3> learned_stops = {0.0, 0.0, 0.0};  // on top, per colour; predicted for held-out photos
};

// Pictures of one held-out photo; paths relative to the page.
struct BrightnessView {
  std::string name;
  double stops = 0.0;                   // its exposure
  std::string photo, recorded, normal;  // as taken; the scene as this photo recorded it; the scene at normal exposure
  int width = 0;                        // pixels
  int height = 0;
};

constexpr size_t kBrightnessBins = 64;
// Shares of pixels over display values in [0, 1], mean of the three colours; sum 1, or all 0 when no pixel counts.
using BrightnessHistogram = std::array<double, kBrightnessBins>;
// Share of light at 0, 0.1 ... 1 of the way from the principal point to the farthest corner, > 0; 1 at the principal point.
using VignettingCurve = std::array<double, 11>;

struct BrightnessReport {
  std::vector<BrightnessPhoto> photos;  // in order of capture
  bool timed = false;                   // all photos have a time
  double trust_in_tags = 1.0;           // in [0, 1], see core/brightness/predict_gains.h
  // Standard deviation over the training photos of log2 of their mean linear light; NaN for fewer than two.
  double spread_before_stops = kNotMeasured;  // as recorded
  double spread_after_stops = kNotMeasured;   // divided by their gains
  BrightnessHistogram histogram_before = {};  // over the training photos, as recorded
  BrightnessHistogram histogram_after = {};   // brought to reference exposure; the last bin holds all that is brighter than white
  std::vector<VignettingCurve> vignetting;    // per camera; empty when none falls off
  std::string luminance;                      // a sentence about concealing field; empty without
  std::vector<BrightnessView> views;          // darkest-exposed first

  bool Empty() const { return photos.empty(); }
};

// All but the views, from a grid of pixels of each training photo. Empty when the scene does not know the photos' brightness.
BrightnessReport CollectBrightness(const scene::SceneInfo& info, const survey::Survey& survey, const image::PixelCache& pixels);
// report/brightness.json, for other programs: every photo's gains in stops, the cameras' vignetting, the spreads and the trust in the tags. UTF-8.
std::string BrightnessJson(const BrightnessReport& report);
// A photo's exposure by tags and learned gains together, mean over the three colours, at the principal point, where nothing falls off.
double ExposureStops(const brightness::Response& response, size_t photo);
// Which of the held-out photos to show: the darkest- and the brightest-exposed if they are off the reference by more than 0.15 stops; when
// neither is, the one that is farthest off. Empty when held_out is, or when the scene does not know the photos' brightness.
std::vector<int> ChooseViews(const scene::SceneInfo& info, const survey::Survey& survey, const std::vector<int>& held_out);

// Rendered colours as a picture. colors: row-major, width * height.
image::Image8 PictureOf(std::span<const render::RayColor> colors, int width, int height);

}  // namespace skyquilt::evaluate
