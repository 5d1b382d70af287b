#include "simulate/control_marks.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/base/errors.h"
#include "core/base/random.h"

namespace skyquilt::simulate {
namespace {

// Streams of random numbers, one per kind of error, so that each can be changed alone.
enum Stream : uint64_t { kNoiseStream = 82, kWrongPointStream, kWrongMarkStream };

bool IsInside(const Eigen::Vector2d& pixel, const camera::Camera& camera) {
  return pixel.x() > 0.0 && pixel.y() > 0.0 && pixel.x() < camera.width && pixel.y() < camera.height;
}

// Indices of `wanted` of `n` things at most, evenly spread.
std::vector<size_t> Evenly(size_t n, size_t wanted) {
  std::vector<size_t> chosen;
  const size_t count = std::min(n, wanted);
  for (size_t i = 0; i < count; ++i) chosen.push_back((2 * i + 1) * n / (2 * count));
  return chosen;
}

std::vector<TargetMark> MarksOf(const ControlTarget& target, const SimulateOptions& options, const camera::Camera& camera,
                                const std::vector<PhotoPlan>& photos, base::Random& random) {
  std::vector<TargetMark> marks;
  for (const size_t i : Evenly(target.photos.size(), static_cast<size_t>(options.control_marks))) {
    TargetMark mark;
    mark.photo = target.photos[i];
    const auto projected = camera.ImgFromCam(photos[mark.photo].cam_from_enu * target.position);
    SKYQUILT_CHECK(projected.has_value(), "a target is in the photos that see it");
    mark.true_pixel = *projected;
    const double x = random.Normal(), y = random.Normal();
    const Eigen::Vector2d marked = mark.true_pixel + options.control_mark_noise_px * Eigen::Vector2d(x, y);
    const Eigen::Vector2d last(camera.width - 0.01, camera.height - 0.01);
    mark.pixel = marked.cwiseMax(Eigen::Vector2d::Constant(0.01)).cwiseMin(last);
    marks.push_back(mark);
  }
  return marks;
}

// Indices of the control points in random order.
std::vector<size_t> Shuffled(const std::vector<SurveyedTarget>& points, base::Random& random) {
  std::vector<size_t> order;
  for (size_t i = 0; i < points.size(); ++i) {
    if (!points[i].target.check) order.push_back(i);
  }
  for (size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random.Below(static_cast<uint32_t>(i))]);
  return order;
}

void MovePoints(int n_wrong, double wrong_m, uint32_t seed, std::vector<SurveyedTarget>& points) {
  base::Random random(seed, kWrongPointStream);
  std::vector<size_t> order = Shuffled(points, random);
  order.resize(std::min(order.size(), static_cast<size_t>(n_wrong)));
  for (const size_t i : order) {
    const double x = random.Normal(), y = random.Normal(), z = random.Normal();
    points[i].given += wrong_m * Eigen::Vector3d(x, y, z).normalized();
    points[i].wrong = true;
  }
}

void MoveMark(const camera::Camera& camera, base::Random& random, TargetMark& mark) {
  mark.wrong = true;
  // Less than half of the directions lead out of the photo.
  do {
    const double angle = random.Uniform(0.0, 2.0 * std::numbers::pi);
    const double distance_px = random.Uniform(0.03, 0.08) * camera.width;
    mark.pixel = mark.true_pixel + distance_px * Eigen::Vector2d(std::cos(angle), std::sin(angle));
  } while (!IsInside(mark.pixel, camera));
}

void MoveMarks(int n_wrong, const camera::Camera& camera, uint32_t seed, std::vector<SurveyedTarget>& points) {
  base::Random random(seed, kWrongMarkStream);
  std::vector<size_t> order = Shuffled(points, random);
  std::erase_if(order, [&](size_t i) { return points[i].wrong || points[i].marks.empty(); });
  for (int k = 0; k < n_wrong && !order.empty(); ++k) {
    const auto turn = static_cast<size_t>(k);
    std::vector<TargetMark>& marks = points[order[turn % order.size()]].marks;
    const size_t round = turn / order.size();
    if (round < marks.size()) MoveMark(camera, random, marks[(marks.size() / 2 + round) % marks.size()]);
  }
}

}  // namespace

std::vector<SurveyedTarget> SurveyTargets(std::vector<ControlTarget> targets, const SimulateOptions& options, const camera::Camera& camera,
                                          const std::vector<PhotoPlan>& photos, uint32_t seed) {
  base::Random random(seed, kNoiseStream);
  std::vector<SurveyedTarget> points;
  for (ControlTarget& target : targets) {
    SurveyedTarget point;
    point.given = target.position;
    point.marks = MarksOf(target, options, camera, photos, random);
    point.target = std::move(target);
    points.push_back(std::move(point));
  }
  MovePoints(options.control_wrong_points, options.control_wrong_m, seed, points);
  MoveMarks(options.control_wrong_marks, camera, seed, points);
  return points;
}

}  // namespace skyquilt::simulate
