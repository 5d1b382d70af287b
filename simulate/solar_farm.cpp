#include "simulate/solar_farm.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "simulate/noise.h"

namespace skyquilt::simulate {
namespace {

using Eigen::Vector3f;

constexpr float kTilt_rad = 25.0F * std::numbers::pi_v<float> / 180.0F;
constexpr float kTableWidth_m = 4.0F;   // up the slope: two panels
constexpr float kLowEdge_m = 0.8F;      // above the ground
constexpr float kThickness_m = 0.06F;   // of the panels
constexpr float kPostPitch_m = 8.0F;    // of the posts below a table
constexpr float kPostHalf_m = 0.06F;    // half their width
constexpr float kPanelWidth_m = 1.0F;   // along the row
constexpr float kPanelLength_m = 2.0F;  // up the slope
constexpr float kFrame_m = 0.06F;       // both frames where two panels meet

// A table's middle is at `middle` east and north; its southern edge is low.
void AddTable(const Eigen::Vector2f& middle, float ground_z_m, Mesh& mesh) {
  const Tag panel{Part::kSolarPanel, 0}, frame{Part::kSolarFrame, 0};
  const float half_reach = 0.5F * kTableWidth_m * std::cos(kTilt_rad);
  const float rise = kTableWidth_m * std::sin(kTilt_rad);
  const auto corner = [&](float along, float up, float below) {
    return Vector3f(middle.x() + along * 0.5F * kTableLength_m, middle.y() + (2.0F * up - 1.0F) * half_reach,
                    ground_z_m + kLowEdge_m + up * rise - below);
  };
  const std::array<Vector3f, 4> top = {corner(-1, 0, 0), corner(1, 0, 0), corner(1, 1, 0), corner(-1, 1, 0)};
  const std::array<Vector3f, 4> bottom = {corner(-1, 0, kThickness_m), corner(1, 0, kThickness_m), corner(1, 1, kThickness_m),
                                          corner(-1, 1, kThickness_m)};
  mesh.AddQuad(top[0], top[1], top[2], top[3], panel);
  mesh.AddQuad(bottom[3], bottom[2], bottom[1], bottom[0], frame);
  for (size_t i = 0; i < 4; ++i) {
    const size_t j = (i + 1) % 4;
    mesh.AddQuad(bottom[i], bottom[j], top[j], top[i], frame);
  }
  constexpr float kIntoGround_m = 0.3F;
  for (float along = -kPostPitch_m; along <= kPostPitch_m; along += kPostPitch_m) {
    const Vector3f foot(middle.x() + along, middle.y(), ground_z_m - kIntoGround_m);
    mesh.AddBox(foot, {kPostHalf_m, kPostHalf_m, 0.0F}, kIntoGround_m + kLowEdge_m + 0.5F * rise - kThickness_m, 0.0F, frame, frame);
  }
}

// Distance to the nearest multiple of `pitch`.
float ToMultiple(float x, float pitch) {
  return std::abs(x - pitch * std::round(x / pitch));
}

}  // namespace

void AddSolarTables(const Eigen::Vector2d& min, const Eigen::Vector2d& max, const std::function<float(float east, float north)>& ground, Mesh& mesh) {
  const auto first = [](double low, float pitch) { return static_cast<int>(std::ceil(low / static_cast<double>(pitch) + 0.5)); };
  const auto last = [](double high, float pitch) { return static_cast<int>(std::floor(high / static_cast<double>(pitch) - 0.5)); };
  for (int row = first(min.y(), kRowPitch_m); row <= last(max.y(), kRowPitch_m); ++row) {
    for (int column = first(min.x(), kTablePitch_m); column <= last(max.x(), kTablePitch_m); ++column) {
      const Eigen::Vector2f middle(static_cast<float>(column) * kTablePitch_m, static_cast<float>(row) * kRowPitch_m);
      AddTable(middle, ground(middle.x(), middle.y()), mesh);
    }
  }
}

Surface SolarTableSurface(const Hit& hit) {
  Surface surface;
  surface.normal = hit.normal;
  if (hit.tag.part == Part::kSolarFrame) {
    surface.albedo = Vector3f(0.45F, 0.46F, 0.47F);
    return surface;
  }
  // Places along the row and up the slope from the middle of the table, where panels meet.
  const float column = std::round(hit.position.x() / kTablePitch_m), row = std::round(hit.position.y() / kRowPitch_m);
  const float along = hit.position.x() - kTablePitch_m * column;
  const float up = (hit.position.y() - kRowPitch_m * row) / std::cos(kTilt_rad);
  const float w = SurfaceFootprint(hit);
  const float half = 0.5F * kFrame_m;
  const float frame = std::max(Bar(ToMultiple(along, kPanelWidth_m), -half, half, w), Bar(ToMultiple(up, kPanelLength_m), -half, half, w));
  const Vector3f cells(0.012F, 0.018F, 0.042F), metal(0.50F, 0.51F, 0.52F);
  surface.albedo = cells + frame * (metal - cells);
  surface.mirror = 0.02F;
  surface.mirror_normal = hit.normal;
  return surface;
}

Surface FarmGround(const Hit& hit, uint32_t seed) {
  const float x = hit.position.x(), y = hit.position.y(), w = SurfaceFootprint(hit);
  Surface surface;
  surface.normal = hit.normal;
  // Patches of bare soil, and tufts: the only thing that tells one gap between rows from another.
  const float bare = Smoothstep(0.1F, 0.9F, FractalNoise(x, y, {7.0F, 4, 0.6F}, seed + 100U, w));
  const float tone = 1.0F + 0.25F * FractalNoise(x, y, {1.8F, 4, 0.7F}, seed + 200U, w);
  const Vector3f grass(0.105F, 0.135F, 0.050F), soil(0.240F, 0.195F, 0.130F);
  surface.albedo = ((grass + bare * (soil - grass)) * tone).cwiseMax(0.01F);
  return surface;
}

}  // namespace skyquilt::simulate
