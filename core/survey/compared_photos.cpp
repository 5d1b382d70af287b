#include "core/survey/compared_photos.h"

#include <nlohmann/json.hpp>
#include <stdexcept>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"

namespace skyquilt::survey {
namespace {

constexpr const char* kComparedFormat = "skyquilt compared photos";
constexpr int kComparedVersion = 1;

double ShareFromJson(const nlohmann::json& value) {
  const auto share = value.get<double>();
  if (!(share >= 0.0 && share <= 1.0)) throw std::invalid_argument("has a share that is not between 0 and 1");
  return share;
}

std::filesystem::path TableFile(const std::filesystem::path& folder) {
  return folder / "movers.json";
}

}  // namespace

void SaveComparedPhotos(const ComparedPhotos& photos, const std::filesystem::path& folder) {
  nlohmann::ordered_json value = {{"format", kComparedFormat},   {"version", kComparedVersion}, {"movers", photos.movers},
                                  {"prefer", photos.prefer},     {"compared", photos.compared}, {"moved", photos.moved},
                                  {"replaced", photos.replaced}, {"unclear", photos.unclear},   {"photos", nlohmann::ordered_json::array()}};
  for (const ComparedPhoto& photo : photos.photos) {
    value["photos"].push_back({{"photo", photo.photo}, {"look", photo.look}, {"rejected", photo.rejected}});
  }
  base::RequireWritableFolder(folder);
  base::WriteFileAtomically(TableFile(folder), base::JsonText(value, 1) + "\n");
}

std::optional<ComparedPhotos> LoadComparedPhotos(const std::filesystem::path& folder) {
  const std::filesystem::path file = TableFile(folder);
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) return std::nullopt;
  const std::string fix = "Train again with --restart";
  try {
    const nlohmann::json value = base::ParseJson(base::ReadFile(file));
    if (value.value("format", "") != kComparedFormat) throw std::invalid_argument("is no table of compared photos");
    if (value.value("version", 0) != kComparedVersion) throw std::invalid_argument("was written by another version of skyquilt");
    ComparedPhotos photos{.movers = value.at("movers").get<std::string>(),
                          .prefer = value.at("prefer").get<std::string>(),
                          .compared = ShareFromJson(value.at("compared")),
                          .moved = ShareFromJson(value.at("moved")),
                          .replaced = ShareFromJson(value.at("replaced")),
                          .unclear = value.at("unclear").get<bool>()};
    for (const nlohmann::json& photo : value.at("photos")) {
      photos.photos.push_back({.photo = photo.at("photo").get<std::string>(),
                               .look = photo.at("look").get<std::string>(),
                               .rejected = ShareFromJson(photo.at("rejected"))});
    }
    return photos;
  } catch (const nlohmann::json::exception& error) {
    throw base::InputError(file, std::string("is damaged (") + error.what() + ")", fix);
  } catch (const std::invalid_argument& error) {
    throw base::InputError(file, error.what(), fix);
  }
}

}  // namespace skyquilt::survey
