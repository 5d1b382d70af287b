#include "evaluate/surface/decks.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/cancel.h"
#include "core/base/order_statistics.h"
#include "core/survey/surface_class.h"

namespace skyquilt::evaluate::surface {
namespace {

constexpr double kProbeStep_m = 0.5;
constexpr size_t kFewestProbes = 8;  // on the deck of a roof

// What the true surface looks like from above.
class TruthFromAbove {
 public:
  TruthFromAbove(const TrueSurface& truth, const raytrace::TracedScene& traced) : truth_(truth), traced_(traced) {
    for (const Eigen::Vector3f& position : truth.position) top_m_ = std::max(top_m_, position.z() + 1.0F);
  }

  struct Top {
    double z_m = std::numeric_limits<double>::quiet_NaN();  // survey ENU; NaN: nothing there
    uint32_t triangle = raytrace::kNoTriangle;
  };
  // The highest surface at up to 16 places.
  std::array<Top, raytrace::kPacket> At(std::span<const Eigen::Vector2d> places) const {
    raytrace::RayPacket rays{};
    for (size_t i = 0; i < places.size(); ++i) {
      const Eigen::Vector2f place = (places[i] - truth_.middle.head<2>()).cast<float>();
      rays.Set(i, {place.x(), place.y(), top_m_}, -Eigen::Vector3f::UnitZ(), 0.0F, std::numeric_limits<float>::infinity());
    }
    const uint32_t hit = traced_.Intersect(rays);
    std::array<Top, raytrace::kPacket> tops;
    for (size_t i = 0; i < places.size(); ++i) {
      if ((hit >> i & 1U) != 0) tops[i] = {truth_.middle.z() + static_cast<double>(top_m_ - rays.t_far[i]), rays.triangle[i]};
    }
    return tops;
  }
  bool IsDeck(const Top& top) const {
    return top.triangle != raytrace::kNoTriangle && truth_.class_id[top.triangle] == static_cast<uint8_t>(survey::SurfaceClass::kRoof) &&
           truth_.Normal(top.triangle).z() >= photos::kLevelRoofNormal;
  }

