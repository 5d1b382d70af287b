// Photos of one survey differ in exposure. From their EXIF tags and the options in [brightness], this decides which corrections are known and which
// ones training must learn.
#pragma once

#include <string>
#include <vector>

#include "core/brightness/brightness_options.h"
#include "core/brightness/luminance.h"
#include "core/brightness/response_learner.h"
#include "core/image/pixel_cache.h"
#include "core/survey/survey.h"

namespace skyquilt::coordinator {

struct BrightnessPlan {
  brightness::Response response;     // as far as the tags tell
  brightness::LearnerOptions learn;  // what is learned while the context trains
  std::string remark;                // for the log: what was found and what is done about it; may be empty
};

// Photos without exposure tags learn their gains even when the correction is "exif" alone: nothing else could align them.
// `earlier`: of the photos that the survey had before others were added behind them; they keep it, and the added ones are fitted to them, so that
// what was trained before goes on looking like what is trained now. Null: none.
BrightnessPlan PlanBrightness(const survey::Survey& survey, const brightness::BrightnessOptions& options,
                              const brightness::Response* earlier = nullptr);

// Mean brightness and fraction of clipped pixels of the training photos, from a grid of 64 x 64 pixels in each.
brightness::BrightnessStatistics MeasureBrightness(const survey::Survey& survey, const image::PixelCache& pixels);
// For the log: the statistics, and whether the survey is treated as under- or over-exposed.
std::string LuminanceRemark(const brightness::Luminance& luminance, const brightness::BrightnessStatistics& statistics);

}  // namespace skyquilt::coordinator
