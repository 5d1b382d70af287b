#include "simulate/edge_targets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/gis/map_projection.h"
#include "core/image/srgb.h"
#include "simulate/survey_writer.h"
#include "simulate/target_places.h"

namespace skyquilt::simulate {
namespace {

using Eigen::Vector2d;

constexpr uint64_t kEdgeStream = 82;
constexpr double kLeastSide_m = 4.0, kWidest_px = 60.0;
constexpr std::array<double, 5> kSideShares = {1.0, 0.8, 0.6, 0.4, 0.2};
constexpr double kInside_px = 45.0;  // of photos: so that they see most of the target too
constexpr double kFromNorth_rad = 5.0 * std::numbers::pi / 180.0;
constexpr float kBlackDisplay = 40.0F / 255.0F, kWhiteDisplay = 215.0F / 255.0F;
constexpr double kMargin = 1.15;       // open ground reaches this many half sides beyond the centre
constexpr double kUneven = 0.02;       // of the side, from a plane
constexpr float kLevelEnough = 0.98F;  // cosine of the slope

double SideOf(const TargetPlace& place, double share) {
  return std::max(kLeastSide_m, share * kWidest_px * place.gsd_m);
}

// Of the dividing line, counter-clockwise from east.
double YawAt(const gis::MapProjection& projection, const TargetPlace& place) {
  const Vector2d on_map = projection.EastingNorthing(place.ground.position.cast<double>());
  const Eigen::Vector3d north =
      projection.VerticalLineAt(on_map + Vector2d::UnitY()).start_enu - projection.VerticalLineAt(on_map - Vector2d::UnitY()).start_enu;
  return std::atan2(north.y(), north.x()) + kFromNorth_rad;
}

bool InSun(const World& world, const OpenGround& ground) {
  raytrace::RayPacket ray;
  ray.valid.fill(0);
  ray.Set(0, ground.position + 2e-3F * ground.normal, world.sky().sun_direction(), 4e-3F, 1e6F);
  return world.scene().Occluded(ray) == 0;
}

// Even open ground without roads and shadows below all of a square of this side.
bool IsFreeAndLit(const World& world, const OpenGround& middle, double side_m, double yaw_rad) {
  constexpr int kSteps = 10;
  const Vector2d centre = middle.position.cast<double>().head<2>();
  const Vector2d along = kMargin * 0.5 * side_m / kSteps * Vector2d(std::cos(yaw_rad), std::sin(yaw_rad));
  for (int i = -kSteps; i <= kSteps; ++i) {
    for (int j = -kSteps; j <= kSteps; ++j) {
      const std::optional<OpenGround> ground = OpenGroundAt(world, centre + i * along + j * Vector2d(-along.y(), along.x()));
      if (!ground || !InSun(world, *ground)) return false;
      if (static_cast<double>(std::abs(middle.normal.dot(ground->position - middle.position))) > kUneven * side_m) return false;
      if (world.city() && world.city()->Sample(ground->position.x(), ground->position.y()).kind == GroundKind::kRoad) return false;
    }
  }
  return true;
}

bool Meets(const Vector2d& centre, double side_m, const std::vector<PaintedTarget>& others) {
  return std::any_of(others.begin(), others.end(), [&](const PaintedTarget& other) {
    return (other.centre - centre).norm() < kMargin * (side_m + other.side_m) / std::numbers::sqrt2;
  });
}

// Albedo of level ground in the sun that looks like this in a normally exposed photo, up to what bright paint has.
float AlbedoFor(const World& world, const OpenGround& ground, float display) {
  constexpr float kBrightPaint = 0.9F;
  const float sun = std::max(0.0F, ground.normal.dot(world.sky().sun_direction()));
  const float light = sun * world.sky().sun_over_pi().mean() + world.ambient().Irradiance(ground.position, ground.normal).mean();
  return std::min(image::LinearFromSrgb(display) / (kNormalExposure * light), kBrightPaint);
}

}  // namespace

std::vector<EdgeTarget> ChooseEdgeTargets(const World& world, const PlaceSpec& place, const std::vector<PhotoPlan>& photos,
                                          const geo::EnuFrame& frame, const std::vector<PaintedTarget>& others, int wanted,
                                          base::ThreadPool& threads) {
  if (wanted == 0) return {};
  gis::MapGrid grid;
  grid.georeferenced = true;
  grid.zone = geo::UtmZoneOf(frame.origin());
  const gis::MapProjection projection(frame.origin(), grid);
  const PointViews views(world, place.camera, photos);
  const double border_px = std::min(kInside_px, 0.25 * std::min(place.camera.width, place.camera.height));
  base::Random random(place.seed, kEdgeStream);
  const std::vector<TargetPlace> places = FindTargetPlaces(place, wanted, random, threads, [&](const Vector2d& at) {
    std::optional<TargetPlace> found = TargetPlaceAt(world, place.camera, views, at, border_px);
    if (!found || found->ground.normal.z() < kLevelEnough) return std::optional<TargetPlace>();
    const double yaw_rad = YawAt(projection, *found);
    for (const double share : kSideShares) {
      found->side_m = SideOf(*found, share);
      if (!Meets(at, found->side_m, others) && IsFreeAndLit(world, found->ground, found->side_m, yaw_rad)) return found;
    }
    return std::optional<TargetPlace>();
  });
  std::vector<TargetPlace> wide_enough;
  std::vector<size_t> chosen;
  for (const double share : kSideShares) {
    wide_enough.clear();
    for (TargetPlace one : places) {
      const double side_m = SideOf(one, share);
      if (one.side_m < side_m) continue;
      one.side_m = side_m;
      wide_enough.push_back(std::move(one));
    }
    chosen = FarthestPlaces(wide_enough, place, static_cast<size_t>(wanted));
    if (chosen.size() == static_cast<size_t>(wanted)) break;
  }
  std::vector<EdgeTarget> targets;
  for (const size_t index : chosen) {
    const TargetPlace& at = wide_enough[index];
    EdgeTarget& target = targets.emplace_back();
    target.centre = at.ground.position.cast<double>();
    const float white = AlbedoFor(world, at.ground, kWhiteDisplay);
    target.paint = {.centre = target.centre.head<2>(),
                    .side_m = at.side_m,
                    .yaw_rad = YawAt(projection, at),
                    .pattern = TargetPattern::kTwoHalves,
                    .black = std::min(AlbedoFor(world, at.ground, kBlackDisplay), 0.25F * white),
                    .white = white};
  }
  return targets;
}

void WriteEdgeTargets(const std::vector<EdgeTarget>& targets, const std::filesystem::path& file) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const EdgeTarget& target : targets) {
    list.push_back({{"centre_enu", {target.centre.x(), target.centre.y(), target.centre.z()}},
                    {"side_m", target.paint.side_m},
                    {"yaw_deg", target.paint.yaw_rad * 180.0 / std::numbers::pi},
                    {"black_half", "left of the line through the centre along yaw"}});
  }
  base::WriteFileAtomically(file, base::JsonText(nlohmann::ordered_json{{"targets", std::move(list)}}, 1) + "\n");
}

}  // namespace skyquilt::simulate
