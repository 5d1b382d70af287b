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
#include "products/map_area.h"
#include "products/map_rays.h"
#include "products/photo_choice.h"
#include "products/photo_mosaic.h"
#include "products/sparse_surface.h"

namespace skyquilt::products {
namespace {

// Cells between the places at which the photos are compared and chosen.
constexpr int kNodeStep = 8;
constexpr int kChoiceStep = 4;  // nodes between the places for which few photos are chosen from many
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

// Places on the surface, at the centres of the cells of a map.
class SurfaceCells {
 public:
  SurfaceCells(const scene::SceneInfo& info, const gis::MapGrid& grid, const scene::HeightMap& heights)
      : rays_(info, grid), width_(grid.width), heights_(heights) {}

  // One place per column; NaN outside the scene's box.
  void MakeRow(int row, std::vector<Eigen::Vector3d>* places_enu) const {
    MapRays row_rays;
    rays_.MakeRow(row, &row_rays);
    places_enu->assign(static_cast<size_t>(width_), Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()));
    for (size_t i = 0; i < row_rays.rays.size(); ++i) {
      const render::Ray& ray = row_rays.rays[i];
      const double z = heights_.At(ray.origin_enu.x(), ray.origin_enu.y());
      (*places_enu)[static_cast<size_t>(row_rays.column[i])] = ray.origin_enu + (z - ray.origin_enu.z()) / ray.direction_enu.z() * ray.direction_enu;
    }
  }

 private:
  MapRayGenerator rays_;
  int width_;
  const scene::HeightMap& heights_;
};

// The lattice of places at which photos are compared: every kNodeStep-th cell, and the last.
struct Nodes {
  int columns = 0, rows = 0;
  std::vector<Eigen::Vector3d> places_enu;  // row-major
  std::vector<BestViews> views;

