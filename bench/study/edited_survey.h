// Surveys with something extreme about their photos, their size or their place, made from a prepared one.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/survey/survey.h"

namespace skyquilt::bench {

enum class SurveyEdit {
  kNone,
  kBrightPhoto,  // one training photo is recorded ten times brighter
  kBlackPhotos,  // every fourth training photo is black
  kWater,        // the western part of the ground, and with it most of every picture, is saturated blue with glints that change from photo to photo
  kThreePhotos,  // only three neighbouring training photos
  kMillimetres,  // all lengths scaled so that a pixel of the full photos is 1 mm on the ground
  kTenMetres,    // the same with 10 m
  kZoneEdge,     // moved to 180 degrees east, where UTM zones 60 and 1 meet
};

struct NamedEdit {
  SurveyEdit edit;
  const char* name;  // as in options and folders
  const char* what;  // as in tables
};
const std::vector<NamedEdit>& SurveyEdits();

// The edited survey. Photos that change are written to `folder`, the others are linked from there. It has no truth: that of the original is not its
// own. Throws base::InputError when a photo cannot be read or written.
survey::Survey EditSurvey(survey::Survey survey, SurveyEdit edit, const std::filesystem::path& folder);

}  // namespace skyquilt::bench
