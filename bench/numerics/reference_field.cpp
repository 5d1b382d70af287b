#include "bench/numerics/reference_field.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace skyquilt::bench {
namespace {

// P_l^m(z) with the phase, m >= 0, by the recurrences of Abramowitz and Stegun 8.5.
double Legendre(int l, int m, double z) {
  double p_mm = 1.0;
  for (int k = 1; k <= m; ++k) p_mm *= -(2.0 * k - 1.0) * std::sqrt(std::max(0.0, 1.0 - z * z));
  if (l == m) return p_mm;
  double before = p_mm, now = z * (2.0 * m + 1.0) * p_mm;
  for (int k = m + 2; k <= l; ++k) {
    const double next = (z * (2.0 * k - 1.0) * now - (k + m - 1.0) * before) / (k - m);
    before = now;
    now = next;
  }
  return now;
}

}  // namespace

std::vector<double> ReferenceHarmonics(const std::array<double, 3>& direction, int degree) {
  const double azimuth = std::atan2(direction[1], direction[0]);
  std::vector<double> values;
  for (int l = 0; l < degree; ++l) {
    for (int m = -l; m <= l; ++m) {
      const int order = std::abs(m);
      const double norm = std::sqrt((2.0 * l + 1.0) / (4.0 * std::numbers::pi) * std::tgamma(l - order + 1.0) / std::tgamma(l + order + 1.0));
      const double around = m == 0 ? 1.0 : std::numbers::sqrt2 * (m > 0 ? std::cos(order * azimuth) : std::sin(order * azimuth));
      values.push_back(norm * around * Legendre(l, order, direction[2]));
    }
  }
  return values;
}

ReferenceField::ReferenceField(const field::HashField& field) : field_(field), grid_(field.config().grid) {
  if (field.config().encoding != encoding::Kind::kHash) throw std::invalid_argument("the reference supports hash grids only");
  if (field.config().density_hidden_layers != 1) throw std::invalid_argument("the reference's density network has one hidden layer");
  if (field.config().normal_head) throw std::invalid_argument("the reference does not support normal heads");
  if (field.config().luminance) throw std::invalid_argument("the reference does not support luminance");
  const auto hidden = static_cast<size_t>(field.config().hidden);
  size_t offset = 0;
  const auto add = [&](size_t outputs, size_t inputs, bool relu) {
    layers_.push_back({outputs, inputs, offset, relu});
    offset += outputs * inputs;
  };
  add(hidden, static_cast<size_t>(field.FeatureRows()), true);
  add(field::kGeometryRows, hidden, false);
  add(hidden, static_cast<size_t>(field.ColorInputRows()), true);
  for (int l = 1; l < field.config().color_hidden_layers; ++l) add(hidden, hidden, true);
  add(field::kColorRows, hidden, false);
  if (offset != static_cast<size_t>(field.NetworkParameters()))
    throw std::invalid_argument("the reference's networks differ in size from the field's");
}

double ReferenceField::Weight(int level, const Place& place) const {
  // Barron et al. 2023, section 3: erf(1 / sqrt(8 s^2 n^2)), n cells per unit length.
  return std::erf(1.0 / (std::sqrt(8.0) * place.deviation * static_cast<double>(grid_.level(level).cells_per_unit)));
}

std::vector<ReferenceField::Corner> ReferenceField::Corners(int level, const Place& place) const {
  const double weight = Weight(level, place);
  std::vector<Corner> corners;
  corners.reserve(8 * place.positions.size());
  for (const std::array<double, 3>& position : place.positions)
    AddCorners(level, position, weight / static_cast<double>(place.positions.size()), &corners);
  return corners;
}

void ReferenceField::AddCorners(int level, const std::array<double, 3>& position, double share, std::vector<Corner>* corners) const {
  const kernel::GridLevel& shape = grid_.level(level);
  std::array<uint64_t, 3> cell = {};
  std::array<double, 3> fraction = {};
  for (size_t axis = 0; axis < 3; ++axis) {
    const double last = shape.size[axis] - 1.0;
    const double at = position[axis] * static_cast<double>(shape.cells_per_unit);
    const double scaled = at > 0.0 ? std::min(at, last) : 0.0;
    const double low = std::min(std::floor(scaled), last - 1.0);
    cell[axis] = static_cast<uint64_t>(low);
    fraction[axis] = scaled - low;
  }
  for (size_t c = 0; c < 8; ++c) {
    std::array<uint64_t, 3> at = cell;
    double weight = share;
    for (size_t axis = 0; axis < 3; ++axis) {
      const bool upper = (c >> axis & 1U) != 0;
      at[axis] += upper ? 1 : 0;
      weight *= upper ? fraction[axis] : 1.0 - fraction[axis];
    }
    // Mueller et al. 2022, eq. 4, in 32-bit arithmetic; a level that fits into the table is stored densely, in order.
    const uint64_t hash = (at[0] ^ at[1] * 2654435761ULL ^ at[2] * 805459861ULL) & 0xFFFFFFFFULL;
    const uint64_t in_order = at[0] + static_cast<uint64_t>(shape.size[0]) * (at[1] + static_cast<uint64_t>(shape.size[1]) * at[2]);
    const uint64_t entry = shape.dense ? in_order : hash % shape.entries;
    corners->push_back({static_cast<size_t>(grid_.Offset(level)) + entry * static_cast<size_t>(field_.config().grid.features), weight});
  }
}

