// Data of the report's section "Brightness": how brightness differed between the photos and how training corrected it.
// Exposures are in stops (log2 of linear light) relative to the reference exposure: 0 at the reference, 1 for twice its light.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/image/pixel_cache.h"
#include "core/scene/scene.h"
#include "core/survey/survey.h"
#include "evaluate/measured.h"

namespace skyquilt::evaluate::page {

struct BrightnessPhoto {
  std::string name;
  int group = 0;        // flight and camera: brightness is comparable within a group only
  double time_s = 0.0;  // seconds since the first photo, >= 0; index in the survey when not all photos have a time
  bool held_out = false;
  double exif_stops = 0.0;                                // from the tags
  std::array<double, 3> learned_stops = {0.0, 0.0, 0.0};  // added to exif_stops, per colour; predicted for held-out photos
  std::vector<float> shading_stops = {};                  // [row][column] of BrightnessReport::shading_grid; empty for held-out photos
};

// Images of one held-out photo; paths relative to the page.
struct BrightnessView {
  std::string name;
  double stops = 0.0;                   // its exposure
  std::string photo, recorded, normal;  // the photo; the scene rendered at its brightness; the scene at normal exposure
  int width = 0;                        // pixels
  int height = 0;
};

constexpr size_t kBrightnessBins = 64;
// Shares of pixels per display value from 0 to 1 (mean of the three colours). Sum 1, or all 0 when there are no pixels.
using BrightnessHistogram = std::array<double, kBrightnessBins>;
// Factor on light at 0, 0.1 ... 1 of the distance from the principal point to the farthest corner, > 0; 1 at the principal point.
using VignettingCurve = std::array<double, 11>;

struct BrightnessReport {
  std::vector<BrightnessPhoto> photos;  // in order of capture
  bool timed = false;                   // all photos have a time
  double trust_in_tags = 1.0;           // in [0, 1], see core/brightness/predict_gains.h
  // Standard deviation over the training photos of log2 of their mean linear light; NaN for fewer than two.
  double spread_before_stops = kNotMeasured;  // as recorded
  double spread_after_stops = kNotMeasured;   // divided by their gains
  BrightnessHistogram histogram_before = {};  // over the training photos, as recorded
  BrightnessHistogram histogram_after = {};   // corrected to reference exposure; the last bin has all pixels brighter than white
  std::vector<VignettingCurve> vignetting;    // per camera; empty when no camera has any
  brightness::ShadingGrid shading_grid;       // off: none was learned
  std::string luminance;                      // a sentence about the concealing field; empty when there is none
  std::vector<BrightnessView> views;          // darkest first

  bool Empty() const { return photos.empty(); }
};

// Everything but the views, from a grid of pixels of each training photo. Empty when the scene has no gains of the photos.
BrightnessReport CollectBrightness(const scene::SceneInfo& info, const survey::Survey& survey, const image::PixelCache& pixels);
// Text of report/brightness.json, for other programs: gains of every photo in stops, vignetting of the cameras, spreads, trust in the tags. UTF-8.
std::string BrightnessJson(const BrightnessReport& report);
// A photo's exposure in stops by tags and learned gains together: mean of the three colours, without vignetting.
double ExposureStops(const brightness::Response& response, size_t photo);
// Chooses the held-out photos to show: the darkest and the brightest, each if it is more than 0.15 stops from the reference; if neither is, the one
// farthest from it. Empty when held_out is empty or the scene has no gains of the photos.
std::vector<int> ChooseViews(const scene::SceneInfo& info, const survey::Survey& survey, const std::vector<int>& held_out);

}  // namespace skyquilt::evaluate::page
