#include "bench/numerics/synthetic_scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/render/footprint.h"
#include "core/render/march.h"

namespace skyquilt::bench {
namespace {

constexpr double kCamera_m = 30.0;

// Display values of the surface a ray meets, in the scene's own frame: ground z = 0 with waves half a metre long, and a block of 2.5 x 2.5 x 2 m.
Eigen::Vector3d ShadeScene(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  const geo::Interval block = geo::RayBox(origin, direction, {-1.25, -1.25, 0.0}, {1.25, 1.25, 2.0});
  const Eigen::Vector3d p = origin + (block.Empty() ? -origin.z() / direction.z() : block.t_near) * direction;
  const double wave = 0.5 + 0.35 * std::sin(12.0 * p.x()) * std::cos(11.0 * p.y());
  if (block.Empty()) return {0.7 * wave, wave, 0.6 * wave};
  return {0.6 + 0.2 * std::sin(9.0 * p.x() + 7.0 * p.z()), 0.25, 0.3 + 0.15 * std::sin(8.0 * p.y())};
}

// A ray's pitch for a width at the ground, `distance_m` away.
float DrawPitch(const SyntheticRays& rays, double distance_m, base::Random& random) {
  if (!(rays.least_width_m < rays.most_width_m)) return static_cast<float>(rays.least_width_m / distance_m);
  return static_cast<float>(std::exp(random.Uniform(std::log(rays.least_width_m), std::log(rays.most_width_m))) / distance_m);
}

}  // namespace

render::TrainedField SyntheticField(const SyntheticOptions& options) {
  render::TrainedField field;
  field.name = "synthetic";
  const double half = 0.5 * options.edge_m;
  field.box.min_enu = options.offset_enu + Eigen::Vector3d(-half, -half, -0.5);
  field.box.max_enu = options.offset_enu + Eigen::Vector3d(half, half, options.height_m - 0.5);
  field.map = encoding::SpaceMap::Box(field.box.min_enu, field.box.max_enu);
  field.step_m = 2.0 * options.voxel_m;
  encoding::HashGridConfig& grid = field.config.grid;
  grid.levels = options.levels;
  grid.features = options.features;
  grid.log2_table_size = options.log2_table_size;
  grid.base_resolution = 4;
  grid.finest_resolution = options.edge_m / options.voxel_m;
  // The box's corners are rounded far from the origin; the field's shape must not depend on that.
  const double extent[3] = {1.0, 1.0, std::min(1.0, options.height_m / options.edge_m)};
  std::copy(extent, extent + 3, grid.extent);
  field.config.hidden = options.hidden;
  field.config.color_hidden_layers = options.color_hidden_layers;
  field.config.color_range = 1.4;
  field.config.density_bias = options.density_bias;
  field.config.density_activation = options.density_activation;
  field.config.appearance = options.appearance;
  field.config.multisample = options.multisample;
  field.config.normal_head = options.normal_head;
  field.config.scale_features = options.scale_features;
  field.occupancy = field::OccupancyGrid::Make(grid.extent, 3.0 * options.voxel_m / options.edge_m, 100'000);
  return field;
}

void DrawSyntheticBatch(const render::TrainedField& field, const SyntheticOptions& scene, const SyntheticRays& rays, base::Random& random,
                        worker::RayBatch* batch) {
  const int points = std::max(1, field.config.multisample);
  batch->Clear(points);
  std::vector<float> x, y, z, sharpness, t, unit_length;
  std::vector<int32_t> cell;
  const double half = 0.5 * scene.edge_m;
  for (int i = 0; i < rays.rays; ++i) {
    const double camera_y = random.Uniform(-half, half), camera_x = random.Uniform(-half, half);
    const Eigen::Vector3d camera(camera_x, camera_y, kCamera_m);
    const double ground_y = random.Uniform(-half, half), ground_x = random.Uniform(-half, half);
    const Eigen::Vector3d ground(ground_x, ground_y, 0.0);
    const float stops = rays.most_stops * (2.0F * random.Uniform() - 1.0F);
    worker::BatchRay ray;
    ray.ray.direction_enu = (ground - camera).normalized();
    ray.ray.origin_enu = camera + scene.offset_enu;
    ray.ray.photo = i % scene.photos;
    ray.ray.empty = random.Uniform() < rays.empty_share;
    const Eigen::Vector3d color = ShadeScene(camera, ray.ray.direction_enu);
    for (size_t c = 0; c < 3; ++c) {
      ray.ray.exposure[c] = brightness::Exposure::FromLogGain(stops * std::log(2.0F));
      const float recorded = brightness::Expose(static_cast<float>(color[static_cast<Eigen::Index>(c)]), ray.ray.exposure[c]).value;
      ray.ray.target_srgb[c] = std::clamp(recorded, 0.0F, 1.0F);
      ray.background[c] = random.Uniform();
    }
    if (field.config.Cones()) ray.ray.pixel_pitch = DrawPitch(rays, (ground - camera).norm(), random);
    const float jitter = random.Uniform();
    const geo::Interval interval = render::FieldInterval(field.map, ray.ray.origin_enu, ray.ray.direction_enu);
    const render::Ray axis{.origin_enu = ray.ray.origin_enu, .direction_enu = ray.ray.direction_enu, .pixel_pitch = ray.ray.pixel_pitch};
    const render::Cone cone(field.map, axis, points);
    for (auto* values : {&x, &y, &z, &sharpness, &t, &unit_length}) values->clear();
    cell.clear();
    render::March(field, ray.ray.origin_enu, ray.ray.direction_enu, interval, field.step_m, jitter,
                  [&](double at, double length_m, double length, int64_t index) {
                    render::Turn turn;
                    if (points > 1) turn = {random.Uniform(0.0, 2.0 * std::numbers::pi), random.Uniform() < 0.5F};
                    const size_t first = x.size(), end = first + static_cast<size_t>(points);
                    for (auto* values : {&x, &y, &z}) values->resize(end);
                    cone.Positions(at, length_m, axis.Footprint(at), turn, &x[first], &y[first], &z[first], 1);
                    t.push_back(static_cast<float>(at));
                    sharpness.push_back(render::SharpnessOf(axis.Footprint(at), field.map.units_per_metre(), points));
                    unit_length.push_back(static_cast<float>(length / field.step_m));
                    cell.push_back(static_cast<int32_t>(index));
                    return true;
                  });
    ray.count = static_cast<int64_t>(t.size());
    batch->Append(ray, x.data(), y.data(), z.data(), sharpness.data(), t.data(), unit_length.data(), cell.data());
  }
  batch->LayOutFeatures(field::HashField(field.config).FeatureRows());
}

void RepositionInFloat(const render::TrainedField& field, worker::RayBatch* batch) {
  const Eigen::Vector3f low = field.map.min_enu().cast<float>();
  const auto scale = static_cast<float>(field.map.units_per_metre());
  for (const worker::BatchRay& ray : batch->rays) {
    const Eigen::Vector3f origin = ray.ray.origin_enu.cast<float>();
    const Eigen::Vector3f direction = ray.ray.direction_enu.cast<float>();
    for (auto s = static_cast<size_t>(ray.begin); s < static_cast<size_t>(ray.begin + ray.count); ++s) {
      const Eigen::Vector3f unit = ((origin + batch->t[s] * direction) - low) * scale;
      batch->x[s] = unit.x();
      batch->y[s] = unit.y();
      batch->z[s] = unit.z();
    }
  }
}

TrainingState InitialState(const field::HashField& field, uint64_t seed) {
  TrainingState state;
  state.parameters.Allocate(field);
  state.moments.Allocate(field);
  base::Random random(seed);
  field.Initialize(random, state.parameters.grid, state.parameters.networks);
  return state;
}

bool AllFinite(const TrainingState& state) {
  const field::OptimizerState& m = state.moments;
  for (const auto* values :
       {&state.parameters.grid, &state.parameters.networks, &m.grid_moment1, &m.grid_moment2, &m.network_moment1, &m.network_moment2}) {
    if (!kernel::AllFinite(values->data(), static_cast<int64_t>(values->size()))) return false;
  }
  return true;
}

bool SameParameters(const TrainingState& a, const TrainingState& b) {
  return a.parameters.grid == b.parameters.grid && a.parameters.networks == b.parameters.networks &&
         a.moments.grid_moment1 == b.moments.grid_moment1 && a.moments.grid_moment2 == b.moments.grid_moment2 &&
         a.moments.network_moment1 == b.moments.network_moment1 && a.moments.network_moment2 == b.moments.network_moment2;
}

}  // namespace skyquilt::bench
