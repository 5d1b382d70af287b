#include "bench/numerics/reference_trainer.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace skyquilt::bench {
namespace {

constexpr double kMaxLogTau = 15.0;
const double kHiddenBehind = -std::log(1e-3);
// Of a colour, but only towards the middle of its range; and the optical depth of a sample from which on it gets no denser.
constexpr double kLeastSlope = 0.02, kNoDenserTau = 5.0;

// IEC 61966-2-1 and its derivatives.
double ToLinear(double srgb) {
  return srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4);
}
double ToSrgb(double linear) {
  return linear <= 0.0031308 ? linear * 12.92 : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
}
double ToLinearSlope(double srgb) {
  return srgb <= 0.04045 ? 1.0 / 12.92 : 2.4 / 1.055 * std::pow((srgb + 0.055) / 1.055, 1.4);
}
double ToSrgbSlope(double linear) {
  return linear <= 0.0031308 ? 12.92 : 1.055 / 2.4 * std::pow(linear, 1.0 / 2.4 - 1.0);
}

// The optical depth of one marching step and its derivative by the raw density; t0: that of an untrained field.
struct StepDepth {
  double tau = 0.0, slope = 0.0;
};
StepDepth DepthOf(double raw, const field::FieldConfig& config) {
  const double t0 = std::exp(config.density_bias), most = std::exp(kMaxLogTau);
  switch (config.density_activation) {
    case field::DensityActivation::kSoftplus: {
      const double grown = std::exp(raw) * std::expm1(t0);  // exp(raw + b)
      return {std::min(most, std::log1p(grown)), grown / (1.0 + grown)};
    }
    case field::DensityActivation::kRelu:
      return {std::clamp(raw + t0, 0.0, most), raw + t0 > 0.0 ? 1.0 : 0.0};
    default: {
      const double tau = std::exp(std::min(kMaxLogTau, raw + config.density_bias));
      return {tau, tau};
    }
  }
}

// A sample of a ray that is not hidden.
struct Lit {
  ReferenceField::Sample sample;
  double tau = 0.0, slope = 0.0, weight = 0.0, mid = 0.0;
  std::array<double, 3> rgb = {};
};

void Adam(double learning_rate, double correction1, double correction2, double gradient, double* parameter, double* moment1, double* moment2) {
  constexpr double kBeta1 = 0.9, kBeta2 = 0.99, kEpsilon = 1e-15;
  *moment1 = kBeta1 * *moment1 + (1.0 - kBeta1) * gradient;
  *moment2 = kBeta2 * *moment2 + (1.0 - kBeta2) * gradient * gradient;
  *parameter -= learning_rate * (*moment1 / correction1) / (std::sqrt(*moment2 / correction2) + kEpsilon);
}

}  // namespace

// With sharpness a, 1 / (sqrt(8) s) is a.
ReferenceField::Place PlaceOf(const kernel::Positions& at, size_t sample) {
  ReferenceField::Place place;
  for (size_t i = sample; place.positions.size() < static_cast<size_t>(at.points); i += at.plane) {
    place.positions.push_back({static_cast<double>(at.x[i]), static_cast<double>(at.y[i]), static_cast<double>(at.z[i])});
  }
  if (at.sharpness != nullptr) place.deviation = 1.0 / (std::sqrt(8.0) * static_cast<double>(at.sharpness[sample]));
  return place;
}

ReferenceState ReferenceState::From(const TrainingState& state, const worker::AppearanceCodes::State& codes) {
  const auto doubled = [](const std::vector<float>& values) { return std::vector<double>(values.begin(), values.end()); };
  return {.grid = doubled(state.parameters.grid),
          .networks = doubled(state.parameters.networks),
          .grid_moment1 = doubled(state.moments.grid_moment1),
          .grid_moment2 = doubled(state.moments.grid_moment2),
          .network_moment1 = doubled(state.moments.network_moment1),
          .network_moment2 = doubled(state.moments.network_moment2),
          .step = state.moments.step,
          .codes = doubled(codes.codes),
          .code_moment1 = doubled(codes.moment1),
          .code_moment2 = doubled(codes.moment2),
          .code_steps = codes.steps};
}

ReferenceTrainer::ReferenceTrainer(const render::TrainedField& target, const field::HashField& field) : target_(target), reference_(field) {}

