#include "tour/export/project_file.h"

#include <nlohmann/json.hpp>

#include "core/base/errors.h"
#include "core/base/json_text.h"

namespace skyquilt::tour {
namespace {

using Json = nlohmann::json;

}  // namespace

std::string ExportedProjectJson(const std::string& project_json, const ExportedFiles& files) {
  Json json = Json::parse(project_json, nullptr, false);
  SKYQUILT_CHECK(json.is_object(), "project.json is no object");
  json["revision"] = 0;
  for (const char* absent : {"scene", "before", "points", "contours", "metrics"}) json[absent] = nullptr;
  json["missing"] = Json::array();
  json["tiles"] = files.tiles ? Json("tiles/tileset.json") : Json(nullptr);
  json["terrain"] = files.terrain ? Json("terrain.bin") : Json(nullptr);
  json["orthophoto"] = files.orthophoto ? Json("orthophoto.jpg") : Json(nullptr);
  if (!files.buildings || !json["buildings"].is_object()) json["buildings"] = nullptr;
  if (json["buildings"].is_object()) json["buildings"]["files"] = Json::array();
  if (!json["photos"].is_array()) json["photos"] = Json::array();
  for (Json& photo : json["photos"]) photo["available"] = false;
  return base::JsonText(json);
}

}  // namespace skyquilt::tour
