#include "partition/visibility.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/geo/ray_box.h"

namespace skyquilt::partition {
namespace {

constexpr int kRaysAcross = 16;
constexpr int kRaysDown = 12;

double PixelsOf(const camera::Camera& camera, int image_width) {
  const double scale = image_width > 0 ? std::min(1.0, static_cast<double>(image_width) / camera.width) : 1.0;
  return scale * scale * camera.width * camera.height;
}

struct RayGrid {
  std::vector<Eigen::Vector3d> direction_in_cam;
  std::vector<double> share;  // of the image that each ray stands for; sums to 1
};

RayGrid MakeRayGrid(const camera::Camera& camera) {
  RayGrid grid;
  for (int j = 0; j < kRaysDown; ++j) {
    for (int i = 0; i < kRaysAcross; ++i) {
      const bool side = i == 0 || i == kRaysAcross - 1;
      const bool end = j == 0 || j == kRaysDown - 1;
      const Eigen::Vector2d pixel(static_cast<double>(camera.width) * i / (kRaysAcross - 1),
                                  static_cast<double>(camera.height) * j / (kRaysDown - 1));
      grid.direction_in_cam.push_back(camera.RayFromImg(pixel));
      grid.share.push_back((side ? 0.5 : 1.0) * (end ? 0.5 : 1.0) / ((kRaysAcross - 1) * (kRaysDown - 1)));
    }
  }
  return grid;
}

double ShareByRays(const RayGrid& grid, const std::vector<Eigen::Vector3d>& direction, const Eigen::Vector3d& eye, const Box& box) {
  double share = 0.0;
  for (size_t i = 0; i < direction.size(); ++i) {
    if (geo::RayHitsBox(eye, direction[i], box.low, box.high)) share += grid.share[i];
  }
  return share;
}

double ShareByProjection(const camera::Camera& camera, const survey::Photo& photo, const Box& box) {
  const Eigen::Vector2d size(camera.width, camera.height);
  const auto centre = camera.ImgFromCam(photo.cam_from_enu * (0.5 * (box.low + box.high)));
  if (!centre || (centre->array() < 0.0).any() || (centre->array() > size.array()).any()) return 0.0;
  Eigen::Vector2d low = *centre;
  Eigen::Vector2d high = *centre;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d x((corner & 1) ? box.high.x() : box.low.x(), (corner & 2) ? box.high.y() : box.low.y(),
                            (corner & 4) ? box.high.z() : box.low.z());
    const auto pixel = camera.ImgFromCam(photo.cam_from_enu * x);
    if (!pixel) continue;
    low = low.cwiseMin(*pixel);
    high = high.cwiseMax(*pixel);
  }
  const Eigen::Vector2d extent = high.cwiseMin(size) - low.cwiseMax(0.0);
  // A box smaller than a pixel counts as one pixel.
  return std::max(extent.prod(), 1.0) / size.prod();
}

// The part of the ground plan that a photo can show at heights of the boxes: a rectangle around its rays there, with room for the bend of its edges
// between rays. Infinite where the photo shows the horizon.
struct Plan {
  Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector2d high = Eigen::Vector2d::Constant(-std::numeric_limits<double>::infinity());

  void Add(const Eigen::Vector2d& x) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  bool Meets(const Box& box) const { return (box.low.head<2>().array() <= high.array()).all() && (box.high.head<2>().array() >= low.array()).all(); }
};

Plan PlanOf(const Eigen::Vector3d& eye, const std::vector<Eigen::Vector3d>& direction, double low_m, double high_m) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  constexpr double kRoom = 0.25;  // of its size, on every side
  const auto by_height = [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) { return a.z() < b.z(); };
  const auto [lowest, highest] = std::minmax_element(direction.begin(), direction.end(), by_height);
  // Level rays between those that go up and down stay at these heights for ever.
  if (!(lowest->z() > 0.0 || highest->z() < 0.0)) return {Eigen::Vector2d::Constant(-kInfinity), Eigen::Vector2d::Constant(kInfinity)};
  Plan plan;
  for (const Eigen::Vector3d& d : direction) {
    const geo::Interval level = geo::RayBox(eye, d, {-kInfinity, -kInfinity, low_m}, {kInfinity, kInfinity, high_m});
    if (level.Empty()) continue;
    for (const double t : {level.t_near, level.t_far}) plan.Add((eye + t * d).head<2>());
  }
  const Eigen::Vector2d room = kRoom * (plan.high - plan.low).cwiseMax(0.0);
  return {plan.low - room, plan.high + room};
}

}  // namespace

double TrainingPixels(const survey::Survey& survey, int image_width) {
  double pixels = 0.0;
  for (const survey::Photo& photo : survey.photos) {
    if (!photo.is_test) pixels += PixelsOf(survey.cameras.at(static_cast<size_t>(photo.camera)), image_width);
  }
  return pixels;
}

std::vector<BoxVisibility> FindVisibility(const survey::Survey& survey, const std::vector<Box>& boxes, int image_width, size_t few_boxes) {
  std::vector<RayGrid> grids;
  for (const camera::Camera& camera : survey.cameras) grids.push_back(MakeRayGrid(camera));
  std::vector<BoxVisibility> views(boxes.size());
  constexpr double kBesideFlat_m = 1.0;  // boxes may be flat
  // With few boxes asking each of them costs less than finding out which are near.
  const bool many = boxes.size() > few_boxes;
  double low_m = std::numeric_limits<double>::infinity(), high_m = -low_m;
  for (const Box& box : boxes) {
    low_m = std::min(low_m, box.low.z());
    high_m = std::max(high_m, box.high.z());
  }
  for (size_t p = 0; p < survey.photos.size(); ++p) {
    const survey::Photo& photo = survey.photos[p];
    if (photo.is_test) continue;
    const camera::Camera& camera = survey.cameras.at(static_cast<size_t>(photo.camera));
    const RayGrid& grid = grids[static_cast<size_t>(photo.camera)];
    const Eigen::Vector3d eye = photo.cam_from_enu.OriginInSource();
    std::vector<Eigen::Vector3d> direction;
    direction.reserve(grid.direction_in_cam.size());
    for (const Eigen::Vector3d& in_cam : grid.direction_in_cam) direction.emplace_back(photo.cam_from_enu.rotation.conjugate() * in_cam);
    const double pixels = PixelsOf(camera, image_width);
    const Plan plan = many ? PlanOf(eye, direction, low_m - kBesideFlat_m, high_m + kBesideFlat_m) : Plan();
    for (size_t b = 0; b < boxes.size(); ++b) {
      if (many && !plan.Meets(boxes[b])) continue;
      double share = ShareByRays(grid, direction, eye, boxes[b]);
      if (share == 0.0) share = ShareByProjection(camera, photo, boxes[b]);
      if (share == 0.0) continue;
      views[b].photos.push_back(static_cast<int>(p));
      views[b].training_pixels += share * pixels;
    }
  }
  return views;
}

}  // namespace skyquilt::partition