ReferenceResult ReferenceTrainer::Ray(const worker::RayBatch& batch, const worker::BatchRay& ray, const ReferenceState& state, double ray_share,
                                      double distortion, std::vector<double>* grid_gradient, std::vector<double>* network_gradient,
                                      std::vector<double>* code_gradient) const {
  const size_t first_code = static_cast<size_t>(ray.ray.photo) * CodeNumbers();
  const bool has_code = !state.codes.empty();
  const std::array<double, 3> direction = {ray.ray.direction_enu.x(), ray.ray.direction_enu.y(), ray.ray.direction_enu.z()};
  const double range = target_.config.color_range;
  const double per_height = 1.0 / std::max(1.0, target_.map.max_enu().z() - target_.map.min_enu().z());
  const kernel::Positions at = batch.Positions(target_.config);
  std::vector<Lit> lit;
  double passed = 0.0;
  for (auto s = static_cast<size_t>(ray.begin); s < static_cast<size_t>(ray.begin + ray.count) && passed < kHiddenBehind; ++s) {
    Lit one;
    one.sample = reference_.ForwardDensity(state.grid, state.networks, PlaceOf(at, s));
    const StepDepth depth = DepthOf(one.sample.log_density, target_.config);
    one.tau = depth.tau * static_cast<double>(batch.unit_length[s]);
    one.slope = depth.slope * static_cast<double>(batch.unit_length[s]);
    const auto code = has_code ? std::span(state.codes).subspan(first_code, CodeNumbers()) : std::span<const double>();
    reference_.ForwardColor(state.networks, direction, code, &one.sample);
    for (size_t c = 0; c < 3; ++c) one.rgb[c] = range / (1.0 + std::exp(-one.sample.raw[c]));
    one.mid = (static_cast<double>(batch.t[s]) - static_cast<double>(batch.t[static_cast<size_t>(ray.begin)])) * per_height;
    passed += one.tau;
    lit.push_back(std::move(one));
  }
  std::array<double, 3> rgb = {};
  double before = 0.0;
  for (Lit& one : lit) {
    one.weight = std::exp(-before) * -std::expm1(-one.tau);
    before += one.tau;
    for (size_t c = 0; c < 3; ++c) rgb[c] += one.weight * one.rgb[c];
  }
  const double transmittance = std::exp(-before);

  ReferenceResult result;
  result.live = static_cast<int64_t>(lit.size());
  std::array<double, 3> rgb_gradient = {};
  double transmittance_gradient = 0.0;
  std::vector<double> weight_gradient(lit.size(), 0.0);
  const double photo_weight = std::pow(1.5, ray.ray.level);
  if (ray.ray.empty) {
    result.loss = (1.0 - transmittance) * (1.0 - transmittance);
    transmittance_gradient = -2.0 * (1.0 - transmittance) * ray_share;
  } else {
    for (size_t c = 0; c < 3; ++c) {
      const auto behind = static_cast<double>(ray.background[c]);
      const double shown = std::max(0.0, rgb[c] + transmittance * behind);
      const double gain = std::exp(static_cast<double>(ray.ray.exposure[c].log_gain));
      const double light = gain * ToLinear(shown);
      const auto target = static_cast<double>(ray.ray.target_srgb[c]);
      const double residual = ToSrgb(light) - target;
      result.squared_error += residual * residual;
      // A saturated pixel means "at least this bright", a black one "at most this bright".
      if ((target >= 254.5 / 255.0 && residual > 0.0) || (target <= 0.5 / 255.0 && residual < 0.0)) continue;
      result.loss += photo_weight * residual * residual;
      rgb_gradient[c] = photo_weight * 2.0 * residual * ToSrgbSlope(light) * gain * ToLinearSlope(shown) * ray_share;
      transmittance_gradient += rgb_gradient[c] * behind;
    }
    if (distortion > 0.0 && ray.ray.level == 0) {
      // Barron et al. 2022, eq. 15, pair by pair.
      const double width = target_.step_m * per_height;
      for (size_t i = 0; i < lit.size(); ++i) {
        result.loss += distortion * lit[i].weight * lit[i].weight * width / 3.0;
        weight_gradient[i] += ray_share * distortion * 2.0 * lit[i].weight * width / 3.0;
        for (size_t j = 0; j < lit.size(); ++j) {
          const double apart = std::abs(lit[i].mid - lit[j].mid);
          result.loss += distortion * lit[i].weight * lit[j].weight * apart;
          weight_gradient[i] += ray_share * distortion * 2.0 * lit[j].weight * apart;
        }
      }
    }
  }
  if (grid_gradient == nullptr) return result;

  // d w_j / d tau_i is T_i exp(-tau_i) for j = i and -w_j for j > i; the transmittance's is -T.
  std::vector<double> by_weight(lit.size());
  double behind_sum = transmittance * transmittance_gradient;
  double depth_behind = 0.0;
  for (size_t i = lit.size(); i-- > 0;) {
    by_weight[i] = weight_gradient[i];
    for (size_t c = 0; c < 3; ++c) by_weight[i] += rgb_gradient[c] * lit[i].rgb[c];
    const double tau_gradient = std::exp(-(before - depth_behind)) * by_weight[i] - behind_sum;
    depth_behind += lit[i].tau;
    behind_sum += lit[i].weight * by_weight[i];
    std::array<double, 3> raw_gradient;
    for (size_t c = 0; c < 3; ++c) {
      const double slope = lit[i].rgb[c] * (1.0 - lit[i].rgb[c] / range);
      const bool inwards = (rgb_gradient[c] > 0.0) == (lit[i].rgb[c] > 0.5 * range);
      raw_gradient[c] = rgb_gradient[c] * lit[i].weight * (inwards ? std::max(slope, kLeastSlope) : slope);
    }
    const double denser = lit[i].tau > kNoDenserTau && tau_gradient < 0.0 ? 0.0 : tau_gradient * lit[i].slope;
    reference_.Backward(state.networks, lit[i].sample, denser, raw_gradient, *grid_gradient, *network_gradient,
                        code_gradient != nullptr && has_code ? std::span(*code_gradient).subspan(first_code, CodeNumbers()) : std::span<double>());
  }
  return result;
}

