#include "worker/lonely_tiles.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace skyquilt::worker {
namespace {

constexpr double kPointsPerCell = 16.0;
constexpr int kMostCells = 256;  // along an axis
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

}  // namespace

PointHeights::PointHeights(const survey::Survey& survey) {
  if (survey.points.empty()) return;
  Eigen::Vector2d low = survey.points.front().x_in_enu.head<2>(), high = low;
  for (const survey::SparsePoint& point : survey.points) {
    low = low.cwiseMin(point.x_in_enu.head<2>());
    high = high.cwiseMax(point.x_in_enu.head<2>());
  }
  const Eigen::Vector2d size = (high - low).cwiseMax(1e-3);
  cell_m_ = std::max(std::sqrt(kPointsPerCell * size.prod() / static_cast<double>(survey.points.size())), size.maxCoeff() / kMostCells);
  columns_ = static_cast<int>(size.x() / cell_m_) + 1;
  rows_ = static_cast<int>(size.y() / cell_m_) + 1;
  min_x_ = low.x();
  min_y_ = low.y();
  std::vector<std::vector<double>> in_cell(static_cast<size_t>(columns_) * static_cast<size_t>(rows_));
  for (const survey::SparsePoint& point : survey.points) {
    const int x = std::min(columns_ - 1, static_cast<int>((point.x_in_enu.x() - min_x_) / cell_m_));
    const int y = std::min(rows_ - 1, static_cast<int>((point.x_in_enu.y() - min_y_) / cell_m_));
    in_cell[static_cast<size_t>(y) * static_cast<size_t>(columns_) + static_cast<size_t>(x)].push_back(point.x_in_enu.z());
  }
  heights_.assign(in_cell.size(), kUnknown);
  for (size_t i = 0; i < in_cell.size(); ++i) {
    std::vector<double>& z = in_cell[i];
    if (z.empty()) continue;
    const auto middle = z.begin() + static_cast<ptrdiff_t>(z.size() / 2);
    std::nth_element(z.begin(), middle, z.end());
    heights_[i] = *middle;
  }
  // Empty cells take the mean of their known neighbours, ring by ring.
  for (bool any = true; any;) {
    any = false;
    const std::vector<double> before = heights_;
    for (int y = 0; y < rows_; ++y) {
      for (int x = 0; x < columns_; ++x) {
        double& height = heights_[static_cast<size_t>(y) * static_cast<size_t>(columns_) + static_cast<size_t>(x)];
        if (!std::isnan(height)) continue;
        double sum = 0.0;
        int known = 0;
        for (int v = std::max(0, y - 1); v <= std::min(rows_ - 1, y + 1); ++v) {
          for (int u = std::max(0, x - 1); u <= std::min(columns_ - 1, x + 1); ++u) {
            const double z = before[static_cast<size_t>(v) * static_cast<size_t>(columns_) + static_cast<size_t>(u)];
            if (std::isnan(z)) continue;
            sum += z;
            ++known;
          }
        }
        if (known > 0) {
          height = sum / known;
          any = true;
        }
      }
    }
  }
}

double PointHeights::At(double x, double y) const {
  const auto along = [&](double position, double min, int count) {
    return static_cast<size_t>(std::clamp(std::floor((position - min) / cell_m_), 0.0, static_cast<double>(count - 1)));
  };
  return heights_[along(y, min_y_, rows_) * static_cast<size_t>(columns_) + along(x, min_x_, columns_)];
}

bool PointHeights::Meet(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, Eigen::Vector3d* x_in_enu) const {
  constexpr double kShallowest = -0.05;  // nearly level rays meet the ground where nobody knows its height
  if (Empty() || !(direction.z() < kShallowest)) return false;
  double height = At(origin.x(), origin.y());
  for (int round = 0; round < 6; ++round) {
    const double t = (height - origin.z()) / direction.z();
    if (!(t > 0.0)) return false;
    *x_in_enu = origin + t * direction;
    const double next = At(x_in_enu->x(), x_in_enu->y());
    if (std::abs(next - height) < 0.05) break;
    height = next;
  }
  return true;
}

std::vector<Tile> LonelyTiles(const RaySource& source, const survey::Survey& survey, const std::vector<int>& photos) {
  const PointHeights heights(survey);
  std::vector<Tile> lonely;
  if (heights.Empty()) return lonely;
  for (const Tile& tile : TrainingTiles(survey, photos)) {
    Eigen::Vector3d origin, direction, x;
    source.RayThrough(tile.photo, source.TileCentre(tile), &origin, &direction);
    if (!heights.Meet(origin, direction, &x)) continue;
    bool seen = false;
    for (const int other : photos) {
      if (other == tile.photo || survey.photos[static_cast<size_t>(other)].is_test) continue;
      const camera::Camera& camera = source.CameraOf(other);
      const Eigen::Vector3d in_cam = survey.photos[static_cast<size_t>(other)].cam_from_enu * x;
      if (!(in_cam.z() > 0.0)) continue;
      const auto pixel = camera.ImgFromCam(in_cam);
      seen = pixel && pixel->x() >= 0.0 && pixel->y() >= 0.0 && pixel->x() < camera.width && pixel->y() < camera.height;
      if (seen) break;
    }
    if (!seen) lonely.push_back(tile);
  }
  return lonely;
}

}  // namespace skyquilt::worker
