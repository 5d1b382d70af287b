// `info` for text files: photo positions, tables, configurations.
#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "app/commands/describe.h"
#include "core/base/errors.h"
#include "core/base/file.h"

namespace skyquilt::app {
namespace {

using Json = nlohmann::ordered_json;

std::vector<std::string> Cells(const std::string& line) {
  std::vector<std::string> cells;
  std::stringstream stream(line);
  for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
  return cells;
}

}  // namespace

nlohmann::ordered_json DescribeCameras(const std::filesystem::path& file) {
  const Json content = Json::parse(base::ReadFile(file), nullptr, false);
  const auto wrong = [&] { return base::InputError(file, "is not GeoJSON of photo positions", "Make it again with 'skyquilt prepare'"); };
  if (!content.is_object() || !content.contains("features") || !content["features"].is_array()) throw wrong();
  Json photos = Json::array();
  int64_t held_out = 0;
  try {
    for (const Json& feature : content["features"]) {
      const Json& at = feature.at("geometry").at("coordinates");
      const Json& properties = feature.at("properties");
      held_out += properties.value("test", false) ? 1 : 0;
      photos.push_back({{"name", properties.at("name")},
                        {"longitude_deg", at.at(0)},
                        {"latitude_deg", at.at(1)},
                        {"agl_m", properties.value("agl_m", Json())},
                        {"gps_residual_m", properties.value("gps_residual_m", Json())}});
    }
  } catch (const Json::exception&) {
    throw wrong();
  }
  return {{"what", "photo positions"},
          {"photos", photos.size()},
          {"held_out", held_out},
          {"accuracy", content.value("skyquilt:accuracy", Json())},
          {"positions", photos}};
}

nlohmann::ordered_json DescribeTable(const std::filesystem::path& file) {
  std::istringstream lines(base::ReadFile(file));
  std::string line, last;
  std::getline(lines, line);
  const std::vector<std::string> columns = Cells(line);
  if (columns.size() < 2) throw base::InputError(file, "has no row of column names", "Give a table that skyquilt wrote");
  int64_t rows = 0;
  while (std::getline(lines, line)) {
    if (line.empty()) continue;
    ++rows;
    last = line;
  }
  const std::vector<std::string> values = Cells(last);
  Json end = Json::object();
  for (size_t i = 0; i < std::min(columns.size(), values.size()); ++i) end[columns[i]] = values[i];
  return {{"what", "table"}, {"rows", rows}, {"columns", columns}, {"last_row", end}};
}

nlohmann::ordered_json DescribeConfiguration(const std::filesystem::path& file) {
  return {{"what", "configuration"}, {"text", base::ReadFile(file)}};
}

}  // namespace skyquilt::app