std::vector<double> ReferenceField::Apply(const Layer& layer, std::span<const double> networks, const std::vector<double>& in) {
  std::vector<double> out(layer.outputs, 0.0);
  for (size_t o = 0; o < layer.outputs; ++o) {
    for (size_t i = 0; i < layer.inputs; ++i) out[o] += networks[layer.offset + o * layer.inputs + i] * in[i];
    if (layer.relu) out[o] = std::max(out[o], 0.0);
  }
  return out;
}

std::vector<double> ReferenceField::Features(std::span<const double> grid, const Place& place) const {
  std::vector<double> features;
  const auto per_entry = static_cast<size_t>(field_.config().grid.features);
  for (int level = 0; level < grid_.levels(); ++level) {
    std::vector<double> sum(per_entry, 0.0);
    for (const Corner& corner : Corners(level, place)) {
      for (size_t f = 0; f < per_entry; ++f) sum[f] += corner.weight * grid[corner.first + f];
    }
    features.insert(features.end(), sum.begin(), sum.end());
  }
  return features;
}

std::vector<double> ReferenceField::Scales(const Place& place) const {
  std::vector<double> scales;
  if (!field_.config().scale_features) return scales;
  for (int level = (grid_.levels() - 1) % 2; level < grid_.levels(); level += 2) scales.push_back(1.0 - Weight(level, place));
  while (scales.size() % 4 != 0) scales.push_back(0.0);
  return scales;
}

ReferenceField::Sample ReferenceField::ForwardDensity(std::span<const double> grid, std::span<const double> networks, const Place& place) const {
  Sample sample;
  sample.place = place;
  sample.inputs.push_back(Features(grid, place));
  const std::vector<double> scales = Scales(place);
  sample.inputs.back().insert(sample.inputs.back().end(), scales.begin(), scales.end());
  sample.outputs.push_back(Apply(layers_[0], networks, sample.inputs.back()));
  sample.inputs.push_back(sample.outputs.back());
  sample.outputs.push_back(Apply(layers_[1], networks, sample.inputs.back()));
  sample.log_density = sample.outputs.back()[0];
  return sample;
}

void ReferenceField::ForwardColor(std::span<const double> networks, const std::array<double, 3>& direction, std::span<const double> code,
                                  Sample* sample) const {
  std::vector<double> in = sample->outputs[1];
  const std::vector<double> harmonics = ReferenceHarmonics(direction, field_.config().sh_degree);
  in.insert(in.end(), harmonics.begin(), harmonics.end());
  in.resize(FirstCode(), 0.0);
  in.insert(in.end(), code.begin(), code.end());
  in.resize(layers_[2].inputs, 0.0);
  for (size_t l = 2; l < layers_.size(); ++l) {
    sample->inputs.push_back(in);
    in = Apply(layers_[l], networks, in);
    sample->outputs.push_back(in);
  }
  std::copy_n(in.begin(), 3, sample->raw.begin());
}

ReferenceField::Sample ReferenceField::Forward(std::span<const double> grid, std::span<const double> networks, const Place& place,
                                               const std::array<double, 3>& direction) const {
  Sample sample = ForwardDensity(grid, networks, place);
  ForwardColor(networks, direction, {}, &sample);
  return sample;
}

void ReferenceField::Backward(std::span<const double> networks, const Sample& sample, double log_density_gradient,
                              const std::array<double, 3>& raw_gradient, std::span<double> grid_gradient, std::span<double> network_gradient,
                              std::span<double> code_gradient) const {
  std::vector<double> gradient(layers_.back().outputs, 0.0);
  std::copy(raw_gradient.begin(), raw_gradient.end(), gradient.begin());
  for (size_t l = layers_.size(); l-- > 0;) {
    const Layer& layer = layers_[l];
    if (l == 1) {
      // The density network's outputs: gradient from the colour network, and on row 0 also from the density.
      gradient.resize(layer.outputs);
      gradient[0] += log_density_gradient;
    }
    std::vector<double> below(layer.inputs, 0.0);
    for (size_t o = 0; o < layer.outputs; ++o) {
      if (layer.relu && sample.outputs[l][o] <= 0.0) continue;
      for (size_t i = 0; i < layer.inputs; ++i) {
        network_gradient[layer.offset + o * layer.inputs + i] += gradient[o] * sample.inputs[l][i];
        below[i] += gradient[o] * networks[layer.offset + o * layer.inputs + i];
      }
    }
    for (size_t k = 0; l == 2 && k < code_gradient.size(); ++k) code_gradient[k] += below[FirstCode() + k];
    gradient = std::move(below);
  }
  const auto per_entry = static_cast<size_t>(field_.config().grid.features);
  for (int level = 0; level < grid_.levels(); ++level) {
    for (const Corner& corner : Corners(level, sample.place)) {
      for (size_t f = 0; f < per_entry; ++f) {
        grid_gradient[corner.first + f] += corner.weight * gradient[static_cast<size_t>(level) * per_entry + f];
      }
    }
  }
}

}  // namespace skyquilt::bench
