#include "simulate/simulated_building.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "simulate/noise.h"

namespace skyquilt::simulate {
namespace {

using Eigen::Vector3f;

constexpr float kParapetThickness = 0.25F;
constexpr double kIntoDeck_m = 0.1;  // walls that stand on a deck begin this far below it, so that no light passes

// Converts points from the building's own axes to ENU.
class Placer {
 public:
  explicit Placer(const Building& b) {
    const double yaw = b.yaw_deg * std::numbers::pi / 180.0;
    u_ = Vector3f(static_cast<float>(std::cos(yaw)), static_cast<float>(std::sin(yaw)), 0.0F);
    v_ = Vector3f(-u_.y(), u_.x(), 0.0F);
    origin_ = Vector3f(static_cast<float>(b.centre.x()), static_cast<float>(b.centre.y()), static_cast<float>(b.ground_z_m));
    yaw_ = static_cast<float>(yaw);
  }
  Vector3f operator()(float x, float y, float z) const { return origin_ + x * u_ + y * v_ + Vector3f(0.0F, 0.0F, z); }
  float yaw() const { return yaw_; }

 private:
  Vector3f u_, v_, origin_;
  float yaw_;
};

void AddWalls(const Placer& place, float hl, float hw, float bottom, float eave, Tag tag, Mesh& mesh) {
  const std::array<std::array<float, 2>, 4> corner = {{{-hl, -hw}, {hl, -hw}, {hl, hw}, {-hl, hw}}};
  for (size_t i = 0; i < 4; ++i) {
    const auto& a = corner[i];
    const auto& b = corner[(i + 1) % 4];
    mesh.AddQuad(place(a[0], a[1], bottom), place(b[0], b[1], bottom), place(b[0], b[1], eave), place(a[0], a[1], eave), tag);
  }
}

// The two triangles of a gable's roof behind its -x end, up to where its ridge meets the slope of the other roof.
void AddRunOn(const Building& b, const Placer& place, float hl, float hw, float eave, float ridge, Tag roof, Mesh& mesh) {
  const auto onto_eave = static_cast<float>(b.onto_eave_height_m);
  if (b.onto_rise <= 0.0 || ridge <= onto_eave) return;
  const float reach = (ridge - onto_eave) / static_cast<float>(b.onto_rise);
  // The roof meets the wall below the other eave farther out.
  const float y = hw * std::min((ridge - onto_eave) / (ridge - eave), 1.0F);
  const float z = std::max(onto_eave, eave);
  mesh.AddTriangle(place(-hl, -y, z), place(-hl, 0, ridge), place(-hl - reach, 0, ridge), roof);
  mesh.AddTriangle(place(-hl, y, z), place(-hl - reach, 0, ridge), place(-hl, 0, ridge), roof);
}

void AddGableRoof(const Building& b, const Placer& place, float hl, float hw, float eave, float ridge, uint32_t index, Mesh& mesh) {
  const float slope = (ridge - eave) / hw;
  const auto overhang = static_cast<float>(b.overhang_m);
  const auto Reach = [&](size_t side) { return (side % 2 == 0 ? hl : hw) + (b.shared[side] ? 0.0F : overhang); };
  const auto Low = [&](size_t side) { return b.shared[side] ? eave : eave - slope * overhang; };
  const float right = Reach(0), back = Reach(1), left = -Reach(2), front = -Reach(3);
  const Tag roof{Part::kPitchedRoof, index};
  mesh.AddQuad(place(left, front, Low(3)), place(right, front, Low(3)), place(right, 0, ridge), place(left, 0, ridge), roof);
  mesh.AddQuad(place(right, back, Low(1)), place(left, back, Low(1)), place(left, 0, ridge), place(right, 0, ridge), roof);
  AddRunOn(b, place, hl, hw, eave, ridge, roof, mesh);
  const Tag wall{Part::kWall, index};
  mesh.AddTriangle(place(hl, -hw, eave), place(hl, hw, eave), place(hl, 0, ridge), wall);
  mesh.AddTriangle(place(-hl, hw, eave), place(-hl, -hw, eave), place(-hl, 0, ridge), wall);
}

void AddHipRoof(const Building& b, const Placer& place, float hl, float hw, float eave, float ridge, uint32_t index, Mesh& mesh) {
  const float slope = (ridge - eave) / hw;
  const auto overhang = static_cast<float>(b.overhang_m);
  const float x = hl + overhang;
  const float y = hw + overhang;
  const float low = eave - slope * overhang;
  const float end = std::max(hl - hw, 0.0F);
  const Tag roof{Part::kPitchedRoof, index};
  mesh.AddQuad(place(-x, -y, low), place(x, -y, low), place(end, 0, ridge), place(-end, 0, ridge), roof);
  mesh.AddQuad(place(x, y, low), place(-x, y, low), place(-end, 0, ridge), place(end, 0, ridge), roof);
  mesh.AddTriangle(place(x, -y, low), place(x, y, low), place(end, 0, ridge), roof);
  mesh.AddTriangle(place(-x, y, low), place(-x, -y, low), place(-end, 0, ridge), roof);
}

void AddFlatRoof(const Building& b, const Placer& place, float hl, float hw, float deck, uint32_t index, Mesh& mesh) {
  const Tag roof{Part::kFlatRoof, index};
  mesh.AddQuad(place(-hl, -hw, deck), place(hl, -hw, deck), place(hl, hw, deck), place(-hl, hw, deck), roof);
  const auto parapet = static_cast<float>(b.parapet_height_m);
  if (parapet > 0.0F) {
    const Tag edge{Part::kParapet, index};
    const float t = 0.5F * kParapetThickness;
    for (const float side : {-1.0F, 1.0F}) {
      if (!b.shared[side > 0.0F ? 1 : 3]) mesh.AddBox(place(0, side * (hw - t), deck), {hl, t, 0}, parapet, place.yaw(), edge, edge);
      if (!b.shared[side > 0.0F ? 0 : 2]) mesh.AddBox(place(side * (hl - t), 0, deck), {t, hw - 2.0F * t, 0}, parapet, place.yaw(), edge, edge);
    }
  }
  if (b.kind == BuildingKind::kShed || b.kind == BuildingKind::kGarage || b.bare_roof) return;
  const Tag box{Part::kRooftopBox, index};
  // Stair housing and machines are off the centre, so that the height of the deck can be measured there.
  mesh.AddBox(place(0.28F * hl + 1.6F, 0.3F * hw, deck), {1.7F, 1.5F, 0}, 2.4F, place.yaw(), box, box);
  const int n_units = 2 + static_cast<int>(HashCell(1, 0, b.seed) % 4U);
  for (int i = 0; i < n_units; ++i) {
    const float x = -0.85F * hl + 0.6F * hl * HashUnit(i, 1, b.seed);
    const float y = (HashUnit(i, 2, b.seed) - 0.5F) * 1.4F * hw;
    mesh.AddBox(place(x, y, deck), {0.6F + 0.6F * HashUnit(i, 3, b.seed), 0.5F + 0.4F * HashUnit(i, 4, b.seed), 0},
                0.7F + 0.7F * HashUnit(i, 5, b.seed), place.yaw(), box, box);
  }
}

}  // namespace

const char* KindName(BuildingKind kind) {
  switch (kind) {
    case BuildingKind::kHouse:
      return "house";
    case BuildingKind::kShed:
      return "shed";
    case BuildingKind::kApartment:
      return "apartment";
    case BuildingKind::kTower:
      return "tower";
    case BuildingKind::kHall:
      return "hall";
    case BuildingKind::kGarage:
      return "garage";
  }
  return "";
}

const char* RoofName(RoofKind roof) {
  switch (roof) {
    case RoofKind::kFlat:
      return "flat";
    case RoofKind::kGable:
      return "gable";
    case RoofKind::kHip:
      return "hip";
  }
  return "";
}

const char* ShapeName(BuildingShape shape) {
  switch (shape) {
    case BuildingShape::kRectangle:
      return "rectangle";
    case BuildingShape::kL:
      return "l";
    case BuildingShape::kT:
      return "t";
    case BuildingShape::kSetback:
      return "setback";
    case BuildingShape::kRow:
      return "row";
    case BuildingShape::kCourtyard:
      return "courtyard";
  }
  return "";
}

Eigen::Vector2d Building::Axis() const {
  const double yaw = yaw_deg * std::numbers::pi / 180.0;
  return {std::cos(yaw), std::sin(yaw)};
}

Vector3f Building::Local(const Vector3f& x_in_enu, const Eigen::Vector2f& axis) const {
  const float x = x_in_enu.x() - static_cast<float>(centre.x());
  const float y = x_in_enu.y() - static_cast<float>(centre.y());
  return {axis.x() * x + axis.y() * y, axis.x() * y - axis.y() * x, x_in_enu.z() - static_cast<float>(ground_z_m)};
}

double Building::DistanceTo(const Eigen::Vector2d& point) const {
  const Eigen::Vector3f local = Local({static_cast<float>(point.x()), static_cast<float>(point.y()), 0.0F});
  const double dx = std::abs(static_cast<double>(local.x())) - 0.5 * length_m;
  const double dy = std::abs(static_cast<double>(local.y())) - 0.5 * width_m;
  return std::hypot(std::max(dx, 0.0), std::max(dy, 0.0)) + std::min(std::max(dx, dy), 0.0);
}

double Clearance(const Building& a, const Building& b) {
  // The gap between the shadows of both on the axes of either; one of the axes separates them if they are apart.
  double widest = -std::numeric_limits<double>::infinity();
  for (const Building* one : {&a, &b}) {
    const Eigen::Vector2d u = one->Axis();
    for (const Eigen::Vector2d& axis : {u, Eigen::Vector2d(-u.y(), u.x())}) {
      double gap = std::abs(axis.dot(b.centre - a.centre));
      for (const Building* of : {&a, &b}) {
        const Eigen::Vector2d v = of->Axis();
        gap -= 0.5 * (of->length_m * std::abs(axis.dot(v)) + of->width_m * std::abs(axis.x() * v.y() - axis.y() * v.x()));
      }
      widest = std::max(widest, gap);
    }
  }
  return widest;
}

void AddBuilding(const Building& b, uint32_t index, Mesh& mesh) {
  const Placer place(b);
  const auto hl = static_cast<float>(0.5 * b.length_m);
  const auto hw = static_cast<float>(0.5 * b.width_m);
  const auto eave = static_cast<float>(b.eave_height_m);
  const auto ridge = static_cast<float>(b.ridge_height_m);
  const auto bottom = static_cast<float>(b.base_height_m > 0.0 ? b.base_height_m - kIntoDeck_m : -b.foundation_m);
  AddWalls(place, hl, hw, bottom, eave, {Part::kWall, index}, mesh);
  switch (b.roof) {
    case RoofKind::kFlat:
      AddFlatRoof(b, place, hl, hw, eave, index, mesh);
      break;
    case RoofKind::kGable:
      AddGableRoof(b, place, hl, hw, eave, ridge, index, mesh);
      break;
    case RoofKind::kHip:
      AddHipRoof(b, place, hl, hw, eave, ridge, index, mesh);
      break;
  }
  if (b.kind == BuildingKind::kHouse && b.roof != RoofKind::kFlat && !b.bare_roof) {
    const Tag chimney{Part::kChimney, index};
    mesh.AddBox(place(0.45F * std::max(hl - hw, 1.5F) + 0.5F, 0.22F * hw, eave), {0.4F, 0.35F, 0}, ridge - eave + 0.5F, place.yaw(), chimney,
                chimney);
  }
}

}  // namespace skyquilt::simulate