ReferenceResult ReferenceTrainer::Gradient(const worker::RayBatch& batch, const ReferenceState& state, double distortion,
                                           std::vector<double>* grid_gradient, std::vector<double>* network_gradient,
                                           std::vector<double>* code_gradient) const {
  if (code_gradient != nullptr) code_gradient->assign(state.codes.size(), 0.0);
  if (grid_gradient != nullptr) {
    grid_gradient->assign(state.grid.size(), 0.0);
    network_gradient->assign(state.networks.size(), 0.0);
  }
  const double ray_share = 1.0 / static_cast<double>(std::max<size_t>(1, batch.rays.size()));
  ReferenceResult sum;
  int64_t color_rays = 0;
  for (const worker::BatchRay& ray : batch.rays) {
    const ReferenceResult one = Ray(batch, ray, state, ray_share, distortion, grid_gradient, network_gradient, code_gradient);
    sum.loss += one.loss * ray_share;
    sum.squared_error += one.squared_error;
    sum.live += one.live;
    color_rays += ray.ray.empty ? 0 : 1;
  }
  sum.squared_error /= 3.0 * static_cast<double>(std::max<int64_t>(1, color_rays));
  return sum;
}

ReferenceResult ReferenceTrainer::Step(const worker::RayBatch& batch, const worker::StepOptions& options, ReferenceState& state) const {
  std::vector<double> grid_gradient, network_gradient, code_gradient;
  const ReferenceResult result = Gradient(batch, state, options.distortion, &grid_gradient, &network_gradient, &code_gradient);
  ++state.step;
  const auto t = static_cast<double>(state.step);
  const double correction1 = 1.0 - std::pow(0.9, t), correction2 = 1.0 - std::pow(0.99, t);
  for (size_t i = 0; i < state.networks.size(); ++i) {
    Adam(options.learning_rate, correction1, correction2, network_gradient[i] + options.network_l2 * state.networks[i], &state.networks[i],
         &state.network_moment1[i], &state.network_moment2[i]);
  }
  for (size_t i = 0; i < state.grid.size(); ++i) {
    // Entries that no sample moves keep their moments.
    if (grid_gradient[i] == 0.0) continue;
    Adam(options.learning_rate, correction1, correction2, grid_gradient[i], &state.grid[i], &state.grid_moment1[i], &state.grid_moment2[i]);
  }
  if (!state.codes.empty()) StepCodes(batch, options.learning_rate, code_gradient, state);
  return result;
}

void ReferenceTrainer::StepCodes(const worker::RayBatch& batch, double learning_rate, const std::vector<double>& gradient,
                                 ReferenceState& state) const {
  std::set<size_t> drawn;
  for (const worker::BatchRay& ray : batch.rays) {
    if (!ray.ray.empty) drawn.insert(static_cast<size_t>(ray.ray.photo));
  }
  const size_t n = CodeNumbers();
  for (const size_t photo : drawn) {
    const auto t = static_cast<double>(++state.code_steps[photo]);
    for (size_t i = photo * n; i < (photo + 1) * n; ++i) {
      Adam(learning_rate, 1.0 - std::pow(0.9, t), 1.0 - std::pow(0.99, t), gradient[i], &state.codes[i], &state.code_moment1[i],
           &state.code_moment2[i]);
    }
  }
  for (size_t k = 0; k < n; ++k) {
    double sum = 0.0, count = 0.0;
    for (size_t photo = 0; photo < state.code_steps.size(); ++photo) {
      if (state.code_steps[photo] == 0) continue;
      sum += state.codes[photo * n + k];
      count += 1.0;
    }
    for (size_t photo = 0; photo < state.code_steps.size(); ++photo) {
      if (state.code_steps[photo] > 0) state.codes[photo * n + k] -= sum / count;
    }
  }
}

}  // namespace skyquilt::bench
