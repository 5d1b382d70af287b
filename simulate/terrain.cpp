#include "simulate/terrain.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/errors.h"
#include "simulate/noise.h"

namespace skyquilt::simulate {

Terrain::Terrain(const Eigen::Vector2d& min, const Eigen::Vector2d& max, double step_m, const std::function<double(double, double)>& height)
    : min_(min), max_(max), step_m_(step_m) {
  SKYQUILT_CHECK(step_m > 0.0 && (max - min).minCoeff() > 0.0, "terrain needs a positive size and step");
  nx_ = static_cast<int>(std::ceil((max.x() - min.x()) / step_m)) + 1;
  ny_ = static_cast<int>(std::ceil((max.y() - min.y()) / step_m)) + 1;
  max_ = min_ + step_m * Eigen::Vector2d(nx_ - 1, ny_ - 1);
  node_.reserve(static_cast<size_t>(nx_) * static_cast<size_t>(ny_));
  for (int j = 0; j < ny_; ++j) {
    for (int i = 0; i < nx_; ++i) node_.push_back(static_cast<float>(height(min_.x() + i * step_m, min_.y() + j * step_m)));
  }
}

float Terrain::Height(float east, float north) const {
  const auto step = static_cast<float>(step_m_);
  const float x = std::clamp((east - static_cast<float>(min_.x())) / step, 0.0F, static_cast<float>(nx_ - 1) - 1e-3F);
  const float y = std::clamp((north - static_cast<float>(min_.y())) / step, 0.0F, static_cast<float>(ny_ - 1) - 1e-3F);
  const int i = static_cast<int>(x);
  const int j = static_cast<int>(y);
  const float fx = x - static_cast<float>(i);
  const float fy = y - static_cast<float>(j);
  const float low = Node(i, j) + fx * (Node(i + 1, j) - Node(i, j));
  const float high = Node(i, j + 1) + fx * (Node(i + 1, j + 1) - Node(i, j + 1));
  return low + fy * (high - low);
}

float Terrain::lowest() const {
  return *std::min_element(node_.begin(), node_.end());
}

void Terrain::AddTo(Mesh& mesh) const {
  const auto first = static_cast<uint32_t>(mesh.position.size());
  const auto row = static_cast<uint32_t>(nx_);
  for (int j = 0; j < ny_; ++j) {
    for (int i = 0; i < nx_; ++i) {
      mesh.position.emplace_back(static_cast<float>(min_.x() + i * step_m_), static_cast<float>(min_.y() + j * step_m_), Node(i, j));
      const int i0 = std::max(i - 1, 0);
      const int i1 = std::min(i + 1, nx_ - 1);
      const int j0 = std::max(j - 1, 0);
      const int j1 = std::min(j + 1, ny_ - 1);
      const auto step = static_cast<float>(step_m_);
      const float slope_x = (Node(i1, j) - Node(i0, j)) / (step * static_cast<float>(i1 - i0));
      const float slope_y = (Node(i, j1) - Node(i, j0)) / (step * static_cast<float>(j1 - j0));
      mesh.normal.push_back(Eigen::Vector3f(-slope_x, -slope_y, 1.0F).normalized());
    }
  }
  for (uint32_t j = 0; j + 1 < static_cast<uint32_t>(ny_); ++j) {
    for (uint32_t i = 0; i + 1 < row; ++i) {
      const uint32_t a = first + j * row + i;
      mesh.triangle.push_back({a, a + 1, a + row + 1});
      mesh.triangle.push_back({a, a + row + 1, a + row});
      mesh.tag.insert(mesh.tag.end(), 2, Tag{Part::kGround, 0});
    }
  }
}

Eigen::Vector2d HillsideRise(double slope_deg) {
  return Eigen::Vector2d::Constant(std::tan(slope_deg * std::numbers::pi / 180.0) / std::numbers::sqrt2);
}

double RollingHeight(double east, double north, double amplitude_m, uint32_t seed) {
  const FractalShape hills{240.0F, 3, 0.45F};
  return amplitude_m * static_cast<double>(FractalNoise(static_cast<float>(east), static_cast<float>(north), hills, seed, 0.0F));
}

}  // namespace skyquilt::simulate
