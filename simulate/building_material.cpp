#include "simulate/building_material.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "simulate/noise.h"

namespace skyquilt::simulate {
namespace {

using Eigen::Vector3f;

constexpr std::array<std::array<float, 3>, 8> kPlaster = {{{0.60F, 0.56F, 0.48F},
                                                           {0.66F, 0.64F, 0.60F},
                                                           {0.52F, 0.42F, 0.29F},
                                                           {0.33F, 0.16F, 0.11F},
                                                           {0.55F, 0.46F, 0.38F},
                                                           {0.42F, 0.42F, 0.42F},
                                                           {0.47F, 0.36F, 0.33F},
                                                           {0.62F, 0.55F, 0.36F}}};
constexpr std::array<std::array<float, 3>, 7> kTiles = {{{0.29F, 0.105F, 0.060F},
                                                         {0.22F, 0.085F, 0.060F},
                                                         {0.33F, 0.150F, 0.085F},
                                                         {0.115F, 0.115F, 0.125F},
                                                         {0.16F, 0.110F, 0.085F},
                                                         {0.26F, 0.120F, 0.085F},
                                                         {0.085F, 0.088F, 0.100F}}};
constexpr std::array<std::array<float, 3>, 4> kFlatRoofs = {
    {{0.36F, 0.345F, 0.32F}, {0.21F, 0.21F, 0.215F}, {0.46F, 0.455F, 0.44F}, {0.27F, 0.25F, 0.21F}}};

template <size_t N>
Vector3f Pick(const std::array<std::array<float, 3>, N>& palette, int channel, uint32_t seed) {
  const auto& color = palette[HashCell(channel, 0, seed) % N];
  return Vector3f(color[0], color[1], color[2]) * (0.92F + 0.16F * HashUnit(channel, 1, seed));
}

void Wall(const Building& b, const Eigen::Vector2f& axis, const Hit& hit, const Vector3f& local, Surface& surface) {
  const bool end_wall = std::abs(hit.normal.head<2>().dot(axis)) > 0.7F;
  const float span = static_cast<float>(end_wall ? b.width_m : b.length_m);
  const float s = (end_wall ? local.y() : local.x()) + 0.5F * span;
  const float z = local.z();
  const float w = SurfaceFootprint(hit);
  const uint32_t face = b.seed + (end_wall ? 5U : 9U);
  Vector3f color = Pick(kPlaster, 1, b.seed);
  color *= 1.0F + 0.06F * FractalNoise(s, z, {6.0F, 4, 0.5F}, face, w) + 0.05F * FractalNoise(4.0F * s, z, {5.0F, 2, 0.5F}, face + 50U, w);
  // The foot of the wall is darkened by splashes.
  color *= 1.0F - 0.3F * Bar(z, -3.0F, 0.5F, w);
  const bool high = b.kind == BuildingKind::kTower || b.kind == BuildingKind::kApartment;
  const float storey = high ? 3.05F : 2.8F;
  const auto eave = static_cast<float>(b.eave_height_m);
  const float bay_wish = high ? 2.6F + 1.2F * HashUnit(3, 3, b.seed) : 3.0F;
  const float n_bays = std::max(std::floor(span / bay_wish), 1.0F);
  const float bay = span / n_bays;
  const float style = HashUnit(4, 4, b.seed);
  const bool ribbon = b.kind == BuildingKind::kTower && style < 0.4F;
  float window = 0.0F;
  float frame = 0.0F;
  const float n_storeys = std::floor(eave / storey + 0.15F);
  if (b.kind != BuildingKind::kShed && b.kind != BuildingKind::kGarage && z < n_storeys * storey && z > 0.0F) {
    const float sill = 0.9F;
    const float head = high ? 2.4F : 2.2F;
    const float rows = PulseTrain((z - sill) / storey, (head - sill) / storey, w / storey);
    const float rows_wide = PulseTrain((z - sill + 0.12F) / storey, (head - sill + 0.24F) / storey, w / storey);
    const float glass_width = ribbon ? 0.93F : (high ? 0.55F : 0.42F);
    const float offset = 0.5F * (1.0F - glass_width);
    window = rows * PulseTrain(s / bay - offset, glass_width, w / bay);
    frame = rows_wide * PulseTrain(s / bay - offset + 0.12F / bay, std::min(glass_width + 0.24F / bay, 1.0F), w / bay) - window;
    if (b.kind == BuildingKind::kApartment && style > 0.5F && !end_wall) {
      // Balconies: pale parapets under the windows of every second bay.
      const float balcony = PulseTrain(z / storey, 0.33F, w / storey) * PulseTrain(s / (2.0F * bay) - 0.04F, 0.42F, w / (2.0F * bay));
      color += balcony * (Vector3f(0.58F, 0.57F, 0.55F) - color);
    }
  }
  color += std::clamp(frame, 0.0F, 1.0F) * (Vector3f(0.62F, 0.61F, 0.58F) - color);
  const int pane = FloorInt(s / bay) + 37 * FloorInt(z / storey);
  const float curtain = HashUnit(pane, 6, face);
  const Vector3f glass = Vector3f(0.035F, 0.042F, 0.05F) + Vector3f(0.16F, 0.15F, 0.13F) * (curtain > 0.7F ? 1.0F : 0.15F);
  surface.albedo = color + window * (glass - color);
  surface.mirror = 0.06F;
  surface.mirror_share = window;
  surface.mirror_normal = hit.normal;
}

void PitchedRoof(const Building& b, const Eigen::Vector2f& axis, const Hit& hit, const Vector3f& local, Surface& surface) {
  const Eigen::Vector2f fall = hit.normal.head<2>();
  const bool hip_end = std::abs(fall.dot(axis)) > std::abs(fall.dot(Eigen::Vector2f(-axis.y(), axis.x())));
  const float level = hip_end ? local.y() : local.x();  // position along the tile rows
  const float down = hip_end ? local.x() : local.y();
  const float w = SurfaceFootprint(hit);
  Vector3f color = Pick(kTiles, 2, b.seed);
  color *= 1.0F + 0.10F * FractalNoise(level, down, {5.0F, 4, 0.55F}, b.seed + 3U, w) +
           0.06F * FractalNoise(4.0F * level, down, {4.0F, 3, 0.5F}, b.seed + 8U, w);
  color *= 1.0F - 0.12F * PulseTrain(down / 0.7F, 0.3F, w / 0.7F);
  // Moss on the side away from the sun.
  const float moss = Smoothstep(0.3F, 1.2F, FractalNoise(level, down, {3.0F, 3, 0.5F}, b.seed + 12U, w) + 0.5F * hit.normal.y());
  color += 0.35F * moss * (Vector3f(0.09F, 0.10F, 0.05F) - color);
  const auto ridge = static_cast<float>(b.ridge_height_m);
  color *= 1.0F + 0.25F * Bar(ridge - local.z(), -0.2F, 0.22F, w);
  surface.albedo = color;
  // Solar panels and roof windows on the southern side.
  const float x = level / static_cast<float>(hip_end ? b.width_m : b.length_m);
  const auto rise = static_cast<float>(b.ridge_height_m - b.eave_height_m);
  const float up = (local.z() - static_cast<float>(b.eave_height_m)) / std::max(rise, 0.1F);
  const bool panels = hit.normal.y() < -0.15F && HashUnit(5, 5, b.seed) < 0.3F;
  if (panels && !hip_end) {
    const float inside = Bar(x, -0.33F, 0.05F, w / 10.0F) * Bar(up, 0.2F, 0.85F, w / 4.0F);
    const float seams = std::min(PulseTrain(level / 1.05F, 0.06F, w / 1.05F) + PulseTrain(up * 3.0F, 0.04F, w), 1.0F);
    const Vector3f cell = Vector3f(0.018F, 0.022F, 0.045F) + 0.16F * seams * Vector3f::Ones();
    surface.albedo += inside * (cell - surface.albedo);
    surface.mirror = 0.04F;
    surface.mirror_share = inside;
    surface.mirror_normal = hit.normal;
  } else if (!hip_end && HashUnit(6, 6, b.seed) < 0.5F) {
    const float pane = Bar(std::abs(x - 0.05F), 0.14F, 0.14F + 1.0F / static_cast<float>(b.length_m), w / 10.0F) * Bar(up, 0.4F, 0.65F, w / 4.0F);
    surface.albedo += pane * (Vector3f(0.06F, 0.07F, 0.085F) - surface.albedo);
    surface.mirror = 0.05F;
    surface.mirror_share = pane;
    surface.mirror_normal = hit.normal;
  }
}

void FlatRoof(const Building& b, const Hit& hit, const Vector3f& local, Surface& surface) {
  const float w = SurfaceFootprint(hit);
  Vector3f color = Pick(kFlatRoofs, 3, b.seed);
  color *= 1.0F + 0.11F * FractalNoise(local.x(), local.y(), {7.0F, 5, 0.5F}, b.seed + 3U, w);
  const float seams = PulseTrain(local.x() / 3.0F, 0.05F, w / 3.0F) + 0.5F * PulseTrain(local.y() / 6.0F, 0.03F, w / 6.0F);
  color *= 1.0F - 0.25F * std::min(seams, 1.0F);
  // Stains along the edges, dried puddles in the middle.
  const float edge =
      std::min(0.5F * static_cast<float>(b.length_m) - std::abs(local.x()), 0.5F * static_cast<float>(b.width_m) - std::abs(local.y()));
  color *= 1.0F - 0.25F * (1.0F - Smoothstep(0.2F, 1.5F, edge));
  const float stain = Smoothstep(0.35F, 0.9F, FractalNoise(local.x(), local.y(), {5.0F, 3, 0.5F}, b.seed + 31U, w));
  surface.albedo = color * (1.0F - 0.25F * stain);
}

}  // namespace

Surface BuildingSurface(const Building& b, const Eigen::Vector2f& axis, const Hit& hit) {
  const Vector3f local = b.Local(hit.position, axis);
  Surface surface;
  surface.normal = hit.normal;
  const float w = SurfaceFootprint(hit);
  const float grain = 1.0F + 0.07F * FractalNoise(local.x() + local.z(), local.y() + 0.7F * local.z(), {2.5F, 3, 0.5F}, b.seed + 60U, w);
  switch (hit.tag.part) {
    case Part::kWall:
      Wall(b, axis, hit, local, surface);
      break;
    case Part::kPitchedRoof:
      PitchedRoof(b, axis, hit, local, surface);
      break;
    case Part::kFlatRoof:
      FlatRoof(b, hit, local, surface);
      break;
    case Part::kParapet:
      surface.albedo = 0.8F * Pick(kPlaster, 1, b.seed) * grain;
      break;
    case Part::kChimney:
      surface.albedo = Vector3f(0.27F, 0.14F, 0.10F) * grain;
      break;
    default:
      surface.albedo = Vector3f(0.40F, 0.41F, 0.42F) * grain * (0.8F + 0.3F * HashUnit(9, 9, b.seed));
      break;
  }
  return surface;
}

}  // namespace skyquilt::simulate