 private:
  const TrueSurface& truth_;
  const raytrace::TracedScene& traced_;
  float top_m_ = 0.0F;
};

struct Deck {
  photos::RoofArea area;  // survey ENU
  double z_m = 0.0;
};

photos::RoofArea InSurvey(const photos::RoofArea& roof, const geo::Rigid3d& survey_from_truth) {
  photos::RoofArea moved = roof;
  moved.centre = (survey_from_truth * Eigen::Vector3d(roof.centre.x(), roof.centre.y(), 0.0)).head<2>();
  moved.axis = (survey_from_truth.rotation * Eigen::Vector3d(roof.axis.x(), roof.axis.y(), 0.0)).head<2>().normalized();
  return moved;
}

// Height of a deck; NaN when the truth shows hardly any.
double DeckHeight(const photos::RoofArea& area, const TruthFromAbove& above) {
  const Eigen::Vector2d across(-area.axis.y(), area.axis.x());
  std::vector<Eigen::Vector2d> places;
  for (double along = -area.half_m.x() + 0.5 * kProbeStep_m; along < area.half_m.x(); along += kProbeStep_m) {
    for (double aside = -area.half_m.y() + 0.5 * kProbeStep_m; aside < area.half_m.y(); aside += kProbeStep_m) {
      places.push_back(area.centre + along * area.axis + aside * across);
    }
  }
  std::vector<double> heights;
  for (size_t first = 0; first < places.size(); first += raytrace::kPacket) {
    const std::span<const Eigen::Vector2d> some = std::span(places).subspan(first, std::min(raytrace::kPacket, places.size() - first));
    const auto tops = above.At(some);
    for (size_t i = 0; i < some.size(); ++i) {
      if (above.IsDeck(tops[i])) heights.push_back(tops[i].z_m);
    }
  }
  return heights.size() < kFewestProbes ? std::numeric_limits<double>::quiet_NaN() : base::Median(std::move(heights));
}

// Whether there is nothing but deck around a place: probed there, at 4 places around it and at 8 on a wider circle.
bool OnOpenDeck(const Eigen::Vector2d& place, double deck_z_m, const TruthFromAbove& above) {
  std::array<Eigen::Vector2d, 13> probes;
  probes[0] = place;
  for (size_t i = 0; i < 12; ++i) {
    const bool inner = i < 4;
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(inner ? i : i - 4) / (inner ? 4.0 : 8.0);
    probes[i + 1] = place + (inner ? 0.5 : 1.0) * kDeckEdge_m * Eigen::Vector2d(std::cos(angle), std::sin(angle));
  }
  const auto tops = above.At(probes);
  return std::all_of(tops.begin(), tops.begin() + probes.size(),
                     [&](const TruthFromAbove::Top& top) { return std::abs(top.z_m - deck_z_m) <= photos::kDeckTolerance_m; });
}

// Whether the mesh has another surface above the point.
bool IsBelowMesh(const Eigen::Vector3f& point, const raytrace::TracedScene& traced_mesh) {
  constexpr float kClear_m = 0.01F;  // so that the surface of the point itself is not hit
  raytrace::RayPacket rays{};
  rays.Set(0, point, Eigen::Vector3f::UnitZ(), kClear_m, std::numeric_limits<float>::infinity());
  return traced_mesh.Occluded(rays) != 0;
}

}  // namespace

DeckScore ScoreDecks(const SurfaceMesh& mesh, std::span<const SurfaceSample> mesh_samples, const TrueSurface& truth,
                     const raytrace::TracedScene& traced_mesh, const raytrace::TracedScene& traced_truth, std::span<const photos::RoofArea> roofs,
                     double tolerance_m, base::ThreadPool& threads) {
  const TruthFromAbove above(truth, traced_truth);
  std::vector<Deck> decks;
  for (const photos::RoofArea& roof : roofs) {
    const photos::RoofArea area = InSurvey(roof, truth.survey_from_truth);
    const double z_m = DeckHeight(area, above);
    if (std::isfinite(z_m)) decks.push_back({area, z_m});
  }
  DeckScore score;
  if (decks.empty()) return score;
  constexpr int64_t kPerTask = 4096;
  const auto n = static_cast<int64_t>(mesh_samples.size());
  struct Counts {
    int64_t samples = 0, within = 0;
  };
  std::vector<Counts> counts(static_cast<size_t>((n + kPerTask - 1) / kPerTask));
  threads.ParallelFor(static_cast<int64_t>(counts.size()), [&](int64_t task, int) {
    base::ThrowIfCancelled();
    for (int64_t i = task * kPerTask; i < std::min(n, (task + 1) * kPerTask); ++i) {
      const SurfaceSample& sample = mesh_samples[static_cast<size_t>(i)];
      const auto& corner = mesh.triangle[sample.triangle];
      const Eigen::Vector3d a = mesh.position[corner[0]].cast<double>(), b = mesh.position[corner[1]].cast<double>(),
                            c = mesh.position[corner[2]].cast<double>();
      if (!((b - a).cross(c - a).normalized().z() >= kMeshFacesUp)) continue;
      const Eigen::Vector3d point = mesh.middle + sample.point.cast<double>();
      const auto deck = std::find_if(decks.begin(), decks.end(), [&](const Deck& one) { return one.area.Contains(point.head<2>()); });
      if (deck == decks.end()) continue;
      if (std::abs(point.z() - deck->z_m) > kDeckLayers_m && IsBelowMesh(sample.point, traced_mesh)) continue;
      if (!OnOpenDeck(point.head<2>(), deck->z_m, above)) continue;
      Counts& of_task = counts[static_cast<size_t>(task)];
      ++of_task.samples;
      if (std::abs(point.z() - deck->z_m) <= tolerance_m) ++of_task.within;
    }
  });
  int64_t within = 0;
  for (const Counts& one : counts) {
    score.samples += one.samples;
    within += one.within;
  }
  if (score.samples > 0) score.share_within = static_cast<double>(within) / static_cast<double>(score.samples);
  return score;
}

}  // namespace skyquilt::evaluate::surface
