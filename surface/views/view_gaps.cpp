#include "surface/views/view_gaps.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>

#include "core/base/cancel.h"
#include "core/base/order_statistics.h"

namespace skyquilt::surface {
namespace {

constexpr int64_t kMaxSamples = 150000;
constexpr double kToleranceVoxels = 3.0;
constexpr double kCellOfFootprint = 0.35;  // width of a cell, in widths of a photo's view on the ground
constexpr double kCellOfPicture = 0.7;     // and at most in those of a virtual view, which must show the whole cell
constexpr double kLeastCellVoxels = 4.0;
constexpr double kNotableShare = 0.02;  // of a cell's area that must be weak
constexpr int kNotableSamples = 2;      // a single one may be noise
constexpr double kHalfFieldRad = 30.0 * std::numbers::pi / 180.0;
constexpr double kLeastWidthPx = 16.0, kMostWidthPx = 256.0;
constexpr double kClearance = 0.25;  // above what stands below a virtual camera, in heights above ground
constexpr double kSameSide = 0.5;    // neighbours are photos whose view axes differ by at most 60 degrees
constexpr double kAcross = 0.3;      // of a neighbour's distance that must be across the line of sight for a view to be between the two
constexpr double kLeastTurn = 0.05, kMostTurn = 0.5;  // tangents of the angle by which views beside photos are turned
constexpr double kNewPlace = 0.5;                     // least distance of a virtual camera from all photos, in steps

// Column, row and, where photos look level, layer.
using CellId = std::array<int64_t, 3>;
struct Cell {
  double top_m = -std::numeric_limits<double>::infinity();  // highest surface
  int weak_samples = 0;
  double weak_m2 = 0.0;
  Eigen::Vector3d weak_sum = Eigen::Vector3d::Zero();  // of positions by area
  struct Shown {
    double weak_m2 = 0.0, cosine_m2 = 0.0;  // the latter times the cosines to the normals
  };
  std::map<size_t, Shown> shown;  // by each photo
};
using Cells = std::map<CellId, Cell>;

struct WeakPlace {
  Eigen::Vector3d centre;
  double weak_m2 = 0.0;
  size_t photo = 0;     // which shows most of it
  double cosine = 1.0;  // to its normals, from there
};

// Focal length and size of virtual pictures: pixels as large as those of photos, hence a narrower field where that would be too many.
struct Lens {
  double focal_px = 0.0;
  int width_px = 0;
};

Lens LensLike(const std::vector<ViewPose>& photos) {
  std::vector<double> focal;
  focal.reserve(photos.size());
  for (const ViewPose& pose : photos) focal.push_back(pose.focal_px);
  const double pixels_per_focal = 2.0 * std::tan(kHalfFieldRad);
  Lens lens;
  lens.focal_px = std::max(base::UpperMedian(focal), kLeastWidthPx / pixels_per_focal);
  lens.width_px = static_cast<int>(std::clamp(std::round(lens.focal_px * pixels_per_focal), kLeastWidthPx, kMostWidthPx));
  return lens;
}

// `distance_m`: from which cameras see the surface.
double CellWidth(const std::vector<ViewPose>& photos, const Lens& lens, double distance_m, double voxel_m) {
  std::vector<double> footprint;
  footprint.reserve(photos.size());
  for (const ViewPose& pose : photos) footprint.push_back(pose.width / pose.focal_px * distance_m);
  const double picture = lens.width_px / lens.focal_px * distance_m;
  return std::max(kLeastCellVoxels * voxel_m, std::min(kCellOfFootprint * base::UpperMedian(footprint), kCellOfPicture * picture));
}

CellId CellOf(const Eigen::Vector3d& x, double cell_m, bool in_layers) {
  return {static_cast<int64_t>(std::floor(x.x() / cell_m)), static_cast<int64_t>(std::floor(x.y() / cell_m)),
          in_layers ? static_cast<int64_t>(std::floor(x.z() / cell_m)) : 0};
}

Cells CollectCells(const std::vector<SurfaceSample>& samples, double cell_m, const GapOptions& options) {
  Cells cells;
  for (const SurfaceSample& sample : samples) {
    Cell& cell = cells[CellOf(sample.position, cell_m, options.level)];
    cell.top_m = std::max(cell.top_m, sample.position.z());
    if (sample.views > options.min_views) continue;
    // Each view that sees the surface has its own samples of it.
    const double area_m2 = sample.area_m2 / sample.views;
    ++cell.weak_samples;
    cell.weak_m2 += area_m2;
    cell.weak_sum += area_m2 * sample.position;
    Cell::Shown& shown = cell.shown[sample.view];
    shown.weak_m2 += area_m2;
    shown.cosine_m2 += area_m2 * sample.cosine;
  }
  return cells;
}

std::vector<WeakPlace> WeakPlaces(const Cells& cells, double cell_m) {
  std::vector<WeakPlace> weak;
  for (const auto& [id, cell] : cells) {
    if (cell.weak_samples < kNotableSamples || cell.weak_m2 < kNotableShare * cell_m * cell_m) continue;
    const auto most =
        std::max_element(cell.shown.begin(), cell.shown.end(), [](const auto& a, const auto& b) { return a.second.weak_m2 < b.second.weak_m2; });
    weak.push_back({cell.weak_sum / cell.weak_m2, cell.weak_m2, most->first, most->second.cosine_m2 / most->second.weak_m2});
  }
  // Equally weak ones stay in the order of the cells.
  std::stable_sort(weak.begin(), weak.end(), [](const WeakPlace& a, const WeakPlace& b) { return a.weak_m2 > b.weak_m2; });
  return weak;
}

// The camera at `centre`, raised where it would be inside a building or just above one.
Eigen::Vector3d InFreeSpace(Eigen::Vector3d centre, const Cells& cells, double cell_m, double agl_m) {
  const auto [column, row, layer] = CellOf(centre, cell_m, false);
  for (int64_t x = column - 1; x <= column + 1; ++x) {
    for (int64_t y = row - 1; y <= row + 1; ++y) {
      const auto cell = cells.find({x, y, layer});
      if (cell != cells.end()) centre.z() = std::max(centre.z(), cell->second.top_m + kClearance * agl_m);
    }
  }
  return centre;
}

// Looks from the centre to the target. Up in the picture is the sky, or north in views from straight above.
ViewPose LookAt(const Eigen::Vector3d& centre, const Eigen::Vector3d& target, const Lens& lens) {
  const Eigen::Vector3d forward = (target - centre).normalized();
  Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ());
  right = right.norm() < 1e-6 ? Eigen::Vector3d::UnitX() : right.normalized();
  Eigen::Matrix3d rotation;
  rotation.row(0) = right;
  rotation.row(1) = forward.cross(right);
  rotation.row(2) = forward;
  ViewPose pose;
  pose.width = pose.height = lens.width_px;
  pose.focal_px = lens.focal_px;
  pose.cx = pose.cy = 0.5 * lens.width_px;
  pose.cam_from_enu.rotation = Eigen::Quaterniond(rotation).normalized();
  pose.cam_from_enu.translation = -(pose.cam_from_enu.rotation * centre);
  return pose;
}

// Straight above each place first, then at 45 degrees from north, east, south and west.
std::vector<ViewPose> ViewsFromAbove(const std::vector<WeakPlace>& weak, const Cells& cells, double cell_m, double agl_m, const Lens& lens,
                                     int64_t n_most) {
  const std::array<Eigen::Vector2d, 4> sides = {Eigen::Vector2d(0.0, 1.0), {1.0, 0.0}, {0.0, -1.0}, {-1.0, 0.0}};
  std::vector<ViewPose> views;
  const auto add = [&](const WeakPlace& place, const Eigen::Vector2d& side) {
    if (static_cast<int64_t>(views.size()) >= n_most) return;
    const Eigen::Vector3d offset(side.x() * agl_m, side.y() * agl_m, agl_m);
    views.push_back(LookAt(InFreeSpace(place.centre + offset, cells, cell_m, agl_m), place.centre, lens));
  };
  for (const WeakPlace& place : weak) add(place, Eigen::Vector2d::Zero());
  for (const WeakPlace& place : weak) {
    for (const Eigen::Vector2d& side : sides) add(place, side);
  }
  return views;
}

Eigen::Vector3d AxisOf(const ViewPose& pose) {
  return pose.cam_from_enu.rotation.conjugate() * Eigen::Vector3d::UnitZ();
}

// Cameras beside the photos that show weak places. Nothing tells what is free behind walls and outside rooms, but photos stand in the open, and so do
// cameras a little beside them.
class BesidePhotos {
 public:
  BesidePhotos(const CoarseDepths& photos, double voxel_m) : photos_(photos), tolerance_m_(kToleranceVoxels * voxel_m) {
    for (const ViewPose& pose : photos.poses()) {
      lowest_m_ = std::min(lowest_m_, pose.Centre().z());
      highest_m_ = std::max(highest_m_, pose.Centre().z());
    }
  }

