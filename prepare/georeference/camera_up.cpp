#include "prepare/georeference/camera_up.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/base/order_statistics.h"
#include "core/base/random.h"
#include "core/linear/linear.h"
#include "core/survey/orientation.h"

namespace skyquilt::prepare::georeference {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kAxisSpread = 0.03;  // mean square of what right axes differ by, at least, that determine up
constexpr double kLevelSine = 0.26;   // of 15 degrees: axes that are less steep are level
constexpr double kUprightSine = 0.7;  // axes that are steeper are upright
constexpr double kLevelShare = 0.85;  // of the cameras, for an up by level axes
constexpr double kSteepView = 0.7;    // median cosine between views and up, for a sign by the views
constexpr double kSteepest = 0.9;     // likewise, for one against all photos' own up
constexpr double kClearVote = 0.2;    // mean cosine
constexpr double kOneWay = 0.9;       // length of the mean view of cameras that look about the same way
constexpr double kAllAround = 0.6;    // of such that look all around
constexpr double kAlongView = 0.94;   // cosine of 20 degrees
constexpr size_t kLeastToTurn = 6;    // photos
constexpr int kGuesses = 200;         // pairs of cameras
constexpr int kTurnRounds = 3;

// Turns a camera about its view so that this direction in its photo, x right and y down, points upwards in the photo.
Quaterniond TurnedUpright(const Quaterniond& cam_from_model, const Vector2d& image_up) {
  const double angle = -0.5 * std::numbers::pi - std::atan2(image_up.y(), image_up.x());
  return (Quaterniond(Eigen::AngleAxisd(angle, Vector3d::UnitZ())) * cam_from_model).normalized();
}

// The side of the photo that is nearest to `up`.
Vector2d SideNearest(const Quaterniond& cam_from_model, const Vector3d& up) {
  const Vector3d in_cam = cam_from_model * up;
  if (std::abs(in_cam.x()) <= std::abs(in_cam.y())) return {0.0, in_cam.y() < 0.0 ? -1.0 : 1.0};
  return {in_cam.x() < 0.0 ? -1.0 : 1.0, 0.0};
}

std::vector<Quaterniond> AsStored(const std::vector<input::PreparedPhoto>& photos) {
  std::vector<Quaterniond> rotations;
  rotations.reserve(photos.size());
  for (const input::PreparedPhoto& photo : photos) rotations.push_back(photo.cam_from_model.rotation);
  return rotations;
}

// As the EXIF orientation says. Mirrored photos are turned only.
std::vector<Quaterniond> AsTagged(const std::vector<input::PreparedPhoto>& photos) {
  std::vector<Quaterniond> rotations = AsStored(photos);
  const Eigen::Vector2i any_size(4, 4);
  for (size_t i = 0; i < photos.size(); ++i) {
    const int orientation = photos[i].file.tags.orientation;
    const Vector2d image_up =
        survey::StoredFromUpright({1.0, 1.0}, any_size, orientation) - survey::StoredFromUpright({1.0, 2.0}, any_size, orientation);
    if (image_up.y() > -0.5) rotations[i] = TurnedUpright(rotations[i], image_up);
  }
  return rotations;
}

// Of all cameras together, in the model's frame.
struct CameraAxes {
  Vector3d right = Vector3d::Zero(), view = Vector3d::Zero(), camera_up = Vector3d::Zero();  // means
  linear::EigenPairs<3> of_right;                                                            // of the scatter of the right axes
  double level_share = 0.0;  // of right axes that are level when the first of these vectors is up

