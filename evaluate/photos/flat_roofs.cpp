#include "evaluate/photos/flat_roofs.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/order_statistics.h"
#include "core/linear/linear.h"
#include "core/survey/surface_class.h"

namespace skyquilt::evaluate::photos {

using Eigen::Vector2d;
using Eigen::Vector3d;

bool RoofArea::Contains(const Vector2d& point) const {
  const Vector2d from_centre = point - centre;
  const Vector2d across(-axis.y(), axis.x());
  return std::abs(axis.dot(from_centre)) <= half_m.x() && std::abs(across.dot(from_centre)) <= half_m.y();
}

std::vector<RoofArea> ReadFlatRoofs(const std::filesystem::path& buildings_json) {
  std::vector<RoofArea> roofs;
  try {
    const nlohmann::json json = base::ParseJson(base::ReadFile(buildings_json));
    for (const nlohmann::json& building : json.at("buildings")) {
      if (building.at("roof").get<std::string>() != "flat") continue;
      // A deck under another part of its building: little of it is seen, and its points are not told from those of the deck above.
      if (building.contains("carries") && !building["carries"].empty()) continue;
      const double yaw = building.at("yaw_deg").get<double>() * std::numbers::pi / 180.0;
      RoofArea roof;
      roof.centre = {building.at("east_m").get<double>(), building.at("north_m").get<double>()};
      roof.axis = {std::cos(yaw), std::sin(yaw)};
      roof.half_m = {0.5 * building.at("length_m").get<double>() - kRoofRim_m, 0.5 * building.at("width_m").get<double>() - kRoofRim_m};
      if (roof.half_m.minCoeff() > 0.0) roofs.push_back(roof);
    }
  } catch (const nlohmann::json::exception& error) {
    throw base::InputError(buildings_json, std::string("is damaged (") + error.what() + ")", "Run 'skyquilt simulate' again");
  }
  return roofs;
}

PlaneSpread SpreadAboutPlane(std::span<const Vector3d> points) {
  if (points.size() < 3) return {};
  Vector3d mean = Vector3d::Zero();
  for (const Vector3d& point : points) mean += point;
  mean /= static_cast<double>(points.size());
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  Vector2d with_height = Vector2d::Zero();
  for (const Vector3d& point : points) {
    const Vector3d step = point - mean;
    spread += step.head<2>() * step.head<2>().transpose();
    with_height += step.z() * step.head<2>();
  }
  // Points on a line leave a slope open; the damping takes the smaller one.
  spread += Eigen::Matrix2d::Identity() * (1e-12 * spread.trace() + std::numeric_limits<double>::min());
  const Vector2d slope = linear::SolveSymmetric(spread, with_height);
  double squares = 0.0;
  std::vector<double> off_m;
  for (const Vector3d& point : points) {
    const Vector3d step = point - mean;
    off_m.push_back(step.z() - slope.dot(step.head<2>()));
    squares += off_m.back() * off_m.back();
  }
  return {.rms_m = std::sqrt(squares / static_cast<double>(points.size())), .nmad_m = base::Nmad(std::move(off_m))};
}

void FlatRoofPoints::Add(const HeldOutPhoto& task, const PhotoResult& findings) {
  if (areas_.empty() || findings.true_class.Empty() || findings.true_depth.Empty() || findings.true_normals.Empty()) return;
  const geo::Rigid3d enu_from_cam = task.cam_from_enu.Inverse();
  size_t last = 0;  // neighbouring pixels are mostly on the same roof
  for (int y = 0; y < findings.scored.height; ++y) {
    for (int x = 0; x < findings.scored.width; ++x) {
      if (*findings.scored.At(x, y) == 0 || *findings.true_class.At(x, y) != static_cast<uint8_t>(survey::SurfaceClass::kRoof)) continue;
      const double up = static_cast<double>(findings.true_normals.At(x, y)[2]);
      const double rendered_m = static_cast<double>(*findings.z_depth.At(x, y)), true_m = static_cast<double>(*findings.true_depth.At(x, y));
      if (!(up >= kLevelRoofNormal) || !std::isfinite(rendered_m) || !std::isfinite(true_m)) continue;
      const Vector3d ray = task.camera.RayFromImg({x + 0.5, y + 0.5});
      const Vector3d true_point = enu_from_cam * Vector3d(ray * (true_m / ray.z()));
      for (size_t tried = 0; tried < areas_.size(); ++tried) {
        const size_t roof = (last + tried) % areas_.size();
        if (!areas_[roof].Contains(true_point.head<2>())) continue;
        points_[roof].push_back({enu_from_cam * Vector3d(ray * (rendered_m / ray.z())), true_point.z()});
        last = roof;
        break;
      }
    }
  }
}

void FlatRoofPoints::Save(base::BytePacker* out) const {
  out->AddCount(points_.size());
  for (const std::vector<RoofPoint>& roof : points_) {
    out->AddCount(roof.size());
    for (const RoofPoint& point : roof) out->Add(std::array{point.rendered.x(), point.rendered.y(), point.rendered.z(), point.true_z_m});
  }
}

void FlatRoofPoints::Load(base::ByteUnpacker* in) {
  using Numbers = std::array<double, 4>;
  if (in->TakeCount(sizeof(uint64_t)) != areas_.size()) in->Fail();
  for (std::vector<RoofPoint>& roof : points_) {
    roof.resize(in->TakeCount(sizeof(Numbers)));
    for (RoofPoint& point : roof) {
      const auto [x, y, z, true_z_m] = in->Take<Numbers>();
      point = {.rendered = {x, y, z}, .true_z_m = true_z_m};
    }
  }
}

FlatRoofScore FlatRoofPoints::Result() const {
  std::vector<double> rms_m, nmad_m;
  for (const std::vector<RoofPoint>& roof : points_) {
    std::vector<double> heights_m;
    for (const RoofPoint& point : roof) heights_m.push_back(point.true_z_m);
    // Most of a roof is deck, so the median is its height, also in a survey that the geo-reference has put too high or too low.
    const double deck_z_m = base::Median(std::move(heights_m));
    std::vector<Vector3d> on_deck;
    for (const RoofPoint& point : roof) {
      if (std::abs(point.true_z_m - deck_z_m) <= kDeckTolerance_m) on_deck.push_back(point.rendered);
    }
    if (on_deck.size() < kFewestRoofPoints) continue;
    const PlaneSpread spread = SpreadAboutPlane(on_deck);
    rms_m.push_back(spread.rms_m);
    nmad_m.push_back(spread.nmad_m);
  }
  FlatRoofScore score;
  score.roofs = static_cast<int>(rms_m.size());
  score.spread = {.rms_m = base::Median(std::move(rms_m)), .nmad_m = base::Median(std::move(nmad_m))};
  return score;
}

}  // namespace skyquilt::evaluate::photos