  // Up to four, the one halfway to the nearest neighbour first.
  std::vector<Eigen::Vector3d> Around(const WeakPlace& place) const {
    const ViewPose& photo = photos_.poses()[place.photo];
    const Eigen::Vector3d centre = photo.Centre();
    const Eigen::Vector3d to_place = place.centre - centre;
    const double distance_m = to_place.norm();
    if (!(distance_m > tolerance_m_)) return {};
    const Eigen::Vector3d sight = to_place / distance_m;
    const Eigen::Vector3d to_neighbour = ToNeighbour(place.photo, distance_m);
    const double wanted_m = to_neighbour.norm() > 0.0 ? 0.5 * to_neighbour.norm() : kMostTurn * distance_m;
    // At right angles to the line of sight no step of this length comes nearer to the plane of the place than half of the photo's distance to it.
    const double before_plane_m = 0.5 * distance_m * place.cosine / std::sqrt(std::max(1e-6, 1.0 - place.cosine * place.cosine));
    const double step_m = std::min(std::clamp(wanted_m, kLeastTurn * distance_m, kMostTurn * distance_m), before_plane_m);
    const auto across = [&sight](const Eigen::Vector3d& x) -> Eigen::Vector3d { return x - sight.dot(x) * sight; };
    Eigen::Vector3d along = across(to_neighbour);
    if (!(along.norm() > kAcross * to_neighbour.norm())) along = sight.cross(Eigen::Vector3d::UnitZ());
    if (!(along.norm() > 1e-6)) along = across(Eigen::Vector3d::UnitX());  // straight up or down
    along.normalize();
    const Eigen::Vector3d upwards = sight.cross(along);
    std::vector<Eigen::Vector3d> found;
    for (const Eigen::Vector3d& way : {along, Eigen::Vector3d(-along), upwards, Eigen::Vector3d(-upwards)}) {
      Eigen::Vector3d at = centre + step_m * way;
      // Not into the ground or the ceiling, which photos need not show.
      at.z() = std::clamp(at.z(), lowest_m_, highest_m_);
      if (IsNew(at, step_m) && !IsBehindSurface(at, centre) && IsInSight(place, at)) found.push_back(at);
    }
    return found;
  }

