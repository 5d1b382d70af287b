#include "core/survey/made_masks.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"

namespace skyquilt::survey {
namespace {

constexpr const char* kMasksFormat = "skyquilt masks";
constexpr int kMasksVersion = 1;

using Rings = std::vector<std::vector<Eigen::Vector2d>>;

nlohmann::ordered_json RingsToJson(const Rings& rings) {
  auto list = nlohmann::ordered_json::array();
  for (const std::vector<Eigen::Vector2d>& ring : rings) {
    auto points = nlohmann::ordered_json::array();
    for (const Eigen::Vector2d& point : ring) points.push_back({point.x(), point.y()});
    list.push_back(std::move(points));
  }
  return list;
}

Rings RingsFromJson(const nlohmann::json& list) {
  Rings rings;
  for (const nlohmann::json& points : list) {
    std::vector<Eigen::Vector2d>& ring = rings.emplace_back();
    for (const nlohmann::json& point : points) {
      ring.emplace_back(point.at(0).get<double>(), point.at(1).get<double>());
      if (!ring.back().allFinite()) throw std::invalid_argument("has ignored ground with a corner that is not finite");
    }
  }
  return rings;
}

}  // namespace

nlohmann::ordered_json ToJson(const MadeMask& mask) {
  return {{"photo", mask.photo},     {"file", mask.file},   {"look", mask.look},       {"pixels", mask.pixels},
          {"ignored", mask.ignored}, {"given", mask.given}, {"network", mask.network}, {"ground", mask.ground}};
}

MadeMask MadeMaskFromJson(const nlohmann::json& value) {
  MadeMask mask{.photo = value.at("photo").get<std::string>(),
                .file = value.at("file").get<std::string>(),
                .look = value.at("look").get<std::string>(),
                .pixels = value.at("pixels").get<int64_t>(),
                .ignored = value.at("ignored").get<int64_t>(),
                .given = value.at("given").get<int64_t>(),
                .network = value.at("network").get<int64_t>(),
                .ground = value.at("ground").get<int64_t>()};
  for (const int64_t part : {mask.ignored, mask.given, mask.network, mask.ground}) {
    if (part < 0 || part > mask.pixels) throw std::invalid_argument("ignores more pixels of '" + mask.photo + "' than it has");
  }
  return mask;
}

std::filesystem::path MadeMasksFolder(const std::filesystem::path& survey_folder) {
  return survey_folder / "made_masks";
}

std::filesystem::path MadeMasksFile(const std::filesystem::path& survey_folder) {
  return MadeMasksFolder(survey_folder) / "masks.json";
}

void SaveMadeMasks(const MadeMasks& masks, const std::filesystem::path& survey_folder) {
  nlohmann::ordered_json value = {{"format", kMasksFormat},
                                  {"version", kMasksVersion},
                                  {"network", masks.network},
                                  {"classes", masks.classes},
                                  {"ground", masks.ground},
                                  {"ground_rings", RingsToJson(masks.ground_rings)},
                                  {"photos", nlohmann::ordered_json::array()}};
  for (const MadeMask& mask : masks.photos) value["photos"].push_back(ToJson(mask));
  base::WriteFileAtomically(MadeMasksFile(survey_folder), base::JsonText(value, 1) + "\n");
}

std::optional<MadeMasks> LoadMadeMasks(const std::filesystem::path& survey_folder) {
  const std::filesystem::path file = MadeMasksFile(survey_folder);
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) return std::nullopt;
  const std::string fix = "Make the masks again: skyquilt masks PROJECT --restart, which also removes what was made with them";
  try {
    const nlohmann::json value = base::ParseJson(base::ReadFile(file));
    if (value.value("format", "") != kMasksFormat) throw std::invalid_argument("is no table of masks");
    if (value.value("version", 0) != kMasksVersion) throw std::invalid_argument("was written by another version of skyquilt");
    MadeMasks masks{.network = value.at("network").get<std::string>(),
                    .classes = value.at("classes").get<std::vector<std::string>>(),
                    .ground = value.at("ground").get<std::string>(),
                    .ground_rings = RingsFromJson(value.at("ground_rings")),
                    .photos = {}};
    for (const nlohmann::json& photo : value.at("photos")) masks.photos.push_back(MadeMaskFromJson(photo));
    return masks;
  } catch (const nlohmann::json::exception& error) {
    throw base::InputError(file, std::string("is damaged (") + error.what() + ")", fix);
  } catch (const std::invalid_argument& error) {
    throw base::InputError(file, error.what(), fix);
  }
}

}  // namespace skyquilt::survey
