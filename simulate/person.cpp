#include "simulate/person.h"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <numbers>
#include <tuple>

#include "simulate/noise.h"

namespace skyquilt::simulate {
namespace {

using Eigen::Vector3f;

constexpr float kHips_m = 0.85F, kShoulders_m = 1.42F, kHeadCentre_m = 1.57F;
constexpr float kIntoGround_m = 0.15F;

// A place ahead of an object, to its left and above the ground.
class ObjectFrame {
 public:
  ObjectFrame(const Eigen::Vector2d& position, double ground_z_m, double yaw_deg)
      : yaw_(static_cast<float>(yaw_deg * std::numbers::pi / 180.0)),
        ahead_(std::cos(yaw_), std::sin(yaw_), 0.0F),
        left_(-ahead_.y(), ahead_.x(), 0.0F),
        origin_(static_cast<float>(position.x()), static_cast<float>(position.y()), static_cast<float>(ground_z_m)) {}
  Vector3f operator()(float x, float y, float z) const { return origin_ + x * ahead_ + y * left_ + Vector3f(0, 0, z); }
  float yaw() const { return yaw_; }

 private:
  float yaw_;
  Vector3f ahead_, left_, origin_;
};

// Sides and top of a body with rectangles below and above.
void AddTaper(const ObjectFrame& place, const Eigen::Vector2f& half_low, const Eigen::Vector2f& half_high, float low, float high, Tag tag,
              Mesh& mesh) {
  constexpr std::array<std::array<float, 2>, 4> kCorners = {{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
  std::array<Vector3f, 4> below, above;
  for (size_t i = 0; i < 4; ++i) {
    below[i] = place(kCorners[i][0] * half_low.x(), kCorners[i][1] * half_low.y(), low);
    above[i] = place(kCorners[i][0] * half_high.x(), kCorners[i][1] * half_high.y(), high);
  }
  for (size_t i = 0; i < 4; ++i) mesh.AddQuad(below[i], below[(i + 1) % 4], above[(i + 1) % 4], above[i], tag);
  mesh.AddQuad(above[0], above[1], above[2], above[3], tag);
}

}  // namespace

Person Walker::At(double time_s) const {
  Person person;
  person.position = start + std::fmod(offset_m + speed_mps * time_s, way_m) * direction;
  person.yaw_deg = std::atan2(direction.y(), direction.x()) * 180.0 / std::numbers::pi;
  person.seed = seed;
  return person;
}

void AddPerson(const Person& person, uint32_t index, Mesh& mesh) {
  const ObjectFrame place(person.position, person.ground_z_m, person.yaw_deg);
  const Tag tag{Part::kPerson, index};
  AddTaper(place, {0.12F, 0.17F}, {0.11F, 0.18F}, -kIntoGround_m, kHips_m, tag, mesh);
  AddTaper(place, {0.13F, 0.20F}, {0.11F, 0.25F}, kHips_m, kShoulders_m, tag, mesh);
  mesh.AddSphere(
      1, [&](const Vector3f& unit) { return Vector3f(place(0, 0, kHeadCentre_m) + 0.13F * unit); }, tag);
}

Surface PersonSurface(const Person& person, const Hit& hit) {
  constexpr std::array<std::array<float, 3>, 8> kShirts = {{{0.55F, 0.54F, 0.52F},
                                                            {0.45F, 0.04F, 0.03F},
                                                            {0.04F, 0.10F, 0.36F},
                                                            {0.02F, 0.02F, 0.025F},
                                                            {0.55F, 0.38F, 0.05F},
                                                            {0.06F, 0.22F, 0.09F},
                                                            {0.36F, 0.12F, 0.26F},
                                                            {0.18F, 0.18F, 0.19F}}};
  constexpr std::array<std::array<float, 3>, 3> kTrousers = {{{0.03F, 0.04F, 0.08F}, {0.02F, 0.02F, 0.02F}, {0.20F, 0.16F, 0.11F}}};
  constexpr std::array<std::array<float, 3>, 4> kHair = {
      {{0.02F, 0.015F, 0.012F}, {0.08F, 0.05F, 0.03F}, {0.30F, 0.22F, 0.12F}, {0.25F, 0.25F, 0.25F}}};
  Surface surface;
  surface.normal = hit.normal;
  const float height = hit.position.z() - static_cast<float>(person.ground_z_m);
  const auto pick = [&](const auto& colors, int which) {
    const auto& color = colors[HashCell(which, 5, person.seed) % colors.size()];
    return Vector3f(color[0], color[1], color[2]);
  };
  surface.albedo = height < kHips_m ? pick(kTrousers, 1) : height < kShoulders_m + 0.01F ? pick(kShirts, 2) : pick(kHair, 3);
  return surface;
}

void AddLamp(const Lamp& lamp, uint32_t index, Mesh& mesh) {
  const ObjectFrame place(lamp.position, lamp.ground_z_m, lamp.yaw_deg);
  const auto top = static_cast<float>(lamp.height_m);
  const Tag post{Part::kLampPost, index}, head{Part::kLampHead, index};
  mesh.AddBox(place(0, 0, -0.3F), {0.08F, 0.08F, 0}, top + 0.3F, place.yaw(), post, post);
  // Arm and head are seen from below too.
  for (const auto& [from, to, half, low, high, tag] :
       {std::tuple{0.0F, 1.4F, 0.05F, top - 0.12F, top, post}, std::tuple{0.9F, 1.6F, 0.17F, top - 0.05F, top + 0.1F, head}}) {
    mesh.AddBox(place(0.5F * (from + to), 0, low), {0.5F * (to - from), half, 0}, high - low, place.yaw(), tag, tag);
    mesh.AddQuad(place(from, half, low), place(to, half, low), place(to, -half, low), place(from, -half, low), tag);
  }
}

Surface LampSurface(const Hit& hit) {
  Surface surface;
  surface.normal = hit.normal;
  surface.albedo = hit.tag.part == Part::kLampHead ? Vector3f::Constant(0.45F) : Vector3f(0.10F, 0.11F, 0.11F);
  return surface;
}

}  // namespace skyquilt::simulate