 private:
  // To the nearest photo that looks the same way; 0 when none is nearer than what the photo shows.
  Eigen::Vector3d ToNeighbour(size_t photo, double distance_m) const {
    const Eigen::Vector3d centre = photos_.poses()[photo].Centre(), axis = AxisOf(photos_.poses()[photo]);
    Eigen::Vector3d nearest = Eigen::Vector3d::Zero();
    double nearest_m = distance_m;
    for (const ViewPose& other : photos_.poses()) {
      const Eigen::Vector3d to_other = other.Centre() - centre;
      const double other_m = to_other.norm();
      if (!(other_m > tolerance_m_ && other_m < nearest_m) || AxisOf(other).dot(axis) < kSameSide) continue;
      nearest = to_other;
      nearest_m = other_m;
    }
    return nearest;
  }

  bool IsNew(const Eigen::Vector3d& at, double step_m) const {
    return std::all_of(photos_.poses().begin(), photos_.poses().end(),
                       [&](const ViewPose& pose) { return (pose.Centre() - at).norm() >= kNewPlace * step_m; });
  }

  // Whether `at` is at or behind a surface that a photo shows, unless `open` is behind it too: on the way from there one would pass through it.
  bool IsBehindSurface(const Eigen::Vector3d& at, const Eigen::Vector3d& open) const {
    for (size_t photo = 0; photo < photos_.poses().size(); ++photo) {
      const std::optional<CoarseDepths::Look> look = photos_.LookAtPlace(photo, at);
      if (!look || look->behind_m + look->slack_m < -tolerance_m_) continue;
      const std::optional<CoarseDepths::Look> beside = photos_.LookAtPlace(photo, open);
      if (!beside || beside->behind_m < 0.0) return true;
    }
    return false;
  }

