#include "buildings/classes/classify_points.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "buildings/classes/building_index.h"
#include "buildings/classes/normal_scatter.h"
#include "core/base/cancel.h"

namespace skyquilt::buildings {
namespace {

constexpr double kGroundBand_m = 0.3;
constexpr double kReach_gsd = 3.0;
constexpr double kEdge_gsd = 2.0;
constexpr double kSteep = 0.5;     // |z| of a normal below which a point is steep
constexpr double kAlike = 0.7;     // cosine between a green point's normal and that of a face to which it still belongs
constexpr float kScatter = 0.06F;  // NormalScatter of crowns; planes with a noise of 14 degrees and most cars are below
constexpr int64_t kPointsPerTask = 16384;

double ExcessGreen(const SurfacePoint& point) {
  const int r = point.rgb[0], g = point.rgb[1], b = point.rgb[2];
  return r + g + b > 0 ? static_cast<double>(2 * g - r - b) / (r + g + b) : 0.0;
}

// What a point is by its place; vegetation among the open ones is found by its neighbours.
struct FirstGuess {
  PointClass point_class = PointClass::kOther;
  bool open = false;
};

class Classifier {
 public:
  Classifier(const PointCloud& cloud, const GroundGrid& ground, const BuildingSet& set, const BuildingsOptions& options, base::ThreadPool& threads)
      : cloud_(cloud),
        ground_(ground),
        options_(options),
        gsd_m_(set.gsd_m > 0.0 ? set.gsd_m : cloud.spacing_m),
        index_(set.buildings, kReach_gsd * gsd_m_, threads) {}

  bool IsGreen(const SurfacePoint& point) const { return ExcessGreen(point) > options_.max_green; }

  FirstGuess Guess(size_t i) const {
    const SurfacePoint& point = cloud_.points[i];
    if (!point.position.allFinite() || !point.normal.allFinite()) return {};
    const Eigen::Vector3d x = cloud_.At(i), normal = point.normal.cast<double>();
    const double height = x.z() - ground_.At(x.head<2>());  // NaN: unknown
    const BuildingIndex::Found found = index_.At(x, normal);
    const bool steep = std::abs(normal.z()) < kSteep;
    if (std::abs(height) <= kGroundBand_m + gsd_m_ && !IsFootOfBuilding(found, steep)) return {PointClass::kGround};
    const bool near = found.near.Found() && !(IsGreen(point) && found.near.agreement < kAlike);
    if (near) return {NearClass(found.near)};
    if (!(height > 0.5 * options_.min_height_m)) return {};
    // Parapets, chimneys and boxes, and roofs that the model does not follow.
    if (found.inside_m > 0.0) return {steep ? PointClass::kWall : PointClass::kRoof, true};
    return {PointClass::kOther, true};
  }

 private:
  // Whether a point at the height of the ground is none: walls begin there, and nobody sees the ground below a building. Walls of a model may stand a
  // little off, so that ground just inside a footprint is ground.
  bool IsFootOfBuilding(const BuildingIndex::Found& found, bool steep) const {
    const bool wall = steep && found.near.Found() && found.near.kind == FaceKind::kWall && found.near.agreement > kSteep;
    return wall || found.inside_m > kEdge_gsd * gsd_m_;
  }

  PointClass NearClass(const NearModel& near) const {
    if (near.corner_m <= kEdge_gsd * gsd_m_) return PointClass::kCorner;
    if (near.edge_m <= kEdge_gsd * gsd_m_) return PointClass::kEdge;
    return near.kind == FaceKind::kRoof ? PointClass::kRoof : PointClass::kWall;
  }

  const PointCloud& cloud_;
  const GroundGrid& ground_;
  const BuildingsOptions& options_;
  double gsd_m_;
  BuildingIndex index_;
};

constexpr std::array<const char*, kPointClasses> kNames = {"other", "ground", "roof", "wall", "edge", "corner", "vegetation"};
constexpr std::array<uint8_t, kPointClasses> kLasCodes = {1, 2, 6, 64, 65, 66, 5};

}  // namespace

const char* NameOf(PointClass point_class) {
  return kNames[static_cast<size_t>(point_class)];
}

uint8_t LasCode(PointClass point_class) {
  return kLasCodes[static_cast<size_t>(point_class)];
}

std::vector<PointClass> ClassifyPoints(const PointCloud& cloud, const GroundGrid& ground, const BuildingSet& set, const BuildingsOptions& options,
                                       base::ThreadPool& threads) {
  const Classifier classifier(cloud, ground, set, options, threads);
  const auto n_points = static_cast<int64_t>(cloud.points.size());
  std::vector<PointClass> classes(cloud.points.size(), PointClass::kOther);
  std::vector<uint8_t> is_open(cloud.points.size(), 0);
  threads.ParallelFor((n_points + kPointsPerTask - 1) / kPointsPerTask, [&](int64_t task, int) {
    base::ThrowIfCancelled();
    for (int64_t i = task * kPointsPerTask; i < std::min(n_points, (task + 1) * kPointsPerTask); ++i) {
      const FirstGuess guess = classifier.Guess(static_cast<size_t>(i));
      classes[static_cast<size_t>(i)] = guess.point_class;
      is_open[static_cast<size_t>(i)] = guess.open ? 1 : 0;
    }
  });

  std::vector<uint32_t> open;
  for (uint32_t i = 0; i < is_open.size(); ++i)
    if (is_open[i] != 0) open.push_back(i);
  const std::vector<float> scatter = NormalScatter(cloud, open, threads);
  for (size_t k = 0; k < open.size(); ++k) {
    PointClass& point_class = classes[open[k]];
    const bool green = classifier.IsGreen(cloud.points[open[k]]), scattered = scatter[k] > kScatter;
    // Above a roof only a crown is both; chimneys scatter, and copper domes are green.
    const bool above_roof = point_class != PointClass::kOther;
    if (above_roof ? green && scattered : green || scattered) point_class = PointClass::kVegetation;
  }
  return classes;
}

}  // namespace skyquilt::buildings
