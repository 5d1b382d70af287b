#include "simulate/ground_material.h"

#include <algorithm>
#include <cmath>

#include "simulate/noise.h"

namespace skyquilt::simulate {
namespace {

using Eigen::Vector3f;

Vector3f Mix(const Vector3f& a, const Vector3f& b, float share) {
  return a + share * (b - a);
}

// What the colour of the ground depends on.
struct GroundPoint {
  float x, y, footprint;  // x, y: along the axes of the city
  uint32_t seed;
  float Noise(float wavelength, int octaves, uint32_t channel, float persistence = 0.5F) const {
    return FractalNoise(x, y, {wavelength, octaves, persistence}, seed + 100U * channel, footprint);
  }
};

Vector3f Asphalt(const GroundPoint& at, float tint) {
  const float tone = 1.0F + 0.12F * at.Noise(14.0F, 3, 1) + 0.12F * at.Noise(2.3F, 3, 2);
  return Vector3f(0.100F, 0.101F, 0.106F) * tint * tone;
}

Vector3f Grass(const GroundPoint& at, float dryness, float tint) {
  const float dry = std::clamp(dryness + 0.33F * at.Noise(21.0F, 4, 3), 0.0F, 1.0F);
  const Vector3f base = Mix({0.072F, 0.128F, 0.034F}, {0.190F, 0.178F, 0.082F}, dry);
  return base * tint * (1.0F + 0.21F * at.Noise(3.1F, 4, 4, 0.6F));
}

Vector3f Concrete(const GroundPoint& at, const Vector3f& base) {
  return base * (1.0F + 0.09F * at.Noise(7.0F, 3, 5) + 0.09F * at.Noise(1.7F, 2, 6));
}

Vector3f Road(const GroundSample& ground, const GroundPoint& at) {
  const auto street = static_cast<uint32_t>(ground.street + 1000);
  Vector3f color = Asphalt(at, 0.85F + 0.35F * HashUnit(ground.street, 3, at.seed));
  const float w = at.footprint;
  const float side = std::abs(ground.across);
  if (!ground.crossing) {
    // Worn bright in the wheel tracks, stained by oil between them.
    color *= 1.0F + 0.10F * (Bar(side, 0.9F, 1.5F, w) + Bar(side, 2.3F, 2.9F, w)) - 0.10F * Bar(side, 1.6F, 2.2F, w);
    const int patch = FloorInt(ground.along / 9.0F);
    if (HashUnit(patch, static_cast<int>(street), at.seed) < 0.16F) {
      const float begin = 9.0F * (static_cast<float>(patch) + 0.5F * HashUnit(patch, 5, at.seed + street));
      const float low = HashUnit(patch, 6, at.seed + street) < 0.5F ? -4.0F : 0.4F;
      color *= 1.0F - 0.28F * Bar(ground.along, begin, begin + 3.5F, w) * Bar(ground.across, low, low + 3.0F, w);
    }
  }
  // Concrete gutter at the kerb.
  const float gutter = ground.crossing ? 0.0F : Bar(side, kRoadHalfWidth - 0.3F, kRoadHalfWidth + 1.0F, w);
  color = Mix(color, {0.30F, 0.295F, 0.28F}, gutter);
  if (ground.crossing) return color;
  const float to_edge = ground.to_crossing - kRoadHalfWidth;
  float paint = 0.0F;
  if (to_edge > 5.5F) paint = Bar(ground.across, -0.1F, 0.1F, w) * PulseTrain(ground.along / 6.0F, 0.5F, w / 6.0F);
  paint += Bar(to_edge, 1.0F, 3.6F, w) * PulseTrain(ground.across / 1.1F + 0.25F, 0.5F, w / 1.1F) * Bar(side, -1.0F, kRoadHalfWidth - 0.5F, w);
  paint += Bar(to_edge, 4.5F, 4.9F, w) * Bar(side, 0.15F, kRoadHalfWidth - 0.5F, w) * 0.8F;
  const float wear = 0.72F + 0.2F * at.Noise(2.5F, 2, 7);
  return Mix(color, {0.62F, 0.62F, 0.59F}, std::clamp(paint, 0.0F, 1.0F) * std::clamp(wear, 0.0F, 1.0F));
}

Vector3f Paved(const PavedArea& pad, const GroundPoint& at) {
  const Eigen::Vector2f local = pad.Local(at.x, at.y);
  const auto key = static_cast<int>(pad.centre.x() * 10.0F);
  const float pick = HashUnit(key, static_cast<int>(pad.centre.y() * 10.0F), at.seed);
  const float w = at.footprint;
  switch (pad.kind) {
    case PadKind::kDriveway:
      if (pick < 0.4F) return Concrete(at, {0.33F, 0.32F, 0.30F});
      if (pick < 0.7F) return Concrete(at, {0.27F, 0.19F, 0.155F});
      return Asphalt(at, 1.15F);
    case PadKind::kPath:
      return Concrete(at, {0.42F, 0.375F, 0.30F});
    case PadKind::kTerrace:
      return Concrete(at, pick < 0.5F ? Vector3f(0.25F, 0.165F, 0.105F) : Vector3f(0.38F, 0.36F, 0.33F));
    case PadKind::kPlaza: {
      const float joints = PulseTrain(local.x() / 4.0F, 0.1F, w / 4.0F) + PulseTrain(local.y() / 4.0F, 0.1F, w / 4.0F);
      const int tile = FloorInt(local.x() / 4.0F) + 57 * FloorInt(local.y() / 4.0F);
      return Concrete(at, {0.37F, 0.345F, 0.31F}) * (1.0F - 0.22F * std::min(joints, 1.0F)) * (0.92F + 0.16F * HashUnit(tile, 8, at.seed));
    }
    case PadKind::kParking: {
      const float edge = pad.half.y() - std::abs(local.y());
      const float stall = PulseTrain((local.x() + pad.half.x()) / 2.7F + 0.02F, 0.06F, w / 2.7F) * Bar(edge, 0.0F, 5.0F, w);
      return Mix(Asphalt(at, 1.05F), {0.55F, 0.55F, 0.53F}, 0.85F * std::clamp(stall, 0.0F, 1.0F));
    }
  }
  return Vector3f::Zero();
}

// Crop fields, at an angle to the streets.
Vector3f Field(const GroundPoint& at) {
  const float u = 0.956F * at.x + 0.292F * at.y;
  const float v = -0.292F * at.x + 0.956F * at.y;
  const float row = v / 47.0F;
  const float column = u / 71.0F + 0.37F * static_cast<float>(FloorInt(row) & 1);
  const int i = FloorInt(column);
  const int j = FloorInt(row);
  const float edge = std::min({(column - static_cast<float>(i)) * 71.0F, (static_cast<float>(i) + 1.0F - column) * 71.0F,
                               (row - static_cast<float>(j)) * 47.0F, (static_cast<float>(j) + 1.0F - row) * 47.0F});
  if (edge < 1.3F) return Grass(at, 0.5F, 0.9F);
  const float pick = HashUnit(i, j, at.seed + 17U);
  const float furrow_fade = std::clamp(2.2F / (4.0F * at.footprint) - 0.5F, 0.0F, 1.0F);
  const float furrows = 1.0F + 0.10F * furrow_fade * std::sin(2.0F * 3.14159265F / 2.2F * (pick < 0.5F ? u : v));
  if (pick < 0.28F) return Grass(at, 0.15F, 1.05F);
  if (pick < 0.52F) return Vector3f(0.34F, 0.27F, 0.125F) * furrows * (1.0F + 0.10F * at.Noise(9.0F, 5, 8));
  if (pick < 0.74F) return Vector3f(0.175F, 0.125F, 0.085F) * furrows * (1.0F + 0.14F * at.Noise(9.0F, 5, 9));
  return Vector3f(0.095F, 0.150F, 0.045F) * furrows * (1.0F + 0.12F * at.Noise(9.0F, 5, 10));
}

Vector3f Garden(const CityLayout& layout, const GroundSample& ground, const Hit& hit, const GroundPoint& at) {
  const Cell& cell = *ground.cell;
  switch (cell.kind) {
    case CellKind::kHouses: {
      const Eigen::Vector2d in_plot = cell.turn.TurnedBack({static_cast<double>(at.x), static_cast<double>(at.y)});
      const auto along = static_cast<float>(in_plot.x() - cell.lots_begin_m);
      const double to_back = in_plot.y() - 0.5 * (cell.min.y() + cell.max.y());
      const int lot = FloorInt(along / cell.lot_pitch_m);
      const int key = lot * 2 + (to_back > 0.0 ? 1 : 0) + static_cast<int>(cell.min.x()) * 31 + static_cast<int>(cell.min.y()) * 57;
      // Hedges between the gardens.
      const float to_side = std::abs(along - cell.lot_pitch_m * std::round(along / cell.lot_pitch_m));
      if (std::min(to_side, static_cast<float>(std::abs(to_back))) < 0.4F)
        return Vector3f(0.035F, 0.062F, 0.020F) * (1.0F + 0.2F * at.Noise(2.0F, 3, 11));
      const float beds = at.Noise(8.0F, 3, 12);
      if (beds > 0.85F) return Vector3f(0.15F, 0.11F, 0.075F) * (1.0F + 0.2F * at.Noise(1.7F, 3, 13));
      return Grass(at, 0.55F * HashUnit(key, 1, at.seed), 0.85F + 0.35F * HashUnit(key, 2, at.seed));
    }
    case CellKind::kPark:
      for (const Pond& pond : layout.contents().ponds) {
        const double r = pond.Radius(static_cast<double>(hit.position.x()), static_cast<double>(hit.position.y()));
        if (r < 1.16) return Mix({0.14F, 0.115F, 0.07F}, {0.06F, 0.085F, 0.03F}, Smoothstep(0.95F, 1.16F, static_cast<float>(r)));
      }
      return Grass(at, 0.2F, 0.95F);
    case CellKind::kFlats:
      return Grass(at, 0.35F, 1.0F);
    case CellKind::kTowers:
      return Grass(at, 0.25F, 1.0F);
    case CellKind::kWood:
      return Mix(Grass(at, 0.3F, 0.75F), {0.085F, 0.065F, 0.042F}, std::clamp(0.45F + 0.8F * at.Noise(6.0F, 4, 14), 0.0F, 1.0F));
    case CellKind::kField:
      return Field(at);
  }
  return Vector3f::Zero();
}

}  // namespace

Surface CityGround(const CityLayout& layout, const Hit& hit, uint32_t seed) {
  const GroundSample ground = layout.Sample(hit.position.x(), hit.position.y());
  const GroundPoint at{ground.city.x(), ground.city.y(), SurfaceFootprint(hit), seed};
  Surface surface;
  surface.normal = hit.normal;
  switch (ground.kind) {
    case GroundKind::kRoad:
      surface.albedo = Road(ground, at);
      break;
    case GroundKind::kPavement: {
      const float joints = PulseTrain(at.x / 2.0F, 0.06F, at.footprint / 2.0F) + PulseTrain(at.y / 2.0F, 0.06F, at.footprint / 2.0F);
      surface.albedo = Concrete(at, {0.315F, 0.305F, 0.29F}) * (1.0F - 0.25F * std::min(joints, 1.0F));
      break;
    }
    case GroundKind::kPad:
      surface.albedo = Paved(*ground.pad, at);
      break;
    case GroundKind::kCell:
      surface.albedo = Garden(layout, ground, hit, at);
      break;
    case GroundKind::kField:
      surface.albedo = Field(at);
      break;
  }
  surface.albedo = surface.albedo.cwiseMax(0.01F);
  return surface;
}

Surface BridgeSurface(const Bridge& bridge, const Hit& hit, uint32_t seed) {
  const Eigen::Vector2f local = bridge.Local(hit.position.head<2>().cast<double>()).cast<float>();
  Surface surface;
  surface.normal = hit.normal;
  const float w = SurfaceFootprint(hit);
  if (hit.tag.part == Part::kBridgeRoad) {
    GroundSample road;
    road.kind = GroundKind::kRoad;
    road.along = local.x();
    road.across = local.y();
    road.to_crossing = 1e6F;
    road.street = bridge.street;
    surface.albedo = Road(road, {local.x(), local.y(), w, seed});
  } else {
    // Height in both, so that upright faces have a pattern too.
    surface.albedo = Concrete({local.x() + 0.6F * hit.position.z(), local.y() + 0.8F * hit.position.z(), w, seed}, {0.36F, 0.35F, 0.33F});
  }
  surface.albedo = surface.albedo.cwiseMax(0.01F);
  return surface;
}

Vector3f WaveNormal(float east, float north, float wavelength_m, float slope, float footprint_m, uint32_t seed) {
  const FractalShape waves{wavelength_m, 3, 0.5F};
  const float step = 0.15F * wavelength_m;
  const float here = FractalNoise(east, north, waves, seed, footprint_m);
  const float x = FractalNoise(east + step, north, waves, seed, footprint_m) - here;
  const float y = FractalNoise(east, north + step, waves, seed, footprint_m) - here;
  return Vector3f(-slope * x, -slope * y, 0.3F).normalized();
}

Surface PondWater(const Hit& hit, uint32_t seed) {
  Surface surface;
  const float tone = FractalNoise(hit.position.x(), hit.position.y(), {9.0F, 3, 0.5F}, seed + 900U, SurfaceFootprint(hit));
  surface.albedo = Vector3f(0.030F, 0.044F, 0.032F) * (1.0F + 0.25F * tone);
  surface.mirror = 0.03F;
  surface.mirror_normal = WaveNormal(hit.position.x(), hit.position.y(), 2.4F, 0.03F, SurfaceFootprint(hit), seed + 950U);
  return surface;
}

}  // namespace skyquilt::simulate
