#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "app/commands/describe.h"
#include "app/commands/describe_number.h"
#include "core/base/errors.h"
#include "core/checkpoint/archive.h"
#include "core/checkpoint/digest.h"
#include "core/scene/scene_file.h"

namespace skyquilt::app {
namespace {

using Json = nlohmann::ordered_json;

template <typename T>
void AddContent(const std::vector<T>& values, Json* entry) {
  checkpoint::Digest digest;
  digest.Update({reinterpret_cast<const uint8_t*>(values.data()), values.size() * sizeof(T)});
  (*entry)["xxh64"] = fmt::format("{:016x}", digest.Value());
  T low = std::numeric_limits<T>::max();
  T high = std::numeric_limits<T>::lowest();
  size_t n_bad = 0;
  for (const T value : values) {
    if constexpr (std::is_floating_point_v<T>) {
      if (!std::isfinite(value)) {
        ++n_bad;
        continue;
      }
    }
    low = std::min(low, value);
    high = std::max(high, value);
  }
  if (values.size() > n_bad) {
    (*entry)["min"] = low;
    (*entry)["max"] = high;
  }
  if (n_bad > 0) (*entry)["not_finite"] = n_bad;
}

// The reader has no function for the type of an attribute, so text, whole number and number are tried in turn.
Json Attribute(const checkpoint::ArchiveReader& archive, const std::string& name) {
  try {
    return archive.StringAttribute(name);
  } catch (const base::InputError&) {
  }
  try {
    return archive.IntAttribute(name);
  } catch (const base::InputError&) {
  }
  return archive.DoubleAttribute(name);
}

}  // namespace

nlohmann::ordered_json DescribeScales(const checkpoint::ArchiveReader& scene) {
  const scene::Scales scales = scene::GetScales(scene);
  if (!scales.Cones()) return {{"samples", "points: sharp at the photos' own scale"}};
  return {{"samples", "cones"},
          {"positions", scales.multisample},
          {"finest_m_per_pixel", RoundSignificant(scales.footprint_min_m)},
          {"coarsest_m_per_pixel", RoundSignificant(scales.footprint_max_m)}};
}

nlohmann::ordered_json DescribeArchive(const std::filesystem::path& file) {
  const checkpoint::ArchiveReader archive(file);
  Json json;
  json["what"] = archive.kind();
  json["version"] = archive.version();
  json["bytes"] = std::filesystem::file_size(file);
  if (archive.kind() == scene::kSceneKind) {
    json["accuracy"] = DescribeAccuracy(scene::GetAccuracy(archive));
    json["scales"] = DescribeScales(archive);
  }
  Json attributes = Json::object();
  for (const std::string& name : archive.AttributeNames()) attributes[name] = Attribute(archive, name);
  json["attributes"] = attributes;
  Json arrays = Json::array();
  for (const std::string& name : archive.Names()) {
    const std::string type = archive.TypeName(name);
    Json entry = {{"name", name}, {"type", type}, {"shape", archive.Shape(name)}};
    if (type == "float32") AddContent(archive.Floats(name), &entry);
    if (type == "float64") AddContent(archive.Doubles(name), &entry);
    if (type == "int64") AddContent(archive.Ints(name), &entry);
    if (type == "uint8") AddContent(archive.Bytes(name), &entry);
    arrays.push_back(entry);
  }
  json["arrays"] = arrays;
  return json;
}

}  // namespace skyquilt::app
