#include "surface/fill_gaps.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "core/base/cancel.h"
#include "core/base/progress.h"
#include "core/base/random.h"
#include "core/raytrace/traced_scene.h"
#include "surface/mesh/mesh_tools.h"
#include "surface/mesh/vectors.h"
#include "surface/texture/tile_geometry.h"

namespace skyquilt::surface {
namespace {

constexpr int kPixelStep = 2;
constexpr double kNearVoxels = 0.5, kSinkVoxels = 0.5;

// A mesh for tracing, relative to a place near it.
class Traced {
 public:
  Traced(const Mesh& mesh, const Eigen::Vector3d& middle) : mesh_(mesh), scene_(PositionsOf(mesh, middle), mesh.triangle) {}

  // Distances to the first triangle that each ray meets, infinite without one; its index, kNoTriangle where it is seen from behind.
  void Trace(raytrace::RayPacket rays, const std::array<Eigen::Vector3d, raytrace::kPacket>& direction, size_t n,
             std::array<double, raytrace::kPacket>* distance_m, std::array<uint32_t, raytrace::kPacket>* triangle) const {
    const uint32_t hit = scene_.Intersect(rays);
    for (size_t lane = 0; lane < n; ++lane) {
      const bool any = (hit >> lane & 1U) != 0;
      (*distance_m)[lane] = any ? static_cast<double>(rays.t_far[lane]) : std::numeric_limits<double>::infinity();
      (*triangle)[lane] = any && IsFront(rays.triangle[lane], direction[lane]) ? rays.triangle[lane] : raytrace::kNoTriangle;
    }
  }

 private:
  static std::vector<Eigen::Vector3f> PositionsOf(const Mesh& mesh, const Eigen::Vector3d& middle) {
    std::vector<Eigen::Vector3f> position;
    position.reserve(mesh.position.size());
    for (const Eigen::Vector3d& x : mesh.position) position.push_back((x - middle).cast<float>());
    return position;
  }
  bool IsFront(uint32_t triangle, const Eigen::Vector3d& direction) const {
    const Triangle& t = mesh_.triangle[triangle];
    return DoubleAreaNormal(mesh_.position[t[0]], mesh_.position[t[1]], mesh_.position[t[2]]).dot(direction) < 0.0;
  }

  const Mesh& mesh_;
  raytrace::TracedScene scene_;
};

// Per triangle of the coarse mesh whether a photo sees it through a gap.
std::vector<uint8_t> SeenThroughGaps(const Mesh& coarse, const Mesh& mesh, double voxel_m, std::span<const DepthView> views,
                                     base::ThreadPool& threads) {
  const Eigen::Vector3d middle = coarse.position.front();
  const Traced traced_coarse(coarse, middle), traced_fine(mesh, middle);
  std::vector<std::atomic<uint8_t>> seen(coarse.triangle.size());
  base::Progress progress("gaps of the surface", static_cast<double>(views.size()), "views");
  for (const DepthView& view : views) {
    progress.Advance();
    if (view.pose.photo < 0) continue;
    base::ThrowIfCancelled();
    const Eigen::Vector3d centre = view.pose.Centre();
    threads.ParallelFor(view.pose.height / kPixelStep, [&](int64_t row, int) {
      const int y = static_cast<int>(row) * kPixelStep;
      constexpr int kStep = kPixelStep * static_cast<int>(raytrace::kPacket);
      for (int first = 0; first < view.pose.width; first += kStep) {
        raytrace::RayPacket rays{};
        std::array<Eigen::Vector3d, raytrace::kPacket> direction;
        size_t n = 0;
        for (int x = first; x < std::min(first + kStep, view.pose.width); x += kPixelStep, ++n) {
          direction[n] = view.pose.DirectionAt(x + 0.5, y + 0.5);
          rays.Set(n, (centre - middle).cast<float>(), direction[n].cast<float>(), 0.0F, std::numeric_limits<float>::infinity());
        }
        std::array<double, raytrace::kPacket> to_coarse, to_fine;
        std::array<uint32_t, raytrace::kPacket> triangle, fine_triangle;
        traced_coarse.Trace(rays, direction, n, &to_coarse, &triangle);
        traced_fine.Trace(rays, direction, n, &to_fine, &fine_triangle);
        for (size_t lane = 0; lane < n; ++lane) {
          if (triangle[lane] == raytrace::kNoTriangle) continue;
          if (fine_triangle[lane] != raytrace::kNoTriangle) {
            if (!(to_fine[lane] > to_coarse[lane] + voxel_m)) continue;
            const size_t pixel = static_cast<size_t>(y) * static_cast<size_t>(view.pose.width) + static_cast<size_t>(first) + lane * kPixelStep;
            if (std::abs(static_cast<double>(view.depth_m[pixel]) - to_fine[lane]) <= voxel_m) continue;
          } else if (to_fine[lane] < to_coarse[lane]) {
            continue;
          }
          seen[triangle[lane]].store(1, std::memory_order_relaxed);
        }
      }
    });
  }
  progress.Finish();
  return {seen.begin(), seen.end()};
}

using Cell = Eigen::Matrix<int64_t, 3, 1>;

// Cells of space around places, and whether a surface runs through them.
class SurfaceCells {
 public:
  SurfaceCells(std::span<const Eigen::Vector3d> places, double cell_m) : cell_m_(cell_m) {
    for (const Eigen::Vector3d& x : places) ForEachAround(x, [this](uint64_t key) { marked_.try_emplace(key, false); });
  }
  void Mark(const Mesh& mesh) {
    for (const Triangle& t : mesh.triangle) {
      const Eigen::Vector3d &a = mesh.position[t[0]], &b = mesh.position[t[1]], &c = mesh.position[t[2]];
      const double longest = std::max({(b - a).norm(), (c - a).norm(), (c - b).norm()});
      if (!std::isfinite(longest)) continue;
      const int n = std::max(1, static_cast<int>(std::ceil(longest / cell_m_)));
      for (int i = 0; i <= n; ++i) {
        for (int j = 0; i + j <= n; ++j) {
          const auto found = marked_.find(KeyOf(CellOf(a + (b - a) * (static_cast<double>(i) / n) + (c - a) * (static_cast<double>(j) / n))));
          if (found != marked_.end()) found->second = true;
        }
      }
    }
  }
  // Whether it runs through the cell of one of the places, or one that touches it.
  bool IsNear(const Eigen::Vector3d& x) const {
    bool near = false;
    ForEachAround(x, [&](uint64_t key) { near = near || marked_.at(key); });
    return near;
  }

