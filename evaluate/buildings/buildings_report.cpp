#include "evaluate/buildings/buildings_report.h"

#include <algorithm>
#include <numeric>

#include "surface/map_frame.h"

namespace skyquilt::evaluate::buildings {
namespace {

// As buildings/files names them.
constexpr const char* kBuildingFiles[] = {"buildings.city.json", "buildings.gpkg", "buildings.csv",
                                          "buildings.dxf",       "buildings.glb",  "buildings.json"};

void AddMapHeights(const skyquilt::surface::MapFrame& frame, BuildingsReport* report) {
  // Measures that a scale bar has stretched are no longer heights in the survey's frame.
  if (!frame.georeferenced() || report->compared.set.scale != 1.0) return;
  report->vertical = frame.VerticalName();
  for (const Building& building : report->compared.set.buildings) {
    const Eigen::Vector2d middle = Centroid(building.footprint);
    const Eigen::Vector3d on_ground(middle.x(), middle.y(), building.shape.ground_z);
    report->map_height_m.push_back(frame.MapFromEnu(on_ground).z() - on_ground.z());
  }
}

}  // namespace

std::optional<BuildingsReport> CollectBuildings(const EvaluateInput& input) {
  std::optional<ComparedBuildings> compared = LoadBuildingsOf(input.project_folder, *input.survey);
  if (!compared) return std::nullopt;
  BuildingsReport report;
  report.compared = *std::move(compared);
  AddMapHeights(skyquilt::surface::MapFrame(input.scene->info(), input.vertical), &report);
  std::error_code ignored;
  for (const char* file : kBuildingFiles) {
    if (std::filesystem::is_regular_file(input.project_folder / "buildings" / file, ignored)) report.files.emplace_back(file);
  }
  return report;
}

std::vector<size_t> BuildingsWithCards(const BuildingSet& set) {
  std::vector<double> area_m2;
  for (const Building& building : set.buildings) area_m2.push_back(Area(building.footprint));
  std::vector<size_t> order(set.buildings.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return area_m2[a] > area_m2[b]; });
  order.resize(std::min(order.size(), kBuildingCards));
  return order;
}

}  // namespace skyquilt::evaluate::buildings