  bool parallel() const { return !(of_right.values[1] > kAxisSpread); }
  bool spread() const { return !parallel() && of_right.values[0] < 0.5 * of_right.values[1]; }
  bool level() const { return spread() && level_share >= kLevelShare; }
};

CameraAxes AxesOf(const std::vector<Quaterniond>& cam_from_model) {
  CameraAxes axes;
  Matrix3d right_axes = Matrix3d::Zero();
  const auto n = static_cast<double>(cam_from_model.size());
  for (const Quaterniond& rotation : cam_from_model) {
    const Matrix3d model_from_cam = rotation.conjugate().toRotationMatrix();
    right_axes += model_from_cam.col(0) * model_from_cam.col(0).transpose() / n;
    axes.right += model_from_cam.col(0) / n;
    axes.view += model_from_cam.col(2) / n;
    axes.camera_up -= model_from_cam.col(1) / n;
  }
  axes.of_right = linear::SymmetricEigen(right_axes);
  const Vector3d up = axes.of_right.vectors.col(0);
  const auto n_level = std::count_if(cam_from_model.begin(), cam_from_model.end(), [&](const Quaterniond& rotation) {
    return std::abs((rotation.conjugate() * Vector3d::UnitX()).dot(up)) < kLevelSine;
  });
  axes.level_share = static_cast<double>(n_level) / std::max(n, 1.0);
  return axes;
}

// Photos without a tag of a turn, some of which were turned by a quarter: up is the direction for which one axis of most cameras is level. Nothing
// where no turn explains the axes.
std::optional<std::vector<Quaterniond>> SomeTurned(const std::vector<Quaterniond>& cam_from_model) {
  const size_t n = cam_from_model.size();
  if (n < kLeastToTurn) return std::nullopt;
  std::vector<Matrix3d> model_from_cam;
  model_from_cam.reserve(n);
  for (const Quaterniond& rotation : cam_from_model) model_from_cam.push_back(rotation.conjugate().toRotationMatrix());
  const auto cost = [&](const Vector3d& up) {
    double sum = 0.0;
    for (const Matrix3d& axes : model_from_cam) {
      const double least = std::min(std::abs(axes.col(0).dot(up)), std::abs(axes.col(1).dot(up))) / kLevelSine;
      sum += std::min(1.0, least * least);
    }
    return sum;
  };
  base::Random random(1);
  Vector3d up = Vector3d::Zero();
  double best = static_cast<double>(n);
  for (int guess = 0; guess < kGuesses; ++guess) {
    const Matrix3d& a = model_from_cam[random.Below(static_cast<uint32_t>(n))];
    const Matrix3d& b = model_from_cam[random.Below(static_cast<uint32_t>(n))];
    for (Eigen::Index i = 0; i < 2; ++i) {
      for (Eigen::Index j = 0; j < 2; ++j) {
        const Vector3d across = a.col(i).cross(b.col(j));
        if (!(across.norm() > kLevelSine)) continue;
        if (const double sum = cost(across.normalized()); sum < best) {
          best = sum;
          up = across.normalized();
        }
      }
    }
  }
  if (up.isZero()) return std::nullopt;
  std::vector<char> turned(n, 0);
  for (int round = 0; round < kTurnRounds; ++round) {
    Matrix3d level_axes = Matrix3d::Zero();
    for (size_t i = 0; i < n; ++i) {
      const double right = std::abs(model_from_cam[i].col(0).dot(up)), down = std::abs(model_from_cam[i].col(1).dot(up));
      turned[i] = right > kUprightSine && down < kLevelSine ? 1 : 0;
      const Vector3d axis = model_from_cam[i].col(turned[i] != 0 ? 1 : 0);
      if (std::abs(axis.dot(up)) < kLevelSine) level_axes += axis * axis.transpose() / static_cast<double>(n);
    }
    up = linear::SymmetricEigen(level_axes).vectors.col(0);
  }
  // Unturned photos know which side is up. Without any, the photos look down, or are as phones store portraits: their left side is up.
  double vote = 0.0, by_view = 0.0, by_left = 0.0;
  for (size_t i = 0; i < n; ++i) {
    if (turned[i] == 0) vote -= model_from_cam[i].col(1).dot(up) / static_cast<double>(n);
    if (turned[i] != 0) by_left -= model_from_cam[i].col(0).dot(up) / static_cast<double>(n);
    by_view -= model_from_cam[i].col(2).dot(up) / static_cast<double>(n);
  }
  const double sign = std::abs(vote) > 0.5 * kClearVote ? vote : std::abs(by_view) > kClearVote ? by_view : by_left;
  if (sign < 0.0) up = -up;
  std::vector<Quaterniond> upright = cam_from_model;
  for (size_t i = 0; i < n; ++i) {
    if (turned[i] != 0) upright[i] = TurnedUpright(upright[i], SideNearest(upright[i], up));
  }
  return std::find(turned.begin(), turned.end(), 1) != turned.end() && AxesOf(upright).level() ? std::optional(upright) : std::nullopt;
}

// Photos whose right axes are all parallel though they look all around: all were turned, and their right axes point up or down. Nothing where that
// does not fit.
std::optional<std::vector<Quaterniond>> AllTurned(const std::vector<Quaterniond>& cam_from_model) {
  std::vector<Quaterniond> upright;
  upright.reserve(cam_from_model.size());
  for (const Quaterniond& rotation : cam_from_model) upright.push_back(TurnedUpright(rotation, {-1.0, 0.0}));
  const CameraAxes axes = AxesOf(upright);
  if (!axes.level()) return std::nullopt;
  // Photos that look down are turned to the side that agrees with it, the others as phones store portraits.
  if (axes.view.dot(axes.camera_up) > kClearVote) {
    for (size_t i = 0; i < upright.size(); ++i) upright[i] = TurnedUpright(cam_from_model[i], {1.0, 0.0});
  }
  return upright;
}

// Cameras that look about the same way, turned about it so that all photos have the same side up. Nothing when they are turned to opposite sides, as
// along the lines of a flight.
std::optional<std::vector<Quaterniond>> OneSideUp(const std::vector<Quaterniond>& cam_from_model, const Vector3d& view) {
  const auto across = [&](const Vector3d& v) { return Vector3d(v - v.dot(view) * view); };
  const Vector3d first = across(cam_from_model.front().conjugate() * -Vector3d::UnitY());
  const Vector3d second = view.cross(first);
  std::vector<size_t> quarter;
  std::array<double, 4> share{};
  for (const Quaterniond& rotation : cam_from_model) {
    const Vector3d up = rotation.conjugate() * -Vector3d::UnitY();
    const auto turns = std::lround(std::atan2(up.dot(second), up.dot(first)) / (0.5 * std::numbers::pi));
    quarter.push_back(static_cast<size_t>(turns + 4) % 4);
    share[quarter.back()] += 1.0 / static_cast<double>(cam_from_model.size());
  }
  const auto most = static_cast<size_t>(std::max_element(share.begin(), share.end()) - share.begin());
  constexpr double kFew = 0.1;
  if (share[(most + 2) % 4] > kFew || std::min(share[(most + 1) % 4], share[(most + 3) % 4]) > 0.5 * kFew) return std::nullopt;
  Vector3d up = Vector3d::Zero();
  for (size_t i = 0; i < cam_from_model.size(); ++i) {
    if (quarter[i] == most) up += cam_from_model[i].conjugate() * -Vector3d::UnitY();
  }
  std::vector<Quaterniond> upright = cam_from_model;
  for (size_t i = 0; i < upright.size(); ++i) {
    if (quarter[i] != most) upright[i] = TurnedUpright(upright[i], SideNearest(upright[i], up));
  }
  return upright;
}

// Whether cameras that look about the same way, with one side up, are held level and do not look down.
bool LooksLevel(const std::vector<input::PreparedPhoto>& photos, const CameraAxes& axes, const UpByTagsFunction& tags_up) {
  const Vector3d against_view = -axes.view.normalized(), camera_up = axes.camera_up.normalized();
  if (tags_up) {
    if (const std::optional<Vector3d> tags = tags_up()) {
      // Tags with wrong signs give a mirrored place, whose up may be down.
      const double down = std::abs(tags->dot(against_view)), level = tags->dot(camera_up);
      constexpr double kNear = 0.7;
      if (std::max(down, level) > kNear && down != level) return level > down;
    }
  }
  // A camera that is held level turns to the sides more than it rolls; one that looks down has its heading in the same place.
  constexpr double kLeastTurn = 0.0012;  // mean square, of 2 degrees
  constexpr double kClearRatio = 0.2;
  const Vector3d& scatter = axes.of_right.values;
  if (scatter[1] > kLeastTurn && scatter[0] < kClearRatio * scatter[1]) {
    const Vector3d up = axes.of_right.vectors.col(0);
    return std::abs(up.dot(camera_up)) > std::abs(up.dot(against_view));
  }
  // Flights cover the ground; who photographs a wall stays on the ground.
  Vector3d middle = Vector3d::Zero();
  for (const input::PreparedPhoto& photo : photos) middle += photo.cam_from_model.OriginInSource() / static_cast<double>(photos.size());
  const Vector3d right = axes.right.normalized(), down = axes.view.normalized().cross(right);
  double to_right = 0.0, to_down = 0.0, to_front = 0.0;
  for (const input::PreparedPhoto& photo : photos) {
    const Vector3d way = photo.cam_from_model.OriginInSource() - middle;
    to_right += std::pow(way.dot(right), 2);
    to_down += std::pow(way.dot(down), 2);
    to_front += std::pow(way.dot(axes.view.normalized()), 2);
  }
  constexpr double kFlat = 0.35 * 0.35;
  // Straight ahead may be straight up.
  return to_down < kFlat * std::max(to_right, to_front) && to_right > kFlat * to_front;
}

// The line of up, which may be turned over: by the photos' own up, and by the views where these are steep.
Vector3d Signed(const std::vector<Quaterniond>& cam_from_model, const CameraAxes& axes, const Vector3d& up) {
  const double by_view = -axes.view.dot(up), by_cameras = axes.camera_up.dot(up);
  std::vector<double> steep;
  steep.reserve(cam_from_model.size());
  size_t against = 0;  // photos whose own up is clearly opposite to that by the views
  for (const Quaterniond& rotation : cam_from_model) {
    const Matrix3d model_from_cam = rotation.conjugate().toRotationMatrix();
    steep.push_back(std::abs(model_from_cam.col(2).dot(up)));
    const double own = -model_from_cam.col(1).dot(up);
    if (std::abs(own) > kClearVote && (own < 0.0) != (by_view < 0.0)) ++against;
  }
  const double steepness = base::Median(std::move(steep));
  const bool all_against = steepness < kSteepest && static_cast<double>(against) >= 0.9 * static_cast<double>(cam_from_model.size());
  constexpr double kAnyView = 0.1;
  const bool views_decide = std::abs(by_view) > kAnyView && ((steepness > kSteepView && !all_against) || std::abs(by_cameras) < kClearVote);
  return (views_decide ? by_view : by_cameras) < 0.0 ? Vector3d(-up) : up;
}

}  // namespace