 private:
  template <typename F>
  void ForEachAround(const Eigen::Vector3d& x, const F& f) const {
    for (int i = 0; i < 27; ++i) f(KeyOf(CellOf(x) + Cell(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1)));
  }
  Cell CellOf(const Eigen::Vector3d& x) const { return (x / cell_m_).array().floor().matrix().cast<int64_t>(); }
  static uint64_t KeyOf(const Cell& cell) {
    uint64_t key = 0;
    for (const int64_t value : cell) key = base::MixBits(key + static_cast<uint64_t>(value));
    return key;
  }

  double cell_m_;
  std::unordered_map<uint64_t, bool> marked_;
};

// Moves vertices that are near the mesh back behind it.
void SinkRim(const Mesh& mesh, double voxel_m, Mesh* part) {
  const std::vector<Eigen::Vector3d> normal = GeometryOf(*part).vertex_normal;
  SurfaceCells cells(part->position, kNearVoxels * voxel_m);
  cells.Mark(mesh);
  for (size_t v = 0; v < normal.size(); ++v) {
    if (cells.IsNear(part->position[v])) part->position[v] -= kSinkVoxels * voxel_m * normal[v];
  }
}

}  // namespace

double FillGaps(const Mesh& coarse, double voxel_m, std::span<const DepthView> views, base::ThreadPool& threads, Mesh* mesh) {
  if (coarse.triangle.empty()) return 0.0;
  const std::vector<uint8_t> seen = SeenThroughGaps(coarse, *mesh, voxel_m, views, threads);
  // With those that touch them: rays between the pixels see these too.
  std::vector<uint8_t> wanted(coarse.position.size(), 0);
  for (size_t t = 0; t < seen.size(); ++t) {
    if (seen[t] == 0) continue;
    for (const uint32_t v : coarse.triangle[t]) wanted[v] = 1;
  }
  std::vector<Triangle> kept;
  for (const Triangle& t : coarse.triangle) {
    if (wanted[t[0]] + wanted[t[1]] + wanted[t[2]] > 0) kept.push_back(t);
  }
  Mesh part = Compacted(coarse, std::move(kept));
  SinkRim(*mesh, voxel_m, &part);

  uint64_t next_key = NextFilledKey(*mesh);
  const auto first = static_cast<uint32_t>(mesh->position.size());
  for (const Eigen::Vector3d& x : part.position) {
    mesh->position.push_back(x);
    mesh->key.push_back(next_key);
    mesh->views.push_back(0);
    mesh->filled.push_back(1);
    next_key += 2 * kFilledKeyBit;
  }
  for (Triangle t : part.triangle) {
    for (uint32_t& v : t) v += first;
    mesh->triangle.push_back(t);
  }
  return Area(part);
}

}  // namespace skyquilt::surface
