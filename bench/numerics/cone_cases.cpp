// Footprints of nothing, of a whole block and infinite ones: features, renderings and training steps against double.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "bench/numerics/groups.h"
#include "bench/numerics/reference_trainer.h"
#include "bench/numerics/synthetic_trainer.h"
#include "core/render/footprint.h"
#include "core/render/march.h"
#include "core/render/ray_engine.h"

namespace skyquilt::bench {
namespace {

constexpr uint64_t kConeSeed = 7;
constexpr double kConeDistortion = 1e-2;
// Samples with footprints: train.multisample and train.scale_features.
struct ConeSetting {
  int multisample = 1;
  bool scale_features = false;

  // With one position and nothing else, a cone without width is a point.
  bool LikePoints() const { return multisample == 1 && !scale_features; }
  SyntheticOptions Scene() const { return {.multisample = multisample, .scale_features = scale_features}; }
  std::string Text() const {
    return (multisample == 1 ? "" : fmt::format(", {} positions per sample", multisample)) + (scale_features ? ", scale features" : "");
  }
};
constexpr ConeSetting kConeSettings[] = {{1, false}, {4, false}, {6, false}, {1, true}, {6, true}};

// Footprints between two widths, metres.
struct Widths {
  std::string name;
  double least_m = 0.0, most_m = 0.0;
};
std::vector<Widths> AllWidths() {
  const SyntheticOptions scene;
  return {{"nothing", 0.0, 0.0},
          {"a tenth of a voxel to ten voxels", 0.1 * scene.voxel_m, 10.0 * scene.voxel_m},
          {"the whole block", scene.edge_m, scene.edge_m},
          {"everything (infinite)", kEver, kEver}};
}
double DrawWidth(const Widths& widths, base::Random& random) {
  return widths.least_m < widths.most_m ? std::exp(random.Uniform(std::log(widths.least_m), std::log(widths.most_m))) : widths.least_m;
}

// Table values that matter; initial ones are so small that footprints could do nothing.
void FillTable(base::Random& random, std::vector<float>* table) {
  for (float& value : *table) value = random.Uniform() - 0.5F;
}

// Footprints of any width count as trained.
render::TrainedField ConeField(const ConeSetting& setting, bool contracted) {
  render::TrainedField field = SyntheticField(setting.Scene());
  field.box.margin_m = 0.0;
  if (contracted) {
    field.map = encoding::SpaceMap::Contracted(field.box.min_enu, field.box.max_enu);
    std::copy_n(field.map.extent().data(), 3, field.config.grid.extent);
    field.config.density_bias = -5.0;
    field.occupancy = field::OccupancyGrid::Make(field.config.grid.extent, field.map.units_per_metre(), 100'000);
  }
  field.parameters = InitialState(field::HashField(field.config), kConeSeed).parameters;
  base::Random random(kConeSeed);
  FillTable(random, &field.parameters.grid);
  field.BuildNetworks();
  return field;
}

// Of a sample's footprint in unit lengths: with several positions, half as wide as the pixel's square.
double DeviationOf(double width, int multisample) {
  return width / std::sqrt(multisample > 1 ? 24.0 : 12.0);
}

// Features of random places in the block: positions of a sample are as far apart as it is wide, but not more than the block.
CaseResult ConeFeatures(const ConeSetting& setting, const Widths& widths, int samples) {
  const render::TrainedField field = ConeField(setting, false);
  const ReferenceField reference(*field.field);
  const std::vector<double> grid(field.parameters.grid.begin(), field.parameters.grid.end());
  const auto n = static_cast<size_t>(samples), rows = static_cast<size_t>(field.field->FeatureRows());
  const auto points = static_cast<size_t>(setting.multisample);
  base::Random random(31);
  std::vector<float> x(points * n), y(points * n), z(points * n), sharpness(n), features(rows * n), of_points(rows * n);
  std::vector<double> deviation(n);
  for (size_t s = 0; s < n; ++s) {
    const float middle[3] = {random.Uniform(), random.Uniform(), 0.5F * random.Uniform()};
    const double width_m = DrawWidth(widths, random);
    sharpness[s] = render::SharpnessOf(width_m, field.map.units_per_metre(), setting.multisample);
    deviation[s] = DeviationOf(width_m * field.map.units_per_metre(), setting.multisample);
    const auto apart = points > 1 ? static_cast<float>(std::min(1.0, width_m * field.map.units_per_metre())) : 0.0F;
    for (size_t j = 0; j < points; ++j) {
      x[j * n + s] = middle[0] + apart * (random.Uniform() - 0.5F);
      y[j * n + s] = middle[1] + apart * (random.Uniform() - 0.5F);
      z[j * n + s] = middle[2] + apart * (random.Uniform() - 0.5F);
    }
  }
  field.field->EncodeSerial(field.parameters.grid, {x.data(), y.data(), z.data(), sharpness.data(), setting.multisample, n}, samples, features.data(),
                            n);
  field.field->EncodeSerial(field.parameters.grid, {x.data(), y.data(), z.data()}, samples, of_points.data(), n);
  Worst worst;
  for (size_t s = 0; s < n; ++s) {
    ReferenceField::Place place;
    place.deviation = deviation[s];
    for (size_t i = s; i < x.size(); i += n) {
      place.positions.push_back({static_cast<double>(x[i]), static_cast<double>(y[i]), static_cast<double>(z[i])});
    }
    std::vector<double> exact = reference.Features(grid, place);
    const std::vector<double> scales = reference.Scales(place);
    exact.insert(exact.end(), scales.begin(), scales.end());
    if (exact.size() != rows) worst.Take(kNoNumber);
    for (size_t row = 0; row < exact.size(); ++row) worst.Take(std::abs(static_cast<double>(features[row * n + s]) - exact[row]));
  }
  const auto scale_rows = static_cast<ptrdiff_t>(static_cast<size_t>(field.field->ScaleRows()) * n);
  const bool all_zero = std::all_of(features.begin(), features.end() - scale_rows, [](float value) { return value == 0.0F; });
  const bool same_as_points = features == of_points;
  const bool without_width = !(widths.most_m > 0.0);
  return {.seen = fmt::format("{} samples, {}", samples,
                              all_zero         ? "all features 0"
                              : same_as_points ? "the bits of points"
                                               : "finite"),
          .worst = worst.value(),
          .holds = all_zero == std::isinf(widths.least_m) && (setting.multisample > 1 || same_as_points == without_width)};
}

enum class RayShape {
  kColumns,  // through a block from above, all equally wide at any distance
  kCones,    // from inside a block, so that they begin with steps of the field's own length; the width is that after two metres
  kFar,      // the same in a contracted field, and far out of the survey
};

std::vector<render::Ray> ConeRays(const Widths& widths, RayShape shape, int n) {
  constexpr double kWidthAt_m = 2.0;
  base::Random random(37);
  std::vector<render::Ray> rays;
  rays.reserve(static_cast<size_t>(n));
  for (int i = 0; i < n; ++i) {
    render::Ray ray;
    ray.origin_enu = {random.Uniform(-3.0, 3.0), random.Uniform(-3.0, 3.0), shape == RayShape::kColumns ? 20.0 : 3.4};
    const double forwards = shape == RayShape::kFar ? random.Uniform(1.0, 20.0) : random.Uniform(-0.3, 0.3);
    ray.direction_enu = Eigen::Vector3d(random.Uniform(-0.3, 0.3), forwards, -1.0).normalized();
    const double width_m = DrawWidth(widths, random);
    (shape == RayShape::kColumns ? ray.pixel_width : ray.pixel_pitch) =
        static_cast<float>(shape == RayShape::kColumns ? width_m : width_m / kWidthAt_m);
    rays.push_back(ray);
  }
  return rays;
}

struct ExactColor {
  std::array<double, 3> rgb = {};
  double transmittance = 1.0;
  int samples = 0;
};

// One sample after the other, in double.
ExactColor ExactRay(const render::TrainedField& field, const std::vector<double>& grid, const std::vector<double>& networks, const render::Ray& ray,
                    double step_scale) {
  const ReferenceField reference(*field.field);
  const std::array<double, 3> direction = {ray.direction_enu.x(), ray.direction_enu.y(), ray.direction_enu.z()};
  ExactColor color;
  const int points = field.config.multisample;
  const render::Cone cone(field.map, ray, points);
  const auto emit = [&](double t, double length_m, double unit_length) {
    const Eigen::Vector3d p = ray.origin_enu + t * ray.direction_enu;
    ReferenceField::Place place;
    place.deviation = DeviationOf(ray.Footprint(t) * field.map.VolumeScale(p), points);
    if (points > 1) {
      float x[render::kMaxPositions], y[render::kMaxPositions], z[render::kMaxPositions];
      cone.Positions(t, length_m, ray.Footprint(t), render::Turn::Alternating(color.samples), x, y, z, 1);
      for (int j = 0; j < points; ++j) place.positions.push_back({static_cast<double>(x[j]), static_cast<double>(y[j]), static_cast<double>(z[j])});
    } else {
      const Eigen::Vector3d unit =
          field.map.contracted() ? field.map.UnitFromEnu(p).cast<double>() : Eigen::Vector3d((p - field.map.min_enu()) * field.map.units_per_metre());
      place.positions.push_back({unit.x(), unit.y(), unit.z()});
    }
    const ReferenceField::Sample sample = reference.Forward(grid, networks, place, direction);
    const double tau = std::exp(sample.log_density + field.config.density_bias) * unit_length / field.step_m;
    const double weight = color.transmittance * -std::expm1(-tau);
    for (size_t c = 0; c < 3; ++c) color.rgb[c] += weight * field.config.color_range / (1.0 + std::exp(-sample.raw[c]));
    color.transmittance *= std::exp(-tau);
    ++color.samples;
    return true;
  };
  const geo::Interval interval = render::FieldInterval(field.map, ray.origin_enu, ray.direction_enu);
  if (step_scale > 1.01) {
    render::MarchCoarse(field, ray.origin_enu, ray.direction_enu, interval, step_scale * field.step_m, 0.5F, emit);
  } else {
    render::March(field, ray.origin_enu, ray.direction_enu, interval, field.step_m, 0.5F,
                  [&](double t, double length, double unit_length, int64_t) { return emit(t, length, unit_length); });
  }
  return color;
}

CaseResult ConeRendering(const ConeSetting& setting, const Widths& widths, RayShape shape, int n) {
  const bool contracted = shape == RayShape::kFar;
  render::TrainedField field = ConeField(setting, contracted);
  const std::vector<render::Ray> rays = ConeRays(widths, shape, n);
  const std::vector<double> grid(field.parameters.grid.begin(), field.parameters.grid.end());
  const std::vector<double> networks(field.parameters.networks.begin(), field.parameters.networks.end());
  render::EngineOptions options{.colour_threshold = 0.0F};
  // Columns as wide as a block ask for steps longer than it: one sample for all of a ray.
  if (shape == RayShape::kColumns && widths.most_m > 0.0) options.step_scale = 1e3;
  render::FieldSet set;
  (contracted ? set.context : set.blocks.emplace_back()) = &field;
  base::ThreadPool threads(1);
  std::vector<render::RayColor> out(rays.size()), of_points(rays.size());
  render::RenderRays(set, rays, out, options, threads);
  Worst worst;
  int64_t samples = 0, visible = 0;
  // A ray that is nearly opaque ends early, by design.
  constexpr double kEnding = 1e-2;
  for (size_t i = 0; i < rays.size(); ++i) {
    const ExactColor exact = ExactRay(field, grid, networks, rays[i], options.step_scale);
    samples += exact.samples;
    if (exact.transmittance < kEnding) continue;
    visible += exact.transmittance < 0.98 ? 1 : 0;
    worst.Take(std::abs(static_cast<double>(out[i].opacity) - (1.0 - exact.transmittance)));
    for (size_t c = 0; c < 3; ++c) worst.Take(std::abs(static_cast<double>(out[i].rgb_srgb[c]) - exact.rgb[c]));
  }
  bool same_as_points = false;
  if (setting.LikePoints()) {
    field.config.multisample = 0;
    field.BuildNetworks();
    render::RenderRays(set, rays, of_points, options, threads);
    same_as_points = std::memcmp(out.data(), of_points.data(), out.size() * sizeof(render::RayColor)) == 0;
  }
  return {.seen = fmt::format("{} rays, {} samples{}", n, samples, same_as_points ? ", the bits of points" : ""),
          .worst = worst.value(),
          .holds = 4 * visible > n && same_as_points == (setting.LikePoints() && !(widths.most_m > 0.0))};
}

SyntheticRays RaysOf(const Widths& widths, int n) {
  return {.rays = n, .empty_share = 0.05F, .most_stops = 1.0F, .least_width_m = widths.least_m, .most_width_m = widths.most_m};
}

// Gradients at the start, and a few steps.
CaseResult ConeSteps(const ConeSetting& setting, const Widths& widths) {
  SyntheticTrainer trainer(setting.Scene(), kConeSeed, 1), of_points({}, kConeSeed, 1);
  base::Random random(41);
  FillTable(random, &trainer.state().parameters.grid);
  if (setting.LikePoints()) of_points.state() = trainer.state();
  const ReferenceTrainer reference(trainer.target(), trainer.field());
  const std::vector<float> grid_before = trainer.state().parameters.grid;
  Worst worst;
  bool finite = true;
  for (int step = 0; step < 4; ++step) {
    const worker::RayBatch batch = trainer.Draw(RaysOf(widths, 96), random);
    const SyntheticTrainer::Gradients seen = trainer.GradientsOf(batch, kConeDistortion);
    std::vector<double> grid, networks;
    const ReferenceResult exact = reference.Gradient(batch, ReferenceState::From(trainer.state()), kConeDistortion, &grid, &networks);
    worst.Take(std::abs(seen.result.loss / exact.loss - 1.0));
    worst.Take(RelativeDistance(seen.grid, grid));
    worst.Take(RelativeDistance(seen.networks, networks));
    const worker::StepOptions options{.learning_rate = 1e-2, .network_l2 = 1e-6, .distortion = kConeDistortion};
    finite = trainer.Train(batch, options).finite && finite;
    if (setting.LikePoints()) of_points.Train(batch, options);
  }
  const bool resting = trainer.state().parameters.grid == grid_before;
  const bool same_as_points = setting.LikePoints() && SameParameters(trainer.state(), of_points.state());
  return {.seen = fmt::format("4 steps; {}", resting          ? "the table rests"
                                             : same_as_points ? "the bits of points"
                                                              : "all parameters finite"),
          .worst = worst.value(),
          .holds = finite && AllFinite(trainer.state()) && resting == std::isinf(widths.least_m) &&
                   same_as_points == (setting.LikePoints() && !(widths.most_m > 0.0))};
}

// The step's gradient by every parameter of a small field against central differences of the double loss.
CaseResult ConeDifferences(const ConeSetting& setting) {
  constexpr double kStep = 1e-5;
  SyntheticOptions scene = setting.Scene();
  scene.voxel_m = 0.5;
  scene.levels = 2;
  scene.log2_table_size = 4;
  scene.hidden = 4;
  SyntheticTrainer trainer(scene, kConeSeed, 1);
  base::Random random(43);
  FillTable(random, &trainer.state().parameters.grid);
  const Widths widths{"", 0.05, trainer.scene().edge_m};
  const worker::RayBatch batch = trainer.Draw(RaysOf(widths, 16), random);
  const SyntheticTrainer::Gradients seen = trainer.GradientsOf(batch, kConeDistortion);
  const ReferenceTrainer reference(trainer.target(), trainer.field());
  ReferenceState state = ReferenceState::From(trainer.state());
  const auto differences = [&](std::vector<double>& values) {
    std::vector<double> gradient;
    gradient.reserve(values.size());
    for (double& value : values) {
      const double at = value;
      value = at + kStep;
      const double above = reference.Gradient(batch, state, kConeDistortion, nullptr, nullptr).loss;
      value = at - kStep;
      const double below = reference.Gradient(batch, state, kConeDistortion, nullptr, nullptr).loss;
      value = at;
      gradient.push_back((above - below) / (2.0 * kStep));
    }
    return gradient;
  };
  Worst worst;
  worst.Take(RelativeDistance(seen.grid, differences(state.grid)));
  worst.Take(RelativeDistance(seen.networks, differences(state.networks)));
  return {.seen = fmt::format("{} parameters, footprints of 5 cm to 8 m", state.grid.size() + state.networks.size()), .worst = worst.value()};
}

}  // namespace

NumericGroup ConesGroup(const NumericsOptions& options) {
  const int samples = options.quick ? 500 : 5000, rays = options.quick ? 60 : 400;
  NumericGroup group{
      .id = "cones",
      .title = "Cones",
      .lead =
          "Footprints of samples, from nothing to infinite: features, renderings and training steps in float against double, with one, four and "
          "six positions per sample. Without footprint a sample with one position is a point, to the bit; an infinite one has no features."};
  for (const ConeSetting& setting : kConeSettings) {
    const std::string text = setting.Text();
    for (const Widths& widths : AllWidths()) {
      group.cases.push_back({.name = fmt::format("Features, footprint of {}{}", widths.name, text),
                             .expected = "as in double, to one float step of the position in the cell",
                             .unit = "features",
                             .limit = 2e-5,
                             .run = [setting, widths, samples] { return ConeFeatures(setting, widths, samples); }});
    }
    const auto renders = [&](const std::string& name, const Widths& widths, RayShape shape) {
      group.cases.push_back({.name = fmt::format("Rendering, {}{}", name, text),
                             .expected = "colour and opacity as in double",
                             .unit = "display value",
                             .limit = 2e-6,
                             .run = [setting, widths, shape, rays] { return ConeRendering(setting, widths, shape, rays); }});
    };
    for (const Widths& widths : AllWidths()) {
      const bool one_sample = widths.least_m > 1.0, points = !(widths.most_m > 0.0);
      if (one_sample || points) renders("columns of " + widths.name, widths, RayShape::kColumns);
      if (!points) renders("cones of " + widths.name, widths, RayShape::kCones);
    }
    renders("cones of 1 mm to 1 m in a contracted field", {"", 1e-3, 1.0}, RayShape::kFar);
    for (const Widths& widths : AllWidths()) {
      group.cases.push_back({.name = fmt::format("Training steps, footprint of {}{}", widths.name, text),
                             .expected = "finite; loss and gradients as the reference",
                             .unit = "relative",
                             .limit = 1e-4,
                             .run = [setting, widths] { return ConeSteps(setting, widths); }});
    }
    group.cases.push_back({.name = "Gradients of a step against differences in double" + text,
                           .expected = "every parameter's, as vectors of grid and networks",
                           .unit = "relative",
                           .limit = 1e-4,
                           .run = [setting] { return ConeDifferences(setting); }});
  }
  return group;
}

}  // namespace skyquilt::bench
