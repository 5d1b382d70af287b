// Whose look a scene has when its fields were trained with codes of photos (worker/step/appearance_codes.h): that of one photo or folder, or between
// several, by a weighted mean of their codes. Without a name a scene has the mean look, code 0.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace skyquilt::merge {

struct LookPart {
  std::string name;  // of a photo, or of a folder when photos of a folder share a code
  double weight = 1.0;
};

// Reads "sun_10", or "sun_10:0.25,sun_20:0.75". A weight is after the last colon; without one it is 1. Empty text: nothing. Throws base::UsageError
// that names merge.look, for parts without a name, for weights that are no number >= 0, and when all are 0.
std::vector<LookPart> ParseLook(const std::string& text);

// The sum of weight times code over the parts, divided by the sum of the weights, of the field in a checkpoint. The code of photos that this field
// was never taught by is that of the mean look. Throws base::UsageError when the checkpoint has no codes or none of a name, base::InputError when it
// is damaged.
std::vector<float> CodeOfLook(const std::vector<LookPart>& look, const std::filesystem::path& checkpoint);

}  // namespace skyquilt::merge
