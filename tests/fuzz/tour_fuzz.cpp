// Tours, and the models and pictures that are uploaded for them.
#include <optional>

#include "core/base/checked_json.h"
#include "core/base/json_text.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/tour/format/sample_assets.h"
#include "tests/tour/format/sample_tour.h"
#include "tour/format/asset_check.h"
#include "tour/format/read_tour.h"
#include "tour/format/write_tour.h"

namespace skyquilt::fuzz {

std::vector<std::string> Seeds() {
  return {
      base::JsonText(tour::SampleTour()),
      tour::SampleTourWith([](nlohmann::json& json) { json["version"] = 2; }),
      tour::SampleGlb(),
      tour::SampleGlb([](nlohmann::json& json) {
        json["accessors"][0]["sparse"] = {{"count", 2}, {"indices", {{"bufferView", 1}, {"componentType", 5123}}}, {"values", {{"bufferView", 0}}}};
      }),
      tour::SamplePng(),
      tour::SampleJpg()};
}

void Feed(const std::string& bytes) {
  std::optional<tour::Tour> read;
  try {
    read = tour::ParseTour(bytes);
  } catch (const base::Refused&) {
  }
  if (read) {
    const std::string text = tour::FormatTour(*read);
    if (text.size() <= tour::kMaxTourBytes) tour::ParseTour(text);  // what may be saved can be read again
  }
  try {
    tour::ReadTourToPlay(bytes, [](const std::string& name, uint64_t) { return name.ends_with("glb"); });
  } catch (const base::Refused&) {
  }
  for (const tour::AssetType type : {tour::AssetType::kGlb, tour::AssetType::kPng, tour::AssetType::kJpg}) {
    try {
      tour::CheckAsset(type, tour::BytesOf(bytes));
    } catch (const base::Refused&) {
    }
  }
}

}  // namespace skyquilt::fuzz
