#include "products/point_preview.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/base/order_statistics.h"
#include "core/base/text.h"
#include "core/gis/map_projection.h"
#include "core/scene/point_heights.h"
#include "core/survey/seen_ground.h"
#include "products/map_area.h"
#include "products/photo_map/photo_choice.h"
#include "products/photo_map/photo_map.h"

namespace skyquilt::products {
namespace {

constexpr int kSurfaceStep = 4;     // cells of the map in one of the surface, along an axis
constexpr int kChoicePlaces = 100;  // per side of the area, for which few photos are chosen from many
constexpr size_t kNamedPhotos = 3;

// What the photos show, in the form that maps are planned with.
scene::SceneInfo InfoOf(const survey::Survey& survey, const Eigen::AlignedBox2d& area, const scene::HeightMap& heights) {
  scene::SceneInfo info;
  info.origin = survey.origin;
  info.georeferenced = survey.georeferenced;
  info.accuracy = survey.fit.accuracy;
  const auto [low, high] = std::minmax_element(heights.heights().begin(), heights.heights().end());
  const double room = 0.01 * area.sizes().maxCoeff();  // level ground has some height, too
  info.min_enu = {area.min().x(), area.min().y(), *low - room};
  info.max_enu = {area.max().x(), area.max().y(), *high + room};
  return info;
}

struct FlownAt {
  double gsd_m;     // median of the photos
  double height_m;  // the same, above the ground
};

// False when no camera is above the ground.
bool FindFlownAt(const survey::Survey& survey, double ground_z, FlownAt* flown) {
  std::vector<double> gsd_m, heights_m;
  for (const survey::Photo& photo : survey.photos) {
    const double height_m = photo.cam_from_enu.OriginInSource().z() - ground_z;
    if (!(height_m > 0.0)) continue;
    heights_m.push_back(height_m);
    gsd_m.push_back(camera::GroundSamplingDistance(survey.cameras[static_cast<size_t>(photo.camera)], height_m));
  }
  if (heights_m.empty()) return false;
  *flown = {base::Median(gsd_m), base::Median(heights_m)};
  return true;
}

// The surface on a grid with larger cells than the map, which heights between sparse points do not fill with detail anyhow.
HeightGrid SurfaceOf(const gis::MapGrid& map, const gis::MapProjection& projection, const scene::HeightMap& heights) {
  gis::MapGrid grid = map;
  grid.resolution_m *= kSurfaceStep;
  grid.width = (map.width + kSurfaceStep - 1) / kSurfaceStep;
  grid.height = (map.height + kSurfaceStep - 1) / kSurfaceStep;
  std::vector<float> heights_m(grid.size());
  for (int row = 0; row < grid.height; ++row) {
    for (int column = 0; column < grid.width; ++column) {
      const gis::MapProjection::VerticalLine line = projection.VerticalLineAt(grid.CellCentre(column, row));
      const double s = (heights.At(line.start_enu.x(), line.start_enu.y()) - line.start_enu.z()) / line.down_enu.z();
      heights_m[grid.Index(column, row)] = static_cast<float>(projection.start_height_m() - s);
    }
  }
  return {grid, std::move(heights_m)};
}

// Photos that look down on the ground and are read: an even choice of many.
std::vector<char> ChoosePhotosFor(const survey::Survey& survey, const scene::HeightMap& heights, const Eigen::AlignedBox2d& area, double height_m,
                                  base::ThreadPool& threads) {
  std::vector<Eigen::Vector3d> places;
  for (int row = 0; row < kChoicePlaces; ++row) {
    for (int column = 0; column < kChoicePlaces; ++column) {
      const Eigen::Vector2d at = area.min() + Eigen::Vector2d(column + 0.5, row + 0.5).cwiseProduct(area.sizes()) / kChoicePlaces;
      places.emplace_back(at.x(), at.y(), heights.At(at.x(), at.y()));
    }
  }
  return ChooseFewPhotos(survey, places, kMostPhotoPixels, height_m, threads);
}

void WarnOfUnreadable(const std::vector<std::string>& failures, int chosen) {
  if (failures.empty()) return;
  const size_t named = std::min(failures.size(), kNamedPhotos);
  base::LogWarning("the preview of the orthophoto does without {} of {} photos, which cannot be read:\n  {}{}", failures.size(), chosen,
                   base::Join(std::span(failures).first(named), "\n  "), named < failures.size() ? "\n  ..." : "");
}

}  // namespace

PointPreview MakePointPreview(const survey::Survey& survey, const ProductOptions& options, const std::filesystem::path& folder,
                              base::ThreadPool& threads) {
  const std::vector<Eigen::Vector3d> points = survey::SteadyPoints(survey);
  if (points.empty()) {
    throw base::InputError(survey.photo_root, "the survey has no sparse points, so the height of its ground is unknown",
                           "The scene and its orthophoto need them, too: give a COLMAP model with points");
  }
  std::vector<double> heights_z;
  for (const Eigen::Vector3d& point : points) heights_z.push_back(point.z());
  const double ground_z = base::Median(heights_z);
  const Eigen::AlignedBox2d area = survey::SeenGround(survey, points, ground_z);
  FlownAt flown{};
  if (area.isEmpty() || !FindFlownAt(survey, ground_z, &flown)) {
    throw base::InputError(survey.photo_root, "no photo looks down on the ground", "Check the poses: the heights of cameras and points must fit");
  }
  const scene::HeightMap heights = scene::HeightsOfPoints(points, area);
  const scene::SceneInfo info = InfoOf(survey, area, heights);
  gis::MapGrid grid = PlanPreviewGrid(info, flown.gsd_m, kMostPreviewCells);
  const std::optional<gis::Boundary> boundary = BoundaryOf(grid, options);
  if (boundary) grid = CropTo(grid, *boundary);

  const gis::MapProjection projection(info.origin, grid);
  const HeightGrid surface = SurfaceOf(grid, projection, heights);
  const std::vector<char> usable = ChoosePhotosFor(survey, heights, area, flown.height_m, threads);
  const std::vector<float> slack_m = SightSlack(surface, threads);
  PhotoMap painter({.survey = survey,
                    .usable = usable,
                    .grid = grid,
                    .projection = projection,
                    .surface = surface,
                    .slack_m = slack_m,
                    .field_rgba = {},
                    .ground_z = ground_z,
                    .flown_height_m = flown.height_m},
                   threads);
  const std::vector<std::string>& failures = painter.failures();
  const auto chosen = static_cast<int>(std::count(usable.begin(), usable.end(), 1));
  PreviewMap map{grid, {}};
  map.rgba.reserve(4 * grid.size());
  std::vector<char> shown(survey.photos.size(), 0);
  PhotoMapRows rows;
  for (int row = 0; row < grid.height; row += PhotoMap::kRows) {
    painter.PaintRows(row, std::min(PhotoMap::kRows, grid.height - row), threads, &rows);
    map.rgba.insert(map.rgba.end(), rows.rgba.begin(), rows.rgba.end());
    for (const uint16_t source : rows.sources) {
      if (source >= kFirstPhotoSource) shown[source - kFirstPhotoSource] = 1;
    }
  }
  const auto n_shown = static_cast<int>(std::count(shown.begin(), shown.end(), 1));
  if (n_shown == 0) {
    throw base::InputError(survey.photo_root, failures.empty() ? "no photo looks down on the ground" : "no photo can be read: " + failures.front(),
                           "Check that the photos are where they were when the survey was prepared");
  }
  WarnOfUnreadable(failures, chosen);
  if (boundary) {
    const std::vector<uint8_t> inside = boundary->Mask(grid);
    for (size_t cell = 0; cell < inside.size(); ++cell) {
      if (inside[cell] == 0) std::fill_n(map.rgba.begin() + static_cast<std::ptrdiff_t>(4 * cell), 4, uint8_t{0});
    }
  }
  const std::filesystem::path picture = WritePreview(info, map, kFromSparsePoints, folder, kPreviewWidth);
  return {picture, grid, map.Filled(), n_shown, static_cast<int>(failures.size())};
}

}  // namespace skyquilt::products
