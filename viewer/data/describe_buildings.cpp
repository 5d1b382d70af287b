#include "viewer/data/describe_buildings.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <system_error>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "viewer/data/opening.h"

namespace skyquilt::viewer::opening {
namespace {

using Json = nlohmann::json;

constexpr const char* kTable = "buildings.json";
// About 10,000 buildings, all of which a browser reads at once.
constexpr std::uintmax_t kLargestTable = 64U << 20U;

struct BuildingFile {
  const char* name;
  const char* type;
};
constexpr std::array<BuildingFile, 6> kBuildingFiles = {{{kTable, "application/json"},
                                                         {"buildings.csv", "text/csv; charset=utf-8"},
                                                         {"buildings.city.json", "application/city+json"},
                                                         {"buildings.gpkg", "application/geopackage+sqlite3"},
                                                         {"buildings.glb", "model/gltf-binary"},
                                                         {"buildings.dxf", "image/vnd.dxf"}}};

bool IsPlainFile(const std::filesystem::path& file) {
  std::error_code error;
  return std::filesystem::symlink_status(file, error).type() == std::filesystem::file_type::regular;
}

// The number of buildings in the table; nothing when it is damaged or of another version. Only its head is kept in memory.
std::optional<int64_t> CountBuildings(const std::filesystem::path& file) {
  int64_t count = 0;
  std::string list;  // the member of the table that is being read
  const auto keep = [&](int depth, Json::parse_event_t event, const Json& parsed) {
    if (depth == 1 && event == Json::parse_event_t::key) list = parsed.get<std::string>();
    if (depth != 2 || event != Json::parse_event_t::object_start) return true;
    if (list == "buildings") ++count;
    return false;
  };
  Json head;
  try {
    head = Json::parse(base::ReadFile(file), keep, false);
  } catch (const base::InputError&) {
    return {};
  }
  const bool known = head.is_object() && head.value("format", Json()) == "skyquilt buildings" && head.value("version", Json()) == 1 &&
                     head.contains("buildings") && head["buildings"].is_array();
  return known ? std::optional(count) : std::nullopt;
}

// "buildings/<name>" of every other file that is there.
Json ListDownloads(const OpenedProject& opened) {
  Json files = Json::array();
  for (const BuildingFile& file : kBuildingFiles) {
    if (file.name != std::string(kTable) && opened.buildings.contains(file.name)) files.push_back(std::string("buildings/") + file.name);
  }
  return files;
}

}  // namespace

void DescribeBuildings(OpenedProject* opened) {
  opened->description["buildings"] = nullptr;
  const std::filesystem::path table = opened->project.BuildingsFile();
  const std::string advice = Command(*opened, "buildings");
  const auto miss = [&](const std::string& reason, const std::string& help) { AddMissing(opened, "buildings", reason, help); };
  if (!IsPlainFile(table)) {
    if (IsUnfinished(*opened, "buildings")) {
      miss("they are still being looked for, or that was interrupted", "Wait for it, or go on with `" + advice + "`");
    } else if (!opened->description["surface"].is_object()) {
      miss("they are found in the surface, which is not made yet", Command(*opened, "surface") + "\n" + advice);
    } else {
      miss("they are not looked for yet", advice);
    }
    return;
  }
  std::error_code error;
  if (std::filesystem::file_size(table, error) > kLargestTable || error) {
    miss("buildings/buildings.json is too large to be shown here", "Open buildings/buildings.gpkg in a GIS");
    return;
  }
  const std::optional<int64_t> count = CountBuildings(table);
  if (!count) {
    miss("buildings/buildings.json is damaged or of another version", advice + kRestart);
    return;
  }
  for (const BuildingFile& file : kBuildingFiles) {
    if (IsPlainFile(opened->project.BuildingsFolder() / file.name)) opened->buildings.insert(file.name);
  }
  opened->description["buildings"] = {{"count", *count}, {"url", std::string("buildings/") + kTable}, {"files", ListDownloads(*opened)}};
}

std::string BuildingFileType(const std::string& name) {
  for (const BuildingFile& file : kBuildingFiles) {
    if (name == file.name) return file.type;
  }
  return "application/octet-stream";
}

}  // namespace skyquilt::viewer::opening