HeldCameras FindHeldCameras(const std::vector<input::PreparedPhoto>& photos, const UpByTagsFunction& tags_up) {
  HeldCameras held{.cam_from_model = AsTagged(photos)};
  if (photos.empty()) return held;
  CameraAxes axes = AxesOf(held.cam_from_model);
  if (!axes.parallel() && !axes.level()) {
    // Tags of a turn that was made in the file already.
    std::vector<Quaterniond> stored = AsStored(photos);
    if (const CameraAxes of_stored = AxesOf(stored); of_stored.level()) {
      held.cam_from_model = std::move(stored);
      axes = of_stored;
    } else if (auto upright = SomeTurned(held.cam_from_model)) {
      held.cam_from_model = std::move(*upright);
      axes = AxesOf(held.cam_from_model);
    }
  } else if (axes.parallel() && std::max(axes.view.norm(), axes.camera_up.norm()) < kAllAround) {
    if (auto upright = AllTurned(held.cam_from_model)) {
      held.cam_from_model = std::move(*upright);
      axes = AxesOf(held.cam_from_model);
    }
  }
  const bool along_view =
      axes.spread() && axes.view.norm() > kOneWay && std::abs(axes.of_right.vectors.col(0).dot(axes.view)) > kAlongView * axes.view.norm();
  constexpr double kAnyView = 0.1;
  if (axes.view.norm() > kAllAround && (axes.parallel() || along_view)) {
    if (auto upright = OneSideUp(held.cam_from_model, axes.view.normalized())) {
      const CameraAxes one_side = AxesOf(*upright);
      if (LooksLevel(photos, one_side, tags_up)) {
        held.cam_from_model = std::move(*upright);
        held.up = one_side.camera_up.normalized();
        return held;
      }
    }
  }
  if (axes.spread()) {
    held.up = Signed(held.cam_from_model, axes, axes.of_right.vectors.col(0)).normalized();
    return held;
  }
  const Vector3d hint = axes.view.norm() > kAnyView ? Vector3d(-axes.view) : axes.camera_up;
  if (hint.norm() > 1e-9) held.up = hint.normalized();
  return held;
}

Vector3d MeanCameraUp(const std::vector<input::PreparedPhoto>& photos) {
  return photos.empty() ? Vector3d(Vector3d::Zero()) : AxesOf(AsTagged(photos)).camera_up;
}

}  // namespace skyquilt::prepare::georeference
