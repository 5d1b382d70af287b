// From a survey's tags and the options to what training is to do about brightness.
#pragma once

#include <string>
#include <vector>

#include "core/brightness/luminance.h"
#include "core/brightness/options.h"
#include "core/brightness/response_learner.h"
#include "core/image/pixel_cache.h"
#include "core/survey/survey.h"

namespace skyquilt::coordinator {

struct BrightnessPlan {
  brightness::Response response;     // as far as the tags know it
  brightness::LearnerOptions learn;  // what the context has to find out
  std::string remark;                // for people: what was found and what is done; empty when there is nothing to say
};

// Photos without exposure tags learn their gains even when the correction is "exif" alone: nothing else could align them.
BrightnessPlan PlanBrightness(const survey::Survey& survey, const brightness::BrightnessOptions& options);

// What the training photos look like as recorded, from some of their pixels.
brightness::BrightnessStatistics MeasureBrightness(const survey::Survey& survey, const image::PixelCache& pixels);
// For people: what the statistics say and whether concealing field is looked for.
std::string LuminanceRemark(const brightness::Luminance& luminance, const brightness::BrightnessStatistics& statistics);

}  // namespace skyquilt::coordinator
