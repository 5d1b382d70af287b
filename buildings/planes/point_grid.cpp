#include "buildings/planes/point_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "core/base/errors.h"

namespace skyquilt::buildings {
namespace {

// Cubes along each axis; one is left free on each side, so that neighbours of the outermost need no test.
constexpr unsigned kBits = 21;
constexpr double kMostCubes = (1U << kBits) - 4.0;

}  // namespace

PointGrid::PointGrid(const PointCloud& cloud, std::span<const uint32_t> chosen, double cell_m) : cloud_(cloud), chosen_(chosen), cell_m_(cell_m) {
  SKYQUILT_CHECK(cell_m > 0.0 && std::isfinite(cell_m), "cell " + std::to_string(cell_m));
  SKYQUILT_CHECK(chosen.size() < std::numeric_limits<uint32_t>::max(), "too many points");
  Eigen::Vector3f high = Eigen::Vector3f::Constant(-std::numeric_limits<float>::infinity());
  low_ = -high;
  for (const uint32_t i : chosen) {
    low_ = low_.cwiseMin(cloud.points[i].position);
    high = high.cwiseMax(cloud.points[i].position);
  }
  if (chosen.empty()) low_ = high = Eigen::Vector3f::Zero();
  SKYQUILT_CHECK(static_cast<double>((high - low_).maxCoeff()) < kMostCubes * cell_m, "the cloud is too large for this reach");
  std::vector<std::pair<Key, uint32_t>> sorted(chosen.size());
  for (size_t p = 0; p < chosen.size(); ++p) sorted[p] = {KeyOf(CellOf(cloud.points[chosen[p]].position)), static_cast<uint32_t>(p)};
  std::sort(sorted.begin(), sorted.end());
  place_.reserve(sorted.size());
  for (const auto& [key, place] : sorted) {
    if (key_.empty() || key_.back() != key) {
      key_.push_back(key);
      first_.push_back(static_cast<uint32_t>(place_.size()));
    }
    place_.push_back(place);
  }
  first_.push_back(static_cast<uint32_t>(place_.size()));
}

Eigen::Vector3i PointGrid::CellOf(const Eigen::Vector3f& position) const {
  return ((position - low_).cast<double>() / cell_m_).array().floor().cast<int>() + 1;
}

PointGrid::Key PointGrid::KeyOf(const Eigen::Vector3i& cell) {
  return (static_cast<Key>(cell.x()) << (2 * kBits)) | (static_cast<Key>(cell.y()) << kBits) | static_cast<Key>(cell.z());
}

void PointGrid::Near(uint32_t place, double reach_m, size_t most, std::vector<Found>* near) const {
  near->clear();
  const Eigen::Vector3f& at = cloud_.points[chosen_[place]].position;
  const Eigen::Vector3i cell = CellOf(at);
  const auto reach_m2 = static_cast<float>(reach_m * reach_m);
  for (int x = cell.x() - 1; x <= cell.x() + 1; ++x) {
    for (int y = cell.y() - 1; y <= cell.y() + 1; ++y) {
      // Cubes above each other follow each other.
      auto key = std::lower_bound(key_.begin(), key_.end(), KeyOf({x, y, cell.z() - 1}));
      const Key last = KeyOf({x, y, cell.z() + 1});
      for (; key != key_.end() && *key <= last; ++key) {
        const auto cube = static_cast<size_t>(key - key_.begin());
        for (uint32_t i = first_[cube]; i < first_[cube + 1]; ++i) {
          const float squared = (cloud_.points[chosen_[place_[i]]].position - at).squaredNorm();
          // The point itself comes first, before others at the same place.
          if (squared <= reach_m2) near->push_back({place_[i] == place ? -1.0F : squared, place_[i]});
        }
      }
    }
  }
  const size_t kept = std::min(most, near->size());
  std::partial_sort(near->begin(), near->begin() + static_cast<std::ptrdiff_t>(kept), near->end());
  near->resize(kept);
  if (!near->empty()) near->front().squared_m2 = 0.0F;
}

}  // namespace skyquilt::buildings
