#include "bench/study/true_rays.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

namespace skyquilt::bench {
namespace {

// Rays to photos start this far from the surface, so that they do not hit the triangle that they leave. Positions have single precision.
constexpr float kClearance_m = 0.005F;
constexpr uint8_t kGrey = 128;

}  // namespace

TrueRays::TrueRays(evaluate::surface::TrueSurface truth, const survey::Survey& survey, const image::PixelCache* pixels)
    : truth_(std::move(truth)), traced_(truth_.position, truth_.triangle), pixels_(pixels) {
  if (pixels == nullptr) return;
  Eigen::Vector2d high = Eigen::Vector2d::Constant(-std::numeric_limits<double>::infinity());
  low_ = -high;
  for (size_t i = 0; i < survey.photos.size(); ++i) {
    const survey::Photo& photo = survey.photos[i];
    const camera::Camera& camera = survey.cameras[static_cast<size_t>(photo.camera)];
    if (photo.is_test || !camera.Problem().empty()) continue;
    const Eigen::Vector3d centre = photo.cam_from_enu.OriginInSource();
    cameras_.push_back({camera.Resized(pixels->Width(i), pixels->Height(i)), photo.cam_from_enu, centre, i});
    low_ = low_.cwiseMin(centre.head<2>());
    high = high.cwiseMax(centre.head<2>());
  }
  if (cameras_.empty()) return;
  cell_m_ = ((high - low_) / kCells).cwiseMax(1e-3);
  for (int row = 0; row < kCells; ++row) {
    for (int column = 0; column < kCells; ++column) {
      const Eigen::Vector2d middle = low_ + Eigen::Vector2d((column + 0.5) * cell_m_.x(), (row + 0.5) * cell_m_.y());
      std::vector<size_t>& order = nearest_.emplace_back(cameras_.size());
      std::iota(order.begin(), order.end(), size_t{0});
      std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
        return (cameras_[a].centre.head<2>() - middle).squaredNorm() < (cameras_[b].centre.head<2>() - middle).squaredNorm();
      });
      order.resize(std::min(order.size(), kCandidates));
    }
  }
}

const std::vector<size_t>& TrueRays::Nearest(const Eigen::Vector3d& x_in_enu) const {
  const auto index = [&](Eigen::Index axis) {
    return static_cast<size_t>(std::clamp((x_in_enu[axis] - low_[axis]) / cell_m_[axis], 0.0, static_cast<double>(kCells - 1)));
  };
  return nearest_[index(1) * kCells + index(0)];
}

std::optional<TrueRays::Rgb> TrueRays::ColorIn(const Camera& camera, const Eigen::Vector3d& x_in_enu) const {
  const std::optional<Eigen::Vector2d> at = camera.camera.ImgFromCam(camera.cam_from_enu * x_in_enu);
  if (!at || !(at->x() >= 0.0 && at->y() >= 0.0 && at->x() < camera.camera.width && at->y() < camera.camera.height)) return std::nullopt;
  const size_t pixel = static_cast<size_t>(at->y()) * static_cast<size_t>(camera.camera.width) + static_cast<size_t>(at->x());
  Rgb rgb{};
  if (!pixels_->Pixel(camera.photo, pixel, rgb.data())) return std::nullopt;
  return rgb;
}

void TrueRays::CastPacket(std::span<const render::Ray> rays, std::span<render::RayColor> seen) const {
  raytrace::RayPacket packet{};
  for (size_t lane = 0; lane < rays.size(); ++lane) {
    const render::Ray& ray = rays[lane];
    packet.Set(lane, (ray.origin_enu - truth_.middle).cast<float>(), ray.direction_enu.cast<float>(), static_cast<float>(std::max(ray.t_near, 0.0)),
               static_cast<float>(ray.t_far));
  }
  traced_.Intersect(packet);

  std::array<Eigen::Vector3d, raytrace::kPacket> point;
  std::array<Eigen::Vector3f, raytrace::kPacket> start;
  std::array<Rgb, raytrace::kPacket> color;
  std::vector<size_t> waiting;  // lanes without a colour
  for (size_t lane = 0; lane < rays.size(); ++lane) {
    const render::Ray& ray = rays[lane];
    constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
    seen[lane] = {};
    seen[lane].depth = seen[lane].depth_median = seen[lane].depth_front = seen[lane].depth_back = kNone;
    if (packet.triangle[lane] == raytrace::kNoTriangle) continue;
    const float t = packet.t_far[lane];
    seen[lane].opacity = 1.0F;
    seen[lane].depth = seen[lane].depth_median = seen[lane].depth_front = seen[lane].depth_back = t;
    color[lane].fill(kGrey);
    point[lane] = ray.origin_enu + static_cast<double>(t) * ray.direction_enu;
    Eigen::Vector3d normal = truth_.Normal(packet.triangle[lane]);
    if (normal.dot(ray.direction_enu) > 0.0) normal = -normal;
    start[lane] = (point[lane] - truth_.middle).cast<float>() + kClearance_m * normal.cast<float>();
    waiting.push_back(lane);
  }
  const std::vector<size_t> hits = waiting;
  for (size_t k = 0; k < std::min(kCandidates, cameras_.size()) && !waiting.empty(); ++k) {
    raytrace::RayPacket ways{};
    std::array<std::optional<Rgb>, raytrace::kPacket> offered;
    for (const size_t lane : waiting) {
      const Camera& camera = cameras_[Nearest(point[lane])[k]];
      offered[lane] = ColorIn(camera, point[lane]);
      if (!offered[lane]) continue;
      const Eigen::Vector3f way = (camera.centre - truth_.middle).cast<float>() - start[lane];
      const float distance_m = way.norm();
      ways.Set(lane, start[lane], way / std::max(distance_m, std::numeric_limits<float>::min()), 0.0F, distance_m);
    }
    const uint32_t hidden = traced_.Occluded(ways);
    std::erase_if(waiting, [&](size_t lane) {
      if (!offered[lane] || ((hidden >> lane) & 1U) != 0) return false;
      color[lane] = *offered[lane];
      return true;
    });
  }
  for (const size_t lane : hits) {
    for (size_t c = 0; c < 3; ++c) seen[lane].rgb_srgb[c] = static_cast<float>(color[lane][c]) / 255.0F;
  }
}

void TrueRays::Cast(std::span<const render::Ray> rays, std::span<render::RayColor> seen, base::ThreadPool& threads) const {
  constexpr size_t kPerTask = 64 * raytrace::kPacket;
  threads.ParallelFor(static_cast<int64_t>((rays.size() + kPerTask - 1) / kPerTask), [&](int64_t task, int /*thread*/) {
    const size_t first = static_cast<size_t>(task) * kPerTask, end = std::min(rays.size(), first + kPerTask);
    for (size_t at = first; at < end; at += raytrace::kPacket) {
      const size_t n = std::min(raytrace::kPacket, end - at);
      CastPacket(rays.subspan(at, n), seen.subspan(at, n));
    }
  });
}

}  // namespace skyquilt::bench
