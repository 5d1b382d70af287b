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
  const auto yaw = static_cast<float>(car.yaw_deg * std::numbers::pi / 180.0);
  const Vector3f u(std::cos(yaw), std::sin(yaw), 0.0F);
  const Vector3f v(-u.y(), u.x(), 0.0F);
  const Vector3f origin(static_cast<float>(car.position.x()), static_cast<float>(car.position.y()), static_cast<float>(car.ground_z_m));
  const auto Place = [&](float x, float y, float z) { return Vector3f(origin + x * u + y * v + Vector3f(0, 0, z)); };
  const bool van = HashUnit(0, 9, car.seed) < 0.2F;
  const float half_length = van ? 2.5F : 2.05F + 0.3F * HashUnit(0, 1, car.seed);
  const float half_width = van ? 0.98F : 0.9F;
  const Tag body{Part::kCarBody, index};
  const Tag glass{Part::kCarGlass, index};
  const Tag tyre{Part::kCarTyre, index};
  mesh.AddBox(Place(0, 0, -0.1F), {half_length - 0.35F, half_width - 0.06F, 0}, 0.42F, yaw, tyre, tyre);
  mesh.AddBox(Place(0, 0, 0.3F), {half_length, half_width, 0}, van ? 0.8F : 0.55F, yaw, body, body);
  // The cabin: a truncated pyramid with glass sides and a painted top.
  const float z0 = van ? 1.1F : 0.85F;
  const float z1 = van ? 2.0F : 1.45F;
  const float back = van ? -half_length + 0.05F : -half_length + 0.45F;
  const float front = van ? half_length - 0.7F : half_length - 1.25F;
  const float slant = van ? 0.25F : 0.5F;
  const float w0 = half_width - 0.06F;
  const float w1 = half_width - 0.2F;
  const std::array<Vector3f, 4> low = {Place(back, -w0, z0), Place(front, -w0, z0), Place(front, w0, z0), Place(back, w0, z0)};
  const std::array<Vector3f, 4> high = {Place(back + 0.5F * slant, -w1, z1), Place(front - slant, -w1, z1), Place(front - slant, w1, z1),
                                        Place(back + 0.5F * slant, w1, z1)};
  for (size_t i = 0; i < 4; ++i) {
    const size_t j = (i + 1) % 4;
    mesh.AddQuad(low[i], low[j], high[j], high[i], glass);
  }
  mesh.AddQuad(high[0], high[1], high[2], high[3], body);
  if (!car.ground_rise.isZero()) FollowGround(car, first, mesh);
}

}  // namespace skyquilt::simulate
