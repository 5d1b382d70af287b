#include "worker/starting_occupancy.h"

#include <algorithm>
#include <cmath>

namespace skyquilt::worker {
namespace {

constexpr int kGroup = 4;
constexpr float kStartDepth = 0.1F;         // above every threshold for some dozens of refreshes
constexpr float kContextThreshold = 0.02F;  // optical depth of one context step that counts as matter

}  // namespace

void MarkUnseen(const RaySource& source, const survey::Survey& survey, const std::vector<int>& photos, render::TrainedField& target,
                base::ThreadPool& threads) {
  field::OccupancyGrid& grid = target.occupancy;
  const int groups[3] = {(grid.size[0] + kGroup - 1) / kGroup, (grid.size[1] + kGroup - 1) / kGroup, (grid.size[2] + kGroup - 1) / kGroup};
  threads.ParallelFor(groups[2], [&](int64_t gz, int) {
    for (int gy = 0; gy < groups[1]; ++gy) {
      for (int gx = 0; gx < groups[0]; ++gx) {
        const Eigen::Vector3d centre_unit =
            Eigen::Vector3d(gx + 0.5, gy + 0.5, static_cast<double>(gz) + 0.5) * kGroup * static_cast<double>(grid.cell);
        const Eigen::Vector3d centre = target.map.EnuFromUnit(centre_unit.cwiseMin(target.map.extent()));
        const double radius_m =
            0.87 * kGroup * static_cast<double>(grid.cell) / (target.map.units_per_metre() * std::max(1e-6, target.map.LocalScale(centre)));
        bool seen = false;
        for (const int photo : photos) {
          if (survey.photos[static_cast<size_t>(photo)].is_test) continue;
          const camera::Camera& camera = source.CameraOf(photo);
          const Eigen::Vector3d in_cam = survey.photos[static_cast<size_t>(photo)].cam_from_enu * centre;
          if (in_cam.z() < -radius_m) continue;
          if (in_cam.z() <= radius_m) {
            seen = in_cam.norm() < 4.0 * radius_m;  // the group surrounds the camera or nearly so
          } else if (const auto pixel = camera.ImgFromCam(in_cam)) {
            const double slack = camera.FocalX() * radius_m / in_cam.z();
            seen = pixel->x() > -slack && pixel->x() < camera.width + slack && pixel->y() > -slack && pixel->y() < camera.height + slack;
          }
          if (seen) break;
        }
        if (seen) continue;
        for (int z = static_cast<int>(gz) * kGroup; z < std::min(grid.size[2], (static_cast<int>(gz) + 1) * kGroup); ++z) {
          for (int y = gy * kGroup; y < std::min(grid.size[1], (gy + 1) * kGroup); ++y) {
            for (int x = gx * kGroup; x < std::min(grid.size[0], (gx + 1) * kGroup); ++x) {
              grid.depth[static_cast<size_t>(grid.Index(x, y, z))] = -1.0F;
              grid.occupied[static_cast<size_t>(grid.Index(x, y, z))] = 0;
            }
          }
        }
      }
    }
  });
}

void StartFromContext(const survey::Survey& survey, const render::TrainedField& context, render::TrainedField& target, base::ThreadPool& threads) {
  field::OccupancyGrid& grid = target.occupancy;
  const std::vector<uint8_t> seen = grid.occupied;
  std::fill(grid.occupied.begin(), grid.occupied.end(), uint8_t{0});
  threads.ParallelFor(grid.size[2], [&](int64_t z, int) {
    field::ChunkScratch scratch = context.field->MakeScratch();
    const auto rows = static_cast<size_t>(context.field->FeatureRows());
    const int64_t plane = static_cast<int64_t>(grid.size[0]) * grid.size[1];
    std::vector<float> x(field::kChunk), y(field::kChunk), h(field::kChunk);
    std::vector<float> features(rows * field::kChunkStride), geometry(static_cast<size_t>(field::kGeometryRows) * field::kChunkStride);
    for (int64_t begin = 0; begin < plane; begin += field::kChunk) {
      const int64_t n = std::min<int64_t>(field::kChunk, plane - begin);
      for (int64_t i = 0; i < n; ++i) {
        const int64_t cell = begin + i;
        const Eigen::Vector3d unit = Eigen::Vector3d(static_cast<double>(cell % grid.size[0]) + 0.5, static_cast<double>(cell / grid.size[0]) + 0.5,
                                                     static_cast<double>(z) + 0.5) *
                                     static_cast<double>(grid.cell);
        const Eigen::Vector3f p = context.map.UnitFromEnu(target.map.EnuFromUnit(unit));
        x[static_cast<size_t>(i)] = p.x();
        y[static_cast<size_t>(i)] = p.y();
        h[static_cast<size_t>(i)] = p.z();
      }
      std::fill(features.begin(), features.end(), 0.0F);
      context.field->EncodeSerial(context.grid, x.data(), y.data(), h.data(), n, features.data(), field::kChunkStride);
      context.field->Density(context.weights, features.data(), field::kChunkStride, kernel::Padded(n), scratch, geometry.data(), field::kChunkStride);
      for (int64_t i = 0; i < n; ++i) {
        const auto k = static_cast<size_t>(i);
        const bool open = context.occupancy.occupied[static_cast<size_t>(context.occupancy.IndexAt(x[k], y[k], h[k]))] == 0;
        const float depth = std::exp(geometry[k] + static_cast<float>(context.config.density_bias));
        if (!open && depth > kContextThreshold) grid.occupied[static_cast<size_t>(z * plane + begin + i)] = 1;
      }
    }
  });
  for (const survey::SparsePoint& point : survey.points) {
    if ((point.x_in_enu.array() < target.map.min_enu().array()).any() || (point.x_in_enu.array() > target.map.max_enu().array()).any()) continue;
    const Eigen::Vector3f unit = target.map.UnitFromEnu(point.x_in_enu);
    grid.occupied[static_cast<size_t>(grid.IndexAt(unit.x(), unit.y(), unit.z()))] = 1;
  }
  if (grid.OccupiedShare() <= 0.0) grid.occupied = seen;
  // The context is blurred by about one of its own steps.
  const double cell_m = static_cast<double>(grid.cell) / target.map.units_per_metre();
  grid.Dilate(std::clamp(static_cast<int>(std::ceil(context.step_m / cell_m)), 1, 4));
  for (size_t i = 0; i < grid.depth.size(); ++i) {
    if (grid.occupied[i] != 0) grid.depth[i] = kStartDepth;
  }
}

}  // namespace skyquilt::worker