  // Whether the line from `at` to the place passes behind nothing that the place's photo shows; not its end, which is near the surface anyway.
  bool IsInSight(const WeakPlace& place, const Eigen::Vector3d& at) const {
    constexpr int kSteps = 64, kNearEnd = 48;
    for (int i = 1; i <= kNearEnd; ++i) {
      const Eigen::Vector3d x = at + (static_cast<double>(i) / kSteps) * (place.centre - at);
      const std::optional<CoarseDepths::Look> look = photos_.LookAtPlace(place.photo, x);
      if (look && look->behind_m > 0.0) return false;
    }
    return true;
  }

  const CoarseDepths& photos_;
  double tolerance_m_;
  double lowest_m_ = std::numeric_limits<double>::infinity(), highest_m_ = -lowest_m_;
};

std::vector<ViewPose> ViewsBesidePhotos(const std::vector<WeakPlace>& weak, const CoarseDepths& photos, double voxel_m, const Lens& lens,
                                        int64_t n_most) {
  const BesidePhotos beside(photos, voxel_m);
  std::vector<ViewPose> views, others;
  for (const WeakPlace& place : weak) {
    base::ThrowIfCancelled();
    if (static_cast<int64_t>(views.size()) >= n_most) break;
    bool first = true;
    for (const Eigen::Vector3d& centre : beside.Around(place)) {
      (first ? views : others).push_back(LookAt(centre, place.centre, lens));
      first = false;
    }
  }
  const auto rest = std::min(others.size(), static_cast<size_t>(n_most) - views.size());
  views.insert(views.end(), others.begin(), others.begin() + static_cast<std::ptrdiff_t>(rest));
  return views;
}

double MedianDistance(const std::vector<SurfaceSample>& samples, const std::vector<ViewPose>& photos) {
  std::vector<double> distance_m;
  distance_m.reserve(samples.size());
  for (const SurfaceSample& sample : samples) distance_m.push_back((sample.position - photos[sample.view].Centre()).norm());
  return base::UpperMedian(distance_m);
}

}  // namespace

std::vector<ViewPose> PlanGapViews(const CoarseDepths& photos, const GapOptions& options, base::ThreadPool& threads) {
  if (photos.poses().empty() || !(options.level || options.agl_m > 0.0)) return {};
  const Lens lens = LensLike(photos.poses());
  const int64_t n_most = options.budget_rays / (static_cast<int64_t>(lens.width_px) * lens.width_px);
  if (n_most <= 0) return {};
  const std::vector<SurfaceSample> samples = photos.Samples(kMaxSamples, kToleranceVoxels * options.voxel_m, threads);
  if (samples.empty()) return {};
  const double distance_m = options.level ? MedianDistance(samples, photos.poses()) : options.agl_m;
  const double cell_m = CellWidth(photos.poses(), lens, distance_m, options.voxel_m);
  const Cells cells = CollectCells(samples, cell_m, options);
  const std::vector<WeakPlace> weak = WeakPlaces(cells, cell_m);
  return options.level ? ViewsBesidePhotos(weak, photos, options.voxel_m, lens, n_most)
                       : ViewsFromAbove(weak, cells, cell_m, options.agl_m, lens, n_most);
}

}  // namespace skyquilt::surface
