#include "coordinator/stages/product_area.h"

#include <Eigen/Geometry>
#include <utility>
#include <vector>

#include "core/base/order_statistics.h"
#include "core/gis/area_without.h"
#include "core/survey/made_masks.h"
#include "core/survey/survey.h"

namespace skyquilt::coordinator {
namespace {

constexpr double kBeyond_m = 100.0;  // and the size of the survey, on each side

// A rectangle on the map that is wider than all products.
gis::MapExtent WidestArea(const survey::Survey& survey, const gis::MapProjection& projection) {
  Eigen::AlignedBox3d all;
  for (const survey::Photo& photo : survey.photos) all.extend(photo.cam_from_enu.OriginInSource());
  for (const survey::SparsePoint& point : survey.points) {
    if (point.x_in_enu.allFinite()) all.extend(point.x_in_enu);
  }
  const Eigen::Vector3d beyond = Eigen::Vector3d(1.0, 1.0, 0.0) * (all.sizes().maxCoeff() + kBeyond_m);
  return gis::ProjectedExtent(all.min() - beyond, all.max() + beyond, projection);
}

}  // namespace

products::ProductOptions OptionsOfProducts(const Pipeline& pipeline) {
  products::ProductOptions options = pipeline.settings.products;
  const std::filesystem::path folder = pipeline.project.SurveyFolder();
  const std::optional<survey::MadeMasks> masks = survey::LoadMadeMasks(folder);
  if (!masks || masks->ground_rings.empty()) return options;
  const survey::Survey survey = survey::LoadSurvey(folder);
  gis::MapGrid grid;
  grid.georeferenced = survey.georeferenced;
  if (survey.georeferenced) grid.zone = geo::UtmZoneOf(survey.origin);
  const gis::MapProjection projection(survey.origin, grid);
  std::vector<double> z;
  for (const survey::SparsePoint& point : survey.points) {
    if (point.x_in_enu.allFinite()) z.push_back(point.x_in_enu.z());
  }
  const double ground_z = z.empty() ? 0.0 : base::Median(std::move(z));
  std::vector<std::vector<Eigen::Vector2d>> rings;
  for (const std::vector<Eigen::Vector2d>& ring : masks->ground_rings) {
    std::vector<Eigen::Vector2d>& on_map = rings.emplace_back();
    for (const Eigen::Vector2d& point : ring) on_map.push_back(projection.EastingNorthing({point.x(), point.y(), ground_z}));
  }
  std::optional<gis::Boundary> given;
  if (!options.boundary.empty()) given = gis::Boundary::Read(options.boundary, grid.georeferenced, grid.zone);
  const std::filesystem::path file = survey::MadeMasksFolder(folder) / "product_area.geojson";
  gis::WriteAreaWithout(given, WidestArea(survey, projection), gis::Boundary(std::move(rings)), grid.georeferenced, grid.zone, file);
  options.boundary = file.string();
  return options;
}

}  // namespace skyquilt::coordinator
