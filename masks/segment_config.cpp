#include "masks/segment_config.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/base/checked_json.h"
#include "core/base/errors.h"
#include "core/base/json_document.h"
#include "core/base/json_object.h"
#include "core/base/text.h"
#include "core/config/options.h"
#include "core/config/toml_json.h"

namespace skyquilt::masks {
namespace {

constexpr const char* kFixConfig = "docs/input.md explains the keys, with an example";
constexpr int64_t kMostInput_px = 8192, kMostPhoto_px = 32768, kMostDilate_px = 256;
constexpr size_t kMostClasses = 1000, kMostName = 100;

const std::vector<std::string> kKeys = {"input_width", "input_height", "photo_width", "overlap", "scale",     "mean",
                                        "std",         "channels",     "classes",     "ignore",  "threshold", "dilate_px"};

int IntegerOr(base::JsonObject& object, const std::string& key, int64_t min, int64_t max, int fallback) {
  return object.Find(key) ? static_cast<int>(object.Integer(key, min, max)) : fallback;
}

void ReadThree(base::JsonObject& object, const std::string& key, std::array<double, 3>* values) {
  if (object.Find(key)) object.Numbers(key, 1e6, *values);
}

void ReadClasses(base::JsonObject& object, SegmentConfig* config) {
  config->classes = object.Lines("classes", kMostClasses, kMostName);
  if (config->classes.empty()) object.Refuse("classes", "must list the names of the classes that the network gives, in their order");
  config->ignored.assign(config->classes.size(), 0);
  const std::vector<std::string> names = object.Lines("ignore", kMostClasses, kMostName);
  if (names.empty()) object.Refuse("ignore", "must list the names of one or more classes that are ignored");
  for (const std::string& name : names) {
    const auto found = std::find(config->classes.begin(), config->classes.end(), name);
    if (found == config->classes.end()) {
      object.Refuse("ignore", "has '" + name + "', which is none of the classes: " + base::Join(config->classes));
    }
    config->ignored[static_cast<size_t>(found - config->classes.begin())] = 1;
  }
}

SegmentConfig FromObject(base::JsonObject object) {
  SegmentConfig config;
  config.input_width = static_cast<int>(object.Integer("input_width", 1, kMostInput_px));
  config.input_height = static_cast<int>(object.Integer("input_height", 1, kMostInput_px));
  config.photo_width = IntegerOr(object, "photo_width", 1, kMostPhoto_px, config.input_width);
  config.overlap = IntegerOr(object, "overlap", 0, std::min(config.input_width, config.input_height) / 2, 0);
  if (object.Find("scale")) config.scale = object.Number("scale", 1e-9, 1e9);
  ReadThree(object, "mean", &config.mean);
  ReadThree(object, "std", &config.std);
  if (std::any_of(config.std.begin(), config.std.end(), [](double std) { return !(std > 0.0); })) object.Refuse("std", "must be above 0");
  if (object.Find("channels")) config.bgr = object.OneOf("channels", {"rgb", "bgr"}) == 1;
  ReadClasses(object, &config);
  if (object.Find("threshold")) config.threshold = object.Number("threshold", -1e6, 1e6);
  config.dilate_px = IntegerOr(object, "dilate_px", 0, kMostDilate_px, 0);
  const std::vector<std::string> rest = object.Rest();
  if (!rest.empty()) {
    const std::string nearest = config::Nearest(rest.front(), kKeys);
    object.Refuse(rest.front(), "is no key of this file" + (nearest.empty() ? "; keys: " + base::Join(kKeys) : "; did you mean '" + nearest + "'?"));
  }
  return config;
}

}  // namespace

std::vector<std::string> SegmentConfig::IgnoredClasses() const {
  std::vector<std::string> names;
  for (size_t i = 0; i < classes.size(); ++i) {
    if (ignored[i] != 0) names.push_back(classes[i]);
  }
  return names;
}

SegmentConfig ReadSegmentConfig(const std::filesystem::path& file) {
  if (base::LowerCase(file.extension().string()) == ".json") {
    const base::JsonDocument document(file, kFixConfig);
    return FromObject(base::JsonObject(document.Root()));
  }
  const nlohmann::json value = config::TomlAsJson(file);
  try {
    return FromObject(base::JsonObject(base::JsonValue(value)));
  } catch (const base::Refused& refused) {
    throw base::InputError(file, refused.what(), kFixConfig);
  }
}

}  // namespace skyquilt::masks
