#include "core/survey/directions.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"

namespace skyquilt::survey {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kAbout =
    "Directions of walls, roof edges and streets, found from straight lines in the photos. yaw_deg: counter-clockwise from east, 0 to 90, as the "
    "four "
    "directions of a right angle are alike; share: of the length of all lines; cells: squares of the ground where one direction prevails";

}  // namespace

double YawDifference(double a_deg, double b_deg) {
  return std::remainder(a_deg - b_deg, 90.0);
}

int DominantDirections::ModeNear(double yaw_deg) const {
  int best = -1;
  for (size_t i = 0; i < modes.size(); ++i) {
    const double off = std::abs(YawDifference(yaw_deg, modes[i].yaw_deg));
    if (off > kModeReach_deg) continue;
    if (best < 0 || off < std::abs(YawDifference(yaw_deg, modes[static_cast<size_t>(best)].yaw_deg))) best = static_cast<int>(i);
  }
  return best;
}

std::optional<double> DominantDirections::YawAt(const Eigen::Vector2d& place_enu) const {
  for (const YawCell& cell : cells) {
    const Eigen::Array2d inside = (place_enu - cell.min_enu).array();
    if ((inside < 0.0).any() || (inside >= cell_m).any()) continue;
    return cell.share > 0.5 ? std::optional(modes[static_cast<size_t>(cell.mode)].yaw_deg) : std::nullopt;
  }
  return std::nullopt;
}

void SaveDirections(const DominantDirections& directions, const std::filesystem::path& file) {
  Json json = {{"about", kAbout},
               {"up", {0, 0, 1}},
               {"photos", directions.photos},
               {"lines", directions.lines},
               {"length_m", directions.length_m},
               {"concentration", directions.concentration},
               {"modes", Json::array()},
               {"cell_m", directions.cell_m},
               {"cells", Json::array()},
               {"histogram_per_degree", directions.histogram}};
  for (const YawMode& mode : directions.modes) {
    json["modes"].push_back(
        {{"yaw_deg", mode.yaw_deg}, {"sigma_deg", mode.sigma_deg}, {"spread_deg", mode.spread_deg}, {"share", mode.share}, {"lines", mode.lines}});
  }
  for (const YawCell& cell : directions.cells) {
    json["cells"].push_back({{"min_enu", {cell.min_enu.x(), cell.min_enu.y()}}, {"mode", cell.mode}, {"share", cell.share}});
  }
  base::WriteFileAtomically(file, base::JsonText(json, 1) + "\n");
}

DominantDirections LoadDirections(const std::filesystem::path& file) {
  DominantDirections directions;
  if (!std::filesystem::exists(file)) return directions;
  try {
    const Json json = Json::parse(base::ReadFile(file));
    directions.photos = json.at("photos");
    directions.lines = json.at("lines");
    directions.length_m = json.at("length_m");
    directions.concentration = json.at("concentration");
    directions.cell_m = json.at("cell_m");
    directions.histogram = json.at("histogram_per_degree").get<std::array<double, 90>>();
    for (const Json& mode : json.at("modes")) {
      directions.modes.push_back({mode.at("yaw_deg"), mode.at("sigma_deg"), mode.at("spread_deg"), mode.at("share"), mode.at("lines")});
    }
    for (const Json& cell : json.at("cells")) {
      const int mode = cell.at("mode");
      if (mode < 0 || static_cast<size_t>(mode) >= directions.modes.size())
        throw base::InputError(file, "names a direction that it does not have", "Run 'skyquilt prepare' again");
      directions.cells.push_back(
          {Eigen::Vector2d(cell.at("min_enu").at(0).get<double>(), cell.at("min_enu").at(1).get<double>()), mode, cell.at("share")});
    }
  } catch (const nlohmann::json::exception& error) {
    throw base::InputError(file, std::string("cannot be read (") + error.what() + ")", "Run 'skyquilt prepare' again");
  }
  return directions;
}

}  // namespace skyquilt::survey
