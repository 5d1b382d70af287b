#include "worker/start/view_counter.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "core/camera/photo_visibility.h"

namespace skyquilt::worker {
namespace {

constexpr int kLeafPhotos = 8;

double AngleBetweenUnits(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

// From the optical axis to the farthest place of the image's edge, radians. pi where the lens bends rays so much that a ball's size in pixels says
// little about its size in space: fisheyes, and lenses of which an edge is far from where it would be without distortion.
double WidestAngle(const camera::Camera& camera) {
  constexpr int kSteps = 8;
  constexpr double kBend = 1.5, kLargest = 1.3;
  if (camera::IsFisheye(camera.model)) return std::numbers::pi;
  double widest = 0.0;
  for (int i = 0; i <= kSteps; ++i) {
    const double along = static_cast<double>(i) / kSteps;
    const Eigen::Vector2d edge[] = {{along * camera.width, 0.0},
                                    {along * camera.width, static_cast<double>(camera.height)},
                                    {0.0, along * camera.height},
                                    {static_cast<double>(camera.width), along * camera.height}};
    for (const Eigen::Vector2d& pixel : edge) {
      const Eigen::Vector3d ray = camera.RayFromImg(pixel);
      if (!ray.allFinite() || !(ray.z() > 0.0)) return std::numbers::pi;
      const double angle = std::atan2(ray.head<2>().norm(), ray.z());
      const double plain = std::atan((pixel - camera.PrincipalPoint()).norm() / camera.FocalX());
      if (angle > kLargest || angle > kBend * plain || plain > kBend * angle) return std::numbers::pi;
      widest = std::max(widest, angle);
    }
  }
  return widest;
}

}  // namespace

ViewCounter::ViewCounter(const survey::Survey& survey, const std::vector<int>& photos, CameraOf camera_of)
    : survey_(survey), camera_of_(std::move(camera_of)) {
  for (const int photo : photos) {
    if (!survey.photos[static_cast<size_t>(photo)].is_test) photos_.push_back(photo);
  }
  widest_.assign(survey.photos.size(), 0.0);
  for (const int photo : photos_) widest_[static_cast<size_t>(photo)] = WidestAngle(camera_of_(photo));
  if (!photos_.empty()) root_ = Build(0, static_cast<int>(photos_.size()));
}

int ViewCounter::Build(int first, int last) {
  Node node{.first = first, .last = last};
  const auto position = [this](int photo) { return survey_.photos[static_cast<size_t>(photo)].cam_from_enu.OriginInSource(); };
  const auto axis = [this](int photo) -> Eigen::Vector3d {
    return survey_.photos[static_cast<size_t>(photo)].cam_from_enu.rotation.conjugate() * Eigen::Vector3d::UnitZ();
  };
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Eigen::Vector3d low = Eigen::Vector3d::Constant(kInfinity), high = -low, sum = Eigen::Vector3d::Zero();
  for (int i = first; i < last; ++i) {
    const Eigen::Vector3d x = position(photos_[static_cast<size_t>(i)]);
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
    sum += axis(photos_[static_cast<size_t>(i)]);
  }
  node.centre = 0.5 * (low + high);
  node.axis = sum.norm() > 1e-9 ? Eigen::Vector3d(sum.normalized()) : Eigen::Vector3d::UnitZ();
  for (int i = first; i < last; ++i) {
    const int photo = photos_[static_cast<size_t>(i)];
    node.radius_m = std::max(node.radius_m, (position(photo) - node.centre).norm());
    node.half_angle = std::max(node.half_angle, AngleBetweenUnits(node.axis, axis(photo)) + widest_[static_cast<size_t>(photo)]);
  }
  if (last - first > kLeafPhotos) {
    Eigen::Index along = 0;
    (high - low).maxCoeff(&along);
    const int middle = (first + last) / 2;
    std::nth_element(photos_.begin() + first, photos_.begin() + middle, photos_.begin() + last,
                     [&](int a, int b) { return position(a)[along] < position(b)[along]; });
    node.left = Build(first, middle);
    node.right = Build(middle, last);
  }
  nodes_.push_back(node);
  return static_cast<int>(nodes_.size()) - 1;
}

bool ViewCounter::MayShow(const Node& node, const Eigen::Vector3d& x_in_enu, double radius_m) const {
  const Eigen::Vector3d offset = x_in_enu - node.centre;
  const double distance_m = offset.norm(), nearest_m = distance_m - node.radius_m;
  // Far more than IsVisible lets a ball reach beyond the image, and than lenses of less than kBend change that.
  constexpr double kReach = 6.0;
  if (!(nearest_m > kReach * radius_m) || !(nearest_m > 0.0)) return true;
  constexpr double kRounding = 1e-6;
  // No less than asin(sine), and much faster.
  const auto angle = [](double sine) { return sine + (std::numbers::pi / 2.0 - 1.0) * sine * sine * sine; };
  const double reach = node.half_angle + angle(kReach * radius_m / nearest_m) + angle(std::min(1.0, node.radius_m / distance_m)) + kRounding;
  return reach >= std::numbers::pi || node.axis.dot(offset) >= std::cos(reach) * distance_m;
}

void ViewCounter::Add(int index, const Eigen::Vector3d& x_in_enu, double radius_m, int enough, const Accept& shows, int* views) const {
  const Node& node = nodes_[static_cast<size_t>(index)];
  if (*views >= enough || !MayShow(node, x_in_enu, radius_m)) return;
  if (node.left >= 0) {
    const auto distance = [&](int child) { return (nodes_[static_cast<size_t>(child)].centre - x_in_enu).squaredNorm(); };
    const bool left_first = distance(node.left) <= distance(node.right);
    Add(left_first ? node.left : node.right, x_in_enu, radius_m, enough, shows, views);
    Add(left_first ? node.right : node.left, x_in_enu, radius_m, enough, shows, views);
    return;
  }
  for (int i = node.first; i < node.last && *views < enough; ++i) {
    const int photo = photos_[static_cast<size_t>(i)];
    const geo::Rigid3d& cam_from_enu = survey_.photos[static_cast<size_t>(photo)].cam_from_enu;
    if (camera::IsVisible(camera_of_(photo), cam_from_enu, x_in_enu, {.radius_m = radius_m}) && (!shows || shows(photo))) ++*views;
  }
}

int ViewCounter::Count(const Eigen::Vector3d& x_in_enu, double radius_m, int enough, const Accept& shows) const {
  int views = 0;
  if (root_ >= 0) Add(root_, x_in_enu, radius_m, enough, shows, &views);
  return views;
}

}  // namespace skyquilt::worker
