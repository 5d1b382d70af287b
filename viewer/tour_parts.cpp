#include "viewer/tour_parts.h"

#include <nlohmann/json.hpp>

#include "core/base/json_text.h"
#include "viewer/assets.h"
#include "viewer/data/map_files.h"
#include "viewer/data/open_project.h"

namespace skyquilt::viewer {

tour::ExportParts TourParts(const coordinator::Project& project, const std::filesystem::path& front_end, const std::string& made_by) {
  tour::ExportParts parts;
  parts.page = TourPage(front_end);
  parts.made_by = made_by;
  const OpenedProject opened = OpenProject(project);
  parts.project_json = base::JsonText(opened.description);
  if (!opened.tiles.empty()) parts.tiles = project.SurfaceFolder() / "tiles";
  if (!opened.buildings.empty()) parts.buildings = project.BuildingsFile();
  const std::filesystem::path dsm = project.ProductsFolder() / "dsm.tif", orthophoto = project.ProductsFolder() / "orthophoto.tif";
  if (opened.terrain)
    parts.terrain = [dsm, origin = opened.origin, georeferenced = opened.georeferenced] {
      return TerrainFile(dsm, SurveyFrame(origin, georeferenced));
    };
  if (opened.orthophoto) parts.orthophoto = [orthophoto, dsm] { return OrthophotoFile(orthophoto, dsm); };
  return parts;
}

}  // namespace skyquilt::viewer
