#include "simulate/car.h"

#include <array>
#include <cmath>
#include <numbers>

#include "simulate/noise.h"

namespace skyquilt::simulate {

using Eigen::Vector3f;

namespace {

// Shears what was added from vertex `first` on so that it follows the ground.
void FollowGround(const Car& car, size_t first, Mesh& mesh) {
  const Eigen::Vector2f rise = car.ground_rise.cast<float>();
  const Eigen::Vector2f centre = car.position.cast<float>();
  for (size_t i = first; i < mesh.position.size(); ++i) {
    mesh.position[i].z() += rise.dot(mesh.position[i].head<2>() - centre);
    Vector3f& normal = mesh.normal[i];
    normal.head<2>() -= normal.z() * rise;
    normal.normalize();
  }
}

// A place along the car, across it and above the ground.
class CarFrame {
 public:
  explicit CarFrame(const Car& car)
      : yaw_(static_cast<float>(car.yaw_deg * std::numbers::pi / 180.0)),
        u_(std::cos(yaw_), std::sin(yaw_), 0.0F),
        v_(-u_.y(), u_.x(), 0.0F),
        origin_(static_cast<float>(car.position.x()), static_cast<float>(car.position.y()), static_cast<float>(car.ground_z_m)) {}
  Vector3f operator()(float x, float y, float z) const { return origin_ + x * u_ + y * v_ + Vector3f(0, 0, z); }
  float yaw() const { return yaw_; }

 private:
  float yaw_;
  Vector3f u_, v_, origin_;
};

constexpr auto kHalfTruckLength = static_cast<float>(0.5 * kTruckLength_m);
constexpr auto kHalfTruckWidth = static_cast<float>(0.5 * kTruckWidth_m);
constexpr auto kTruckTop = static_cast<float>(kTruckHeight_m);

void AddSmallCar(const CarFrame& place, uint32_t seed, uint32_t index, Mesh& mesh) {
  const bool van = HashUnit(0, 9, seed) < 0.2F;
  const float half_length = van ? 2.5F : 2.05F + 0.3F * HashUnit(0, 1, seed);
  const float half_width = van ? 0.98F : 0.9F;
  const Tag body{Part::kCarBody, index};
  const Tag glass{Part::kCarGlass, index};
  const Tag tyre{Part::kCarTyre, index};
  mesh.AddBox(place(0, 0, -0.1F), {half_length - 0.35F, half_width - 0.06F, 0}, 0.42F, place.yaw(), tyre, tyre);
  mesh.AddBox(place(0, 0, 0.3F), {half_length, half_width, 0}, van ? 0.8F : 0.55F, place.yaw(), body, body);
  // The cabin: a truncated pyramid with glass sides and a painted top.
  const float z0 = van ? 1.1F : 0.85F;
  const float z1 = van ? 2.0F : 1.45F;
  const float back = van ? -half_length + 0.05F : -half_length + 0.45F;
  const float front = van ? half_length - 0.7F : half_length - 1.25F;
  const float slant = van ? 0.25F : 0.5F;
  const float w0 = half_width - 0.06F;
  const float w1 = half_width - 0.2F;
  const std::array<Vector3f, 4> low = {place(back, -w0, z0), place(front, -w0, z0), place(front, w0, z0), place(back, w0, z0)};
  const std::array<Vector3f, 4> high = {place(back + 0.5F * slant, -w1, z1), place(front - slant, -w1, z1), place(front - slant, w1, z1),
                                        place(back + 0.5F * slant, w1, z1)};
  for (size_t i = 0; i < 4; ++i) {
    const size_t j = (i + 1) % 4;
    mesh.AddQuad(low[i], low[j], high[j], high[i], glass);
  }
  mesh.AddQuad(high[0], high[1], high[2], high[3], body);
}

// A closed body over the rear, and a lower cab in front of it.
void AddTruck(const CarFrame& place, uint32_t index, Mesh& mesh) {
  const Tag body{Part::kCarBody, index}, glass{Part::kCarGlass, index}, tyre{Part::kCarTyre, index};
  constexpr float kCab = 2.2F, kGap = 0.15F, kFloor = 0.7F;
  const float half_load = kHalfTruckLength - 0.5F * (kCab + kGap);
  mesh.AddBox(place(0, 0, -0.2F), {kHalfTruckLength - 0.4F, kHalfTruckWidth - 0.1F, 0}, kFloor + 0.25F, place.yaw(), tyre, tyre);
  mesh.AddBox(place(half_load - kHalfTruckLength, 0, kFloor), {half_load, kHalfTruckWidth, 0}, kTruckTop - kFloor, place.yaw(), body, body);
  const float cab_x = kHalfTruckLength - 0.5F * kCab, cab_width = kHalfTruckWidth - 0.1F;
  mesh.AddBox(place(cab_x, 0, 0.5F), {0.5F * kCab, cab_width, 0}, 1.0F, place.yaw(), body, body);
  mesh.AddBox(place(cab_x, 0, 1.5F), {0.5F * kCab - 0.1F, cab_width - 0.05F, 0}, 0.8F, place.yaw(), glass, body);
  mesh.AddBox(place(cab_x, 0, 2.3F), {0.5F * kCab, cab_width, 0}, 0.35F, place.yaw(), body, body);
}

void AddContainer(const CarFrame& place, uint32_t index, Mesh& mesh) {
  const Tag body{Part::kCarBody, index};
  constexpr float kIntoGround = 0.4F;
  mesh.AddBox(place(0, 0, -kIntoGround), {kHalfTruckLength, kHalfTruckWidth, 0}, kTruckTop + kIntoGround, place.yaw(), body, body);
}

}  // namespace

Car MovingCar::At(double time_s) const {
  const double driven_m = std::fmod(offset_m + speed_mps * time_s, lane_length_m);
  Car car;
  car.position = start + driven_m * direction;
  car.yaw_deg = std::atan2(direction.y(), direction.x()) * 180.0 / std::numbers::pi;
  car.seed = seed;
  return car;
}

void AddCar(const Car& car, uint32_t index, Mesh& mesh) {
  const size_t first = mesh.position.size();
  const CarFrame place(car);
  switch (car.kind) {
    case CarKind::kCar:
      AddSmallCar(place, car.seed, index, mesh);
      break;
    case CarKind::kTruck:
      AddTruck(place, index, mesh);
      break;
    case CarKind::kContainer:
      AddContainer(place, index, mesh);
      break;
  }
  if (!car.ground_rise.isZero()) FollowGround(car, first, mesh);
}

}  // namespace skyquilt::simulate
