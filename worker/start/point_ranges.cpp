#include "worker/start/point_ranges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "core/base/order_statistics.h"
#include "core/survey/view_kind.h"

namespace skyquilt::worker {
namespace {

constexpr float kInfiniteDistance = std::numeric_limits<float>::infinity();
constexpr size_t kTiles = static_cast<size_t>(kTileRows) * kTileColumns;
// Surfaces without points may be nearer than the points around them, and farther.
constexpr float kNearSlack = 0.8F, kFarSlack = 1.25F;
// Neighbourhoods in tiles on each side, in which points are looked for one after another.
constexpr std::array<int, 3> kReaches = {2, 4, 8};
constexpr double kNearestShare = 0.02;  // of a photo's points: so many may be wrong
// Sky is at least this high above the horizon (sine), this bright, and blue at least by this part of red. Ceilings under lamps are reddish.
constexpr double kAboveHorizon = 0.03;
constexpr float kSkyBrightness = 0.45F, kSkyBlue = 1.0F;
// Largest differences of a colour: to the tile above it, and to a tile of sky beside it where points are close.
constexpr float kSkyStep = 0.12F, kSameSkyStep = 0.05F;
constexpr int kSkyRim = 3;  // tiles from the open sky within which single pixels may show it
// Where such a share of the sky has points above it, it is the walls of a room.
constexpr double kIndoors = 0.25;
constexpr double kAboveSky = 0.03;   // such points are higher by at least this, in the sine of the elevation
constexpr size_t kDirections = 180;  // all round
constexpr size_t kMostPointsAbove = 20'000;
// Nothing is nearer to a camera, in any direction, than this share of the distance of the nearest point but a few, which may be wrong.
constexpr double kFreeBall = 0.8;
constexpr size_t kWrongPoints = 4;
// Points around a camera, on the map, that show how low the floor is and how high the ceiling: a tenth of all, and at least so many.
constexpr size_t kAroundShare = 10, kLeastAround = 64;
constexpr double kInfinite = std::numeric_limits<double>::infinity();

size_t IndexOf(int row, int column) {
  return static_cast<size_t>(row) * kTileColumns + static_cast<size_t>(column);
}

}  // namespace

bool PointRanges::Range::Known() const {
  return std::isfinite(far);
}

PointRanges::PointRanges(const survey::Survey& survey, const RaySource& source, const std::vector<int>& photos, base::ThreadPool& threads) {
  if (survey.tracks.Empty() || !survey::LooksLevel(survey, photos)) return;
  first_.assign(survey.photos.size(), -1);
  std::vector<int> training;
  for (const int photo : photos) {
    if (survey.photos[static_cast<size_t>(photo)].is_test) continue;
    first_[static_cast<size_t>(photo)] = static_cast<int32_t>(training.size() * kTiles);
    training.push_back(photo);
  }
  ranges_.resize(training.size() * kTiles);
  for (size_t photo = 0; photo < survey.photos.size(); ++photo) {
    cameras_.push_back(&source.CameraOf(static_cast<int>(photo)));
    cam_from_enu_.push_back(survey.photos[photo].cam_from_enu);
  }
  std::vector<std::vector<uint32_t>> observed(survey.photos.size());
  for (size_t point = 0; point < survey.points.size(); ++point) {
    for (const int32_t photo : survey.tracks.PhotosOf(point)) {
      if (first_[static_cast<size_t>(photo)] >= 0) observed[static_cast<size_t>(photo)].push_back(static_cast<uint32_t>(point));
    }
  }
  threads.ParallelFor(static_cast<int64_t>(training.size()), [&](int64_t i, int) {
    const int photo = training[static_cast<size_t>(i)];
    FindSky(source, photo, FindRanges(survey, source, photo, observed[static_cast<size_t>(photo)]));
  });
  FindFreeBalls(survey, training, threads);
  if (IsIndoors(survey, source, training, threads)) {
    for (Range& range : ranges_) range.open_sky = 0;
  } else {
    threads.ParallelFor(static_cast<int64_t>(training.size()), [&](int64_t i, int) { FindOpenSky(training[static_cast<size_t>(i)]); });
  }
  if (std::ranges::any_of(ranges_, &Range::Sky)) {
    for (FreeBall& ball : free_balls_) ball.ceiling_m = kInfinite;
  }
  threads.ParallelFor(static_cast<int64_t>(training.size()), [&](int64_t i, int) { KeepFloorAndCeiling(source, training[static_cast<size_t>(i)]); });
}

std::vector<PointRanges::Points> PointRanges::FindRanges(const survey::Survey& survey, const RaySource& source, int photo,
                                                         const std::vector<uint32_t>& observed) {
  const geo::Rigid3d& cam_from_enu = cam_from_enu_[static_cast<size_t>(photo)];
  const camera::Camera& camera = source.CameraOf(photo);
  std::array<std::array<float, 2>, kTiles> own;
  own.fill({kInfiniteDistance, 0.0F});
  std::vector<float> distances;
  for (const uint32_t point : observed) {
    const Eigen::Vector3d x_in_cam = cam_from_enu * survey.points[point].x_in_enu;
    const auto pixel = camera.ImgFromCam(x_in_cam);
    if (!pixel || !(pixel->minCoeff() >= 0.0 && pixel->x() < camera.width && pixel->y() < camera.height)) continue;
    const auto distance = static_cast<float>(x_in_cam.norm());
    auto& [nearest, farthest] =
        own[IndexOf(static_cast<int>(pixel->y() * kTileRows / camera.height), static_cast<int>(pixel->x() * kTileColumns / camera.width))];
    nearest = std::min(nearest, distance);
    farthest = std::max(farthest, distance);
    distances.push_back(distance);
  }
  std::vector<Points> points(kTiles);
  const float near = distances.empty() ? 0.0F : kNearSlack * base::NearestRankQuantile(distances, kNearestShare);
  for (int row = 0; row < kTileRows; ++row) {
    for (int column = 0; column < kTileColumns; ++column) {
      Range& range = ranges_[static_cast<size_t>(first_[static_cast<size_t>(photo)]) + IndexOf(row, column)];
      range = {.near = near, .nearest = kInfiniteDistance, .farthest = 0.0F, .far = kInfiniteDistance};
      bool close = false;
      for (const int reach : kReaches) {
        for (int y = std::max(0, row - reach); y <= std::min(kTileRows - 1, row + reach); ++y) {
          for (int x = std::max(0, column - reach); x <= std::min(kTileColumns - 1, column + reach); ++x) {
            range.nearest = std::min(range.nearest, own[IndexOf(y, x)][0]);
            range.farthest = std::max(range.farthest, own[IndexOf(y, x)][1]);
          }
        }
        if (range.farthest <= 0.0F) continue;
        close = reach == kReaches.front();
        range.near = kNearSlack * range.nearest;
        range.far = kFarSlack * range.farthest;
        break;
      }
      const bool has_own = own[IndexOf(row, column)][1] > 0.0F;
      points[IndexOf(row, column)] = has_own ? Points::kInside : close ? Points::kClose : Points::kNone;
    }
  }
  return points;
}

void PointRanges::FindSky(const RaySource& source, int photo, const std::vector<Points>& points) {
  const std::vector<Eigen::Vector3f> colors = source.TileColors(photo);
  Range* ranges = ranges_.data() + first_[static_cast<size_t>(photo)];
  // Which way is up in the image: towards the edge at which rays rise most.
  Eigen::Vector3d origin, direction;
  const auto rise = [&](int row, int column) {
    source.RayThrough(photo, source.TileCentre({photo, static_cast<int16_t>(column), static_cast<int16_t>(row)}), &origin, &direction);
    return direction.z();
  };
  const double by_row = rise(0, kTileColumns / 2) - rise(kTileRows - 1, kTileColumns / 2);
  const double by_column = rise(kTileRows / 2, 0) - rise(kTileRows / 2, kTileColumns - 1);
  const bool along_rows = std::abs(by_row) >= std::abs(by_column);
  const bool from_first = (along_rows ? by_row : by_column) > 0.0;
  const int lines = along_rows ? kTileColumns : kTileRows, length = along_rows ? kTileRows : kTileColumns;
  const auto may_be_sky = [&](int row, int column) {
    const Eigen::Vector3f& srgb = colors[IndexOf(row, column)];
    return rise(row, column) > kAboveHorizon && srgb.mean() >= kSkyBrightness && srgb.z() >= kSkyBlue * srgb.x();
  };
  std::vector<Tile> found;
  for (int line = 0; line < lines; ++line) {
    bool sky = true;
    Eigen::Vector3f above;
    for (int i = 0; i < length; ++i) {
      const int step = from_first ? i : length - 1 - i;
      const int row = along_rows ? step : line, column = along_rows ? line : step;
      const Eigen::Vector3f& srgb = colors[IndexOf(row, column)];
      sky = sky && points[IndexOf(row, column)] == Points::kNone && may_be_sky(row, column) &&
            (i == 0 || (srgb - above).cwiseAbs().maxCoeff() <= kSkyStep);
      above = srgb;
      if (!sky) continue;
      ranges[IndexOf(row, column)].open_sky = 1;
      found.push_back({photo, static_cast<int16_t>(column), static_cast<int16_t>(row)});
    }
  }
  // From there up to what stands before it, where points are close.
  while (!found.empty()) {
    const Tile from = found.back();
    found.pop_back();
    for (const auto& [down, right] : {std::array<int, 2>{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
      const int row = from.row + down, column = from.column + right;
      if (row < 0 || row >= kTileRows || column < 0 || column >= kTileColumns) continue;
      Range& range = ranges[IndexOf(row, column)];
      if (range.Sky() || points[IndexOf(row, column)] == Points::kInside || !may_be_sky(row, column) ||
          !((colors[IndexOf(row, column)] - colors[IndexOf(from.row, from.column)]).cwiseAbs().maxCoeff() <= kSameSkyStep)) {
        continue;
      }
      range.open_sky = 1;
      found.push_back({photo, static_cast<int16_t>(column), static_cast<int16_t>(row)});
    }
  }
}

bool PointRanges::IsIndoors(const survey::Survey& survey, const RaySource& source, const std::vector<int>& photos, base::ThreadPool& threads) const {
  const size_t stride = survey.points.size() / kMostPointsAbove + 1;
  const auto bin_of = [](const Eigen::Vector3d& direction) {
    constexpr double kBinsPerRad = kDirections / (2.0 * std::numbers::pi);
    return std::min(static_cast<size_t>((std::atan2(direction.y(), direction.x()) + std::numbers::pi) * kBinsPerRad), kDirections - 1);
  };
  std::vector<int> sky(photos.size(), 0), below(photos.size(), 0);
  threads.ParallelFor(static_cast<int64_t>(photos.size()), [&](int64_t i, int) {
    const int photo = photos[static_cast<size_t>(i)];
    const Eigen::Vector3d eye = cam_from_enu_[static_cast<size_t>(photo)].OriginInSource();
    std::array<double, kDirections> highest;
    highest.fill(-1.0);
    for (size_t point = 0; point < survey.points.size(); point += stride) {
      const Eigen::Vector3d to_point = survey.points[point].x_in_enu - eye;
      double& value = highest[bin_of(to_point)];
      value = std::max(value, to_point.z() / std::max(1e-9, to_point.norm()));
    }
    for (const Tile& tile : TrainingTiles(survey, {photo})) {
      if (!Of(tile).Sky()) continue;
      Eigen::Vector3d origin, direction;
      source.RayThrough(photo, source.TileCentre(tile), &origin, &direction);
      ++sky[static_cast<size_t>(i)];
      if (highest[bin_of(direction)] > direction.z() + kAboveSky) ++below[static_cast<size_t>(i)];
    }
  });
  return std::reduce(below.begin(), below.end()) > kIndoors * std::reduce(sky.begin(), sky.end());
}

// How far it is to the nearest tile that shows something else: one more than for the neighbour that is nearest to it.
void PointRanges::FindOpenSky(int photo) {
  Range* ranges = ranges_.data() + first_[static_cast<size_t>(photo)];
  for (int reach = 1; reach < std::min(kTileRows, kTileColumns); ++reach) {
    bool any = false;
    for (int row = 0; row < kTileRows; ++row) {
      for (int column = 0; column < kTileColumns; ++column) {
        Range& range = ranges[IndexOf(row, column)];
        if (range.open_sky < reach) continue;
        bool open = true;
        for (int y = std::max(0, row - 1); y <= std::min(kTileRows - 1, row + 1); ++y) {
          for (int x = std::max(0, column - 1); x <= std::min(kTileColumns - 1, column + 1); ++x)
            open = open && ranges[IndexOf(y, x)].open_sky >= reach;
        }
        if (open) range.open_sky = reach + 1;
        any = any || open;
      }
    }
    if (!any) break;
  }
}

void PointRanges::GiveSky(RaySource& source, base::ThreadPool& threads) const {
  threads.ParallelFor(static_cast<int64_t>(first_.size()), [&](int64_t task, int) {
    const auto photo = static_cast<int>(task);
    if (first_[static_cast<size_t>(task)] < 0) return;
    const Range* ranges = ranges_.data() + first_[static_cast<size_t>(task)];
    std::vector<char> open(kTiles);
    for (size_t i = 0; i < kTiles; ++i) open[i] = ranges[i].open_sky > 1 ? 1 : 0;
    if (std::ranges::count(open, 1) == 0) return;
    const std::vector<Eigen::Vector3f> colors = source.TileColors(photo);
    std::vector<Eigen::Vector3f> beside(kTiles, Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN()));
    for (int row = 0; row < kTileRows; ++row) {
      for (int column = 0; column < kTileColumns; ++column) {
        if (open[IndexOf(row, column)] != 0) continue;
        int nearest = kSkyRim * kSkyRim + 1;
        for (int y = std::max(0, row - kSkyRim); y <= std::min(kTileRows - 1, row + kSkyRim); ++y) {
          for (int x = std::max(0, column - kSkyRim); x <= std::min(kTileColumns - 1, column + kSkyRim); ++x) {
            const int distance = (y - row) * (y - row) + (x - column) * (x - column);
            if (open[IndexOf(y, x)] == 0 || distance >= nearest) continue;
            nearest = distance;
            beside[IndexOf(row, column)] = colors[IndexOf(y, x)];
          }
        }
      }
    }
    source.FindSkyPixels(photo, beside, open);
  });
}

void PointRanges::FindFreeBalls(const survey::Survey& survey, const std::vector<int>& photos, base::ThreadPool& threads) {
  const size_t stride = survey.points.size() / kMostPointsAbove + 1;
  if (survey.points.size() / stride <= kWrongPoints) return;
  free_balls_.resize(photos.size());
  threads.ParallelFor(static_cast<int64_t>(photos.size()), [&](int64_t i, int) {
    const Eigen::Vector3d eye = cam_from_enu_[static_cast<size_t>(photos[static_cast<size_t>(i)])].OriginInSource();
    std::vector<double> distances;
    std::vector<std::pair<double, double>> points;  // distance on the map, and height
    for (size_t point = 0; point < survey.points.size(); point += stride) {
      const Eigen::Vector3d from_eye = survey.points[point].x_in_enu - eye;
      distances.push_back(from_eye.norm());
      points.emplace_back(from_eye.head<2>().norm(), survey.points[point].x_in_enu.z());
    }
    FreeBall& ball = free_balls_[static_cast<size_t>(i)];
    std::nth_element(distances.begin(), distances.begin() + kWrongPoints, distances.end());
    ball = {eye, kFreeBall * distances[kWrongPoints], -kInfinite, kInfinite};
    const size_t around = std::min(points.size(), std::max(points.size() / kAroundShare, kLeastAround));
    std::nth_element(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(around) - 1, points.end());
    points.resize(around);
    std::vector<double> height;
    for (const auto& [distance_m, z] : points) height.push_back(z);
    std::sort(height.begin(), height.end());
    // All points above the eye say nothing about the floor, nor those below it about the ceiling.
    if (const double floor = height[kWrongPoints]; floor < eye.z()) ball.floor_m = floor;
    if (const double ceiling = height[height.size() - 1 - kWrongPoints]; ceiling > eye.z()) ball.ceiling_m = ceiling;
  });
  for (size_t i = 0; i + 1 < free_balls_.size(); ++i) {
    const FreeBall& next = free_balls_[i + 1];
    free_balls_[i].reaches_next = survey.photos[static_cast<size_t>(photos[i])].flight == survey.photos[static_cast<size_t>(photos[i + 1])].flight &&
                                  (next.centre_enu - free_balls_[i].centre_enu).norm() < free_balls_[i].radius_m + next.radius_m;
  }
}

void PointRanges::KeepFloorAndCeiling(const RaySource& source, int photo) {
  if (free_balls_.empty()) return;
  const auto first = static_cast<size_t>(first_[static_cast<size_t>(photo)]);
  const FreeBall& ball = free_balls_[first / kTiles];
  for (int row = 0; row < kTileRows; ++row) {
    for (int column = 0; column < kTileColumns; ++column) {
      Eigen::Vector3d origin, direction;
      source.RayThrough(photo, source.TileCentre({photo, static_cast<int16_t>(column), static_cast<int16_t>(row)}), &origin, &direction);
      const double height_m = (direction.z() < 0.0 ? ball.floor_m : ball.ceiling_m) - origin.z();
      const double distance_m = direction.z() != 0.0 ? height_m / direction.z() : kInfinite;
      Range& range = ranges_[first + IndexOf(row, column)];
      range.plane = static_cast<float>(distance_m);
      range.near = std::min(range.near, kNearSlack * range.plane);
    }
  }
}

bool PointRanges::InFreeSpace(const Eigen::Vector3d& x_in_enu, double radius_m) const {
  for (size_t i = 0; i < free_balls_.size(); ++i) {
    FreeBall ball = free_balls_[i];
    if (ball.reaches_next) {
      const FreeBall& next = free_balls_[i + 1];
      const Eigen::Vector3d way = next.centre_enu - ball.centre_enu;
      const double t = std::clamp((x_in_enu - ball.centre_enu).dot(way) / std::max(way.squaredNorm(), 1e-12), 0.0, 1.0);
      ball = {ball.centre_enu + t * way, (1.0 - t) * ball.radius_m + t * next.radius_m, std::max(ball.floor_m, next.floor_m),
              std::min(ball.ceiling_m, next.ceiling_m)};
    }
    const Eigen::Vector3d from_eye = x_in_enu - ball.centre_enu;
    if (from_eye.norm() < ball.radius_m && from_eye.z() - radius_m > kFreeBall * (ball.floor_m - ball.centre_enu.z()) &&
        from_eye.z() + radius_m < kFreeBall * (ball.ceiling_m - ball.centre_enu.z())) {
      return true;
    }
  }
  return false;
}

const PointRanges::Range& PointRanges::Of(const Tile& tile) const {
  return ranges_[static_cast<size_t>(first_[static_cast<size_t>(tile.photo)]) + IndexOf(tile.row, tile.column)];
}

bool PointRanges::MayShow(int photo, const Eigen::Vector3d& x_in_enu, double radius_m) const {
  if (first_[static_cast<size_t>(photo)] < 0) return true;
  const camera::Camera& camera = *cameras_[static_cast<size_t>(photo)];
  const Eigen::Vector3d x_in_cam = cam_from_enu_[static_cast<size_t>(photo)] * x_in_enu;
  const auto pixel = camera.ImgFromCam(x_in_cam);
  if (!pixel || !pixel->allFinite()) return true;
  const auto along = [](double at, int size, int count) {
    return static_cast<int16_t>(std::clamp(at * count / size, 0.0, static_cast<double>(count - 1)));
  };
  const Range& range = Of({photo, along(pixel->x(), camera.width, kTileColumns), along(pixel->y(), camera.height, kTileRows)});
  const double distance = x_in_cam.norm();
  // Before the sky there is nothing. The ball's image is this many tiles wide on each side.
  const double reach = radius_m * camera.FocalX() / std::max(distance, 1e-9) * kTileColumns / camera.width;
  if (range.open_sky > 1.0 + reach) return false;
  return distance >= static_cast<double>(range.near) - radius_m && distance <= static_cast<double>(range.far) + radius_m;
}

}  // namespace skyquilt::worker