  size_t Index(int row, int column) const { return static_cast<size_t>(row) * static_cast<size_t>(columns) + static_cast<size_t>(column); }
};

Nodes MakeNodes(const gis::MapGrid& grid, const SurfaceCells& cells, base::ThreadPool& threads) {
  Nodes nodes;
  nodes.columns = (grid.width - 1) / kNodeStep + 2;
  nodes.rows = (grid.height - 1) / kNodeStep + 2;
  nodes.places_enu.resize(nodes.Index(nodes.rows, 0));
  threads.ParallelFor(nodes.rows, [&](int64_t task, int /*thread*/) {
    const int row = static_cast<int>(task);
    std::vector<Eigen::Vector3d> places;
    cells.MakeRow(std::min(row * kNodeStep, grid.height - 1), &places);
    for (int column = 0; column < nodes.columns; ++column) {
      nodes.places_enu[nodes.Index(row, column)] = places[static_cast<size_t>(std::min(column * kNodeStep, grid.width - 1))];
    }
  });
  return nodes;
}

std::vector<char> ChoosePhotosFor(const survey::Survey& survey, const Nodes& nodes, double height_m, base::ThreadPool& threads) {
  std::vector<Eigen::Vector3d> places;
  for (int row = 0; row < nodes.rows; row += kChoiceStep) {
    for (int column = 0; column < nodes.columns; column += kChoiceStep) places.push_back(nodes.places_enu[nodes.Index(row, column)]);
  }
  return ChooseFewPhotos(survey, places, kMostPhotoPixels, height_m, threads);
}

// Photos that are among the best of some place.
std::vector<char> PhotosInUse(const std::vector<BestViews>& views, size_t photos) {
  std::vector<char> used(photos, 0);
  for (const BestViews& best : views) {
    for (const int32_t photo : best) {
      if (photo >= 0) used[static_cast<size_t>(photo)] = 1;
    }
  }
  return used;
}

// The photos that see the corners of a square between four nodes.
std::vector<int32_t> PhotosAround(const Nodes& nodes, int row, int column) {
  std::vector<int32_t> around;
  for (const int r : {row, row + 1}) {
    for (const int c : {column, column + 1}) {
      for (const int32_t photo : nodes.views[nodes.Index(r, c)]) {
        if (photo >= 0 && std::find(around.begin(), around.end(), photo) == around.end()) around.push_back(photo);
      }
    }
  }
  return around;
}

// inside: 0 for cells that are left out; empty: none is.
PreviewMap Paint(const gis::MapGrid& grid, const SurfaceCells& cells, const Nodes& nodes, const MosaicPainter& painter,
                 const std::vector<uint8_t>& inside, base::ThreadPool& threads) {
  PreviewMap map{grid, std::vector<uint8_t>(4 * grid.size(), 0)};
  threads.ParallelFor(nodes.rows - 1, [&](int64_t task, int /*thread*/) {
    base::ThrowIfCancelled();
    const int band = static_cast<int>(task);
    std::vector<std::vector<int32_t>> around;
    for (int column = 0; column + 1 < nodes.columns; ++column) around.push_back(PhotosAround(nodes, band, column));
    std::vector<Eigen::Vector3d> places;
    for (int row = band * kNodeStep; row < std::min((band + 1) * kNodeStep, grid.height); ++row) {
      cells.MakeRow(row, &places);
      for (int column = 0; column < grid.width; ++column) {
        const Eigen::Vector3d& place = places[static_cast<size_t>(column)];
        const size_t cell = grid.Index(column, row);
        if (!place.allFinite() || (!inside.empty() && inside[cell] == 0)) continue;
        const std::array<uint8_t, 4> color = painter.ColorAt(place, around[static_cast<size_t>(column / kNodeStep)]);
        std::copy(color.begin(), color.end(), map.rgba.begin() + static_cast<std::ptrdiff_t>(4 * cell));
      }
    }
  });
  return map;
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
  const std::vector<Eigen::Vector3d> points = SteadyPoints(survey);
  if (points.empty()) {
    throw base::InputError(survey.photo_root, "the survey has no sparse points, so the height of its ground is unknown",
                           "The scene and its orthophoto need them, too: give a COLMAP model with points");
  }
  std::vector<double> heights_z;
  for (const Eigen::Vector3d& point : points) heights_z.push_back(point.z());
  const double ground_z = base::Median(heights_z);
  const Eigen::AlignedBox2d area = SeenGround(survey, points, ground_z);
  FlownAt flown{};
  if (area.isEmpty() || !FindFlownAt(survey, ground_z, &flown)) {
    throw base::InputError(survey.photo_root, "no photo looks down on the ground", "Check the poses: the heights of cameras and points must fit");
  }
  const scene::HeightMap heights = HeightsOfPoints(points, area);
  const scene::SceneInfo info = InfoOf(survey, area, heights);
  gis::MapGrid grid = PlanPreviewGrid(info, flown.gsd_m, kMostPreviewCells);
  const std::optional<gis::Boundary> boundary = BoundaryOf(grid, options);
  if (boundary) grid = CropTo(grid, *boundary);

  const SurfaceCells cells(info, grid, heights);
  Nodes nodes = MakeNodes(grid, cells, threads);
  std::vector<char> usable = ChoosePhotosFor(survey, nodes, flown.height_m, threads);
  nodes.views = FindBestViews(survey, nodes.places_enu, usable, flown.height_m, threads);
  usable = PhotosInUse(nodes.views, survey.photos.size());
  const auto chosen = static_cast<int>(std::count(usable.begin(), usable.end(), 1));
  std::vector<std::string> failures;
  std::vector<MosaicPhoto> photos = ReadMosaicPhotos(survey, usable, ground_z, grid.resolution_m, threads, &failures);
  if (chosen == static_cast<int>(failures.size())) {
    throw base::InputError(survey.photo_root, failures.empty() ? "no photo looks down on the ground" : "no photo can be read: " + failures.front(),
                           "Check that the photos are where they were when the survey was prepared");
  }
  WarnOfUnreadable(failures, chosen);
  EqualiseBrightness(nodes.places_enu, nodes.views, &photos);
  const std::vector<uint8_t> inside = boundary ? boundary->Mask(grid) : std::vector<uint8_t>();
  const PreviewMap map = Paint(grid, cells, nodes, MosaicPainter(photos, flown.height_m), inside, threads);
  const std::filesystem::path picture = WritePreview(info, map, kFromSparsePoints, folder, kPreviewWidth);
  return {picture, grid, map.Filled(), chosen - static_cast<int>(failures.size()), static_cast<int>(failures.size())};
}

}  // namespace skyquilt::products
