#include "surface/refine/neighbours.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace skyquilt::surface {
namespace {

constexpr int kColumns = 16, kRows = 12;  // of the places that are asked
constexpr double kBestAngle_deg = 15.0, kNarrower_deg = 6.0, kWider_deg = 15.0;
constexpr double kLeastShare = 0.05;  // of the places, weighted, that a neighbour must show
constexpr double kReach = 3.0;        // neighbours are nearer than this times the farthest place

std::vector<Eigen::Vector3d> PlacesOf(const DepthView& view) {
  std::vector<Eigen::Vector3d> places;
  const ViewPose& pose = view.pose;
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      const int x = (2 * column + 1) * pose.width / (2 * kColumns), y = (2 * row + 1) * pose.height / (2 * kRows);
      const float depth = view.depth_m[static_cast<size_t>(y) * static_cast<size_t>(pose.width) + static_cast<size_t>(x)];
      if (depth > 0.0F) places.emplace_back(pose.Centre() + static_cast<double>(depth) * pose.DirectionAt(x + 0.5, y + 0.5));
    }
  }
  return places;
}

}  // namespace

std::vector<size_t> NeighboursOf(size_t view, const DepthView& picture, std::span<const ViewPose> poses, size_t most) {
  const std::vector<Eigen::Vector3d> places = PlacesOf(picture);
  const Eigen::Vector3d own = picture.pose.Centre();
  double farthest_m = 0.0;
  for (const Eigen::Vector3d& x : places) farthest_m = std::max(farthest_m, (x - own).norm());
  std::vector<std::pair<double, size_t>> found;
  for (size_t other = 0; other < poses.size(); ++other) {
    const Eigen::Vector3d centre = poses[other].Centre();
    if (other == view || (centre - own).norm() > kReach * farthest_m) continue;
    double sum = 0.0;
    for (const Eigen::Vector3d& x : places) {
      if (!poses[other].Project(x)) continue;
      const double cosine = (own - x).normalized().dot((centre - x).normalized());
      const double off_deg = std::acos(std::clamp(cosine, -1.0, 1.0)) * 180.0 / std::numbers::pi - kBestAngle_deg;
      const double off = off_deg / (off_deg < 0.0 ? kNarrower_deg : kWider_deg);
      sum += std::exp(-0.5 * off * off);
    }
    if (sum > kLeastShare * static_cast<double>(places.size())) found.emplace_back(sum, other);
  }
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<size_t> neighbours;
  for (size_t i = 0; i < std::min(found.size(), most); ++i) neighbours.push_back(found[i].second);
  return neighbours;
}

}  // namespace skyquilt::surface
