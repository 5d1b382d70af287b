#include "prepare/input/masks/named_masks.h"

#include <nlohmann/json.hpp>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/log.h"
#include "prepare/models/input_model.h"
#include "prepare/models/photo_names.h"

namespace skyquilt::prepare::input {
namespace {

// Empty for what is not there or not a text.
std::string TextOf(const nlohmann::json& frame, const char* key) {
  if (!frame.is_object()) return "";
  const auto found = frame.find(key);
  return found != frame.end() && found->is_string() ? found->get<std::string>() : std::string();
}

}  // namespace

std::map<std::string, std::filesystem::path> NamedMasks(const std::filesystem::path& photo_root, const std::vector<std::string>& photos,
                                                        const std::vector<std::filesystem::path>& transforms) {
  std::map<std::string, std::filesystem::path> masks;
  if (transforms.empty()) return masks;
  const models::ModelPhotos finder(photo_root, photos);
  for (const std::filesystem::path& file : transforms) {
    nlohmann::json json;
    try {
      json = base::TryParseJson(base::ReadFile(file));
    } catch (const base::InputError&) {
      continue;
    }
    if (!json.is_object() || !json.contains("frames") || !json["frames"].is_array()) continue;
    size_t n_missing = 0;
    std::string missing;
    for (const nlohmann::json& frame : json["frames"]) {
      const std::string photo = TextOf(frame, "file_path"), mask = TextOf(frame, "mask_path");
      if (photo.empty() || mask.empty()) continue;
      const std::filesystem::path path = file.parent_path() / models::PhotoNames::Cleaned(mask);
      std::error_code ignored;
      if (std::filesystem::is_regular_file(path, ignored)) {
        masks.emplace(finder.Resolve(photo, file.parent_path()), path);
      } else {
        ++n_missing;
        missing = path.string();
      }
    }
    if (n_missing > 0) base::LogWarning("{}: {} masks that it names are not there (for instance {})", file.string(), n_missing, missing);
  }
  return masks;
}

}  // namespace skyquilt::prepare::input
