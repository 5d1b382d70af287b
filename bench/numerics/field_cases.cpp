// Every kernel on every instruction set of this processor, against a scalar version in double.

#include <algorithm>
#include <cmath>

#include "bench/numerics/groups.h"
#include "core/base/random.h"
#include "core/kernel/kernels.h"
#include "core/kernel/reference.h"

namespace skyquilt::bench {
namespace {

namespace twin = kernel::reference;

// Runs the check with each instruction set, and then restores the one that was in use.
NumericCase KernelCase(const std::string& name, const std::string& expected, double limit, const std::function<CaseResult()>& check) {
  return {.name = name, .expected = expected, .unit = "relative", .limit = limit, .run = [check] {
            const std::string active = kernel::ActiveInstructionSet();
            Worst worst;
            CaseResult all;
            try {
              for (const std::string& set : kernel::InstructionSets()) {
                kernel::ForceInstructionSet(set);
                const CaseResult finding = check();
                worst.Take(finding.worst);
                all.holds = all.holds && finding.holds;
                all.seen += (all.seen.empty() ? "" : ", ") + set;
              }
            } catch (...) {
              kernel::ForceInstructionSet(active);
              throw;
            }
            kernel::ForceInstructionSet(active);
            all.worst = worst.value();
            return all;
          }};
}

std::vector<float> RandomFloats(base::Random& random, size_t n) {
  std::vector<float> values(n);
  for (float& value : values) value = 2.0F * random.Uniform() - 1.0F;
  return values;
}

double InDouble(float value) {
  return static_cast<double>(value);
}

// Forward, gated and weight gradient of one layer, errors relative to the sum of the terms' sizes.
CaseResult DenseLayers() {
  base::Random random(83);
  Worst worst;
  for (const auto& [n_out, n_in] : {std::pair<int, int>{4, 4}, {16, 64}, {64, 36}, {256, 256}}) {
    constexpr size_t kSamples = 48;
    const auto outputs = static_cast<size_t>(n_out), inputs = static_cast<size_t>(n_in);
    const std::vector<float> weights = RandomFloats(random, outputs * inputs), in = RandomFloats(random, inputs * kSamples);
    const std::vector<float> out_gradient = RandomFloats(random, outputs * kSamples), gate = RandomFloats(random, outputs * kSamples);
    std::vector<float> plain(outputs * kSamples), relu(plain.size()), gated(plain.size()), weight_gradient(weights.size(), 0.0F);
    kernel::Dense(weights.data(), n_out, n_in, in.data(), kSamples, kSamples, false, plain.data(), kSamples);
    kernel::Dense(weights.data(), n_out, n_in, in.data(), kSamples, kSamples, true, relu.data(), kSamples);
    kernel::DenseGated(weights.data(), n_out, n_in, in.data(), kSamples, kSamples, gate.data(), kSamples, gated.data(), kSamples);
    kernel::DenseWeightGradient(out_gradient.data(), kSamples, n_out, in.data(), kSamples, n_in, kSamples, weight_gradient.data());
    const std::vector<double> exact_weights(weights.begin(), weights.end());
    for (size_t s = 0; s < kSamples; ++s) {
      std::vector<double> sample(inputs);
      for (size_t i = 0; i < inputs; ++i) sample[i] = InDouble(in[i * kSamples + s]);
      const std::vector<double> exact = twin::Dense(exact_weights, n_out, sample, false);
      for (size_t o = 0; o < outputs; ++o) {
        const size_t at = o * kSamples + s;
        double size = 0.0;
        for (size_t i = 0; i < inputs; ++i) size += std::abs(exact_weights[o * inputs + i] * sample[i]);
        worst.Take(std::abs(InDouble(plain[at]) - exact[o]) / size);
        worst.Take(std::abs(InDouble(relu[at]) - std::max(0.0, exact[o])) / size);
        worst.Take(std::abs(InDouble(gated[at]) - (gate[at] > 0.0F ? exact[o] : 0.0)) / size);
      }
    }
    for (size_t o = 0; o < outputs; ++o) {
      for (size_t i = 0; i < inputs; ++i) {
        double exact = 0.0, size = 0.0;
        for (size_t s = 0; s < kSamples; ++s) {
          const double term = InDouble(out_gradient[o * kSamples + s]) * InDouble(in[i * kSamples + s]);
          exact += term;
          size += std::abs(term);
        }
        worst.Take(std::abs(InDouble(weight_gradient[o * inputs + i]) - exact) / size);
      }
    }
  }
  return {.worst = worst.value()};
}

// Lookup and its gradient for batches of several sizes, some positions outside the box. Errors relative to the largest value.
CaseResult HashLookups(const kernel::GridLevel& level, int features, const std::vector<int64_t>& batches) {
  base::Random random(89);
  const size_t per_entry = static_cast<size_t>(features);
  const size_t floats = (level.entries * per_entry + kernel::kLineFloats - 1) / kernel::kLineFloats * kernel::kLineFloats;
  std::vector<float> table(floats), gradient(floats, 0.0F);
  for (float& value : table) value = 2.0F * random.Uniform() - 1.0F;
  std::vector<uint8_t> touched(floats / kernel::kLineFloats, 0);
  Worst worst;
  bool holds = true;
  for (const int64_t n : batches) {
    const auto count = static_cast<size_t>(n);
    std::vector<float> x(count), y(count), z(count), out(per_entry * count), out_gradient = RandomFloats(random, per_entry * count);
    for (auto* axis : {&x, &y, &z}) {
      for (float& value : *axis) value = random.Uniform() < 0.05F ? 3.0F * random.Uniform() - 1.0F : random.Uniform();
    }
    kernel::HashForward(level, features, table.data(), {x.data(), y.data(), z.data()}, n, out.data(), count);
    kernel::HashBackward(level, features, {x.data(), y.data(), z.data()}, n, out_gradient.data(), count, gradient.data(), touched.data());
    // Entries that the samples read, and their expected gradients.
    std::vector<std::pair<size_t, double>> additions;
    for (size_t s = 0; s < count; ++s) {
      const double position[3] = {InDouble(x[s]), InDouble(y[s]), InDouble(z[s])};
      std::vector<double> exact(per_entry, 0.0);
      for (const twin::Corner<double>& corner : twin::Corners(level, position)) {
        for (size_t f = 0; f < per_entry; ++f) {
          exact[f] += corner.weight * InDouble(table[corner.entry * per_entry + f]);
          additions.emplace_back(corner.entry * per_entry + f, corner.weight * InDouble(out_gradient[f * count + s]));
        }
      }
      for (size_t f = 0; f < per_entry; ++f) worst.Take(std::abs(InDouble(out[f * count + s]) - exact[f]));
    }
    std::sort(additions.begin(), additions.end());
    for (size_t i = 0; i < additions.size();) {
      const size_t at = additions[i].first;
      double exact = 0.0;
      for (; i < additions.size() && additions[i].first == at; ++i) exact += additions[i].second;
      worst.Take(std::abs(InDouble(gradient[at]) - exact) / std::max(1.0, std::abs(exact)));
      holds = holds && (gradient[at] == 0.0F || touched[at / kernel::kLineFloats] != 0);
      gradient[at] = 0.0F;
    }
    // No other entry has changed.
    holds = holds && std::all_of(gradient.begin(), gradient.end(), [](float value) { return value == 0.0F; });
    std::fill(touched.begin(), touched.end(), uint8_t{0});
  }
  return {.worst = worst.value(), .holds = holds};
}

kernel::GridLevel LevelOf(int cells, int log2_entries) {
  kernel::GridLevel level;
  level.cells_per_unit = static_cast<float>(cells);
  std::fill(level.size, level.size + 3, cells + 1);
  const double points = std::pow(cells + 1.0, 3.0);
  level.dense = points <= std::exp2(log2_entries);
  level.entries = level.dense ? static_cast<uint32_t>(points) : 1U << static_cast<uint32_t>(log2_entries);
  return level;
}

// exp(min(limit, x + bias)) and range / (1 + exp(-x)), also for very large and very small x.
CaseResult Elementwise() {
  std::vector<float> x = {0.0F,
                          1e-30F,
                          88.0F,
                          -88.0F,
                          104.0F,
                          -104.0F,
                          1e4F,
                          -1e4F,
                          1e30F,
                          -1e30F,
                          std::numeric_limits<float>::infinity(),
                          -std::numeric_limits<float>::infinity()};
  base::Random random(97);
  while (x.size() < 4096) x.push_back(static_cast<float>(random.Uniform(-30.0, 30.0)));
  const auto n = static_cast<int64_t>(x.size());
  std::vector<float> exp(x.size()), sigmoid(x.size());
  kernel::ExpShifted(x.data(), n, -3.0F, 15.0F, exp.data());
  kernel::Sigmoid(x.data(), n, 1.4F, sigmoid.data());
  Worst worst;
  bool finite = true;
  for (size_t i = 0; i < x.size(); ++i) {
    const double exact_exp = std::exp(std::min(15.0, InDouble(x[i] + -3.0F)));
    const double exact_sigmoid = InDouble(1.4F) / (1.0 + std::exp(-InDouble(x[i])));
    finite = finite && std::isfinite(exp[i]) && std::isfinite(sigmoid[i]);
    // Smaller values do not change any sum.
    constexpr double kNothing = 1e-20;
    worst.Take(std::abs(InDouble(exp[i]) - exact_exp) / std::max(kNothing, exact_exp));
    worst.Take(std::abs(InDouble(sigmoid[i]) - exact_sigmoid) / std::max(kNothing, exact_sigmoid));
  }
  return {.worst = worst.value(), .holds = finite};
}

// Fifty steps of Adam with gradients of very different size; entries without gradient must not change.
CaseResult AdamSteps(double smallest, double largest) {
  constexpr size_t kFloats = 64 * kernel::kLineFloats;
  base::Random random(101);
  std::vector<float> dense = RandomFloats(random, kFloats), table = dense, m1(kFloats, 0.0F), m2(kFloats, 0.0F), t1(kFloats, 0.0F), t2(kFloats, 0.0F);
  std::vector<double> exact(dense.begin(), dense.end()), e1(kFloats, 0.0), e2(kFloats, 0.0), lazy = exact, l1 = e1, l2 = e2;
  Worst worst;
  bool holds = true;
  const double learning_rate = 1e-2;
  const auto adam = [&](double g, double correction1, double correction2, double* p, double* m, double* v) {
    const kernel::AdamStep defaults;
    const double beta1 = InDouble(defaults.beta1), beta2 = InDouble(defaults.beta2);
    *m = beta1 * *m + (1.0 - beta1) * g;
    *v = beta2 * *v + (1.0 - beta2) * g * g;
    *p -= learning_rate * (*m / correction1) / (std::sqrt(*v / correction2) + InDouble(defaults.epsilon));
  };
  for (int step = 1; step <= 50; ++step) {
    kernel::AdamStep shape;
    const double correction1 = 1.0 - std::pow(InDouble(shape.beta1), step), correction2 = 1.0 - std::pow(InDouble(shape.beta2), step);
    shape.learning_rate = static_cast<float>(learning_rate);
    shape.correction1 = static_cast<float>(correction1);
    shape.correction2 = static_cast<float>(correction2);
    std::vector<float> gradient(kFloats);
    for (float& value : gradient) {
      const double size = std::exp(random.Uniform(std::log(smallest), std::log(largest)));
      value = random.Uniform() < 0.3F ? 0.0F : static_cast<float>(random.Uniform() < 0.5F ? size : -size);
    }
    std::vector<float> table_gradient = gradient, dense_gradient = gradient;
    std::vector<uint8_t> touched(kFloats / kernel::kLineFloats, 1);
    touched[3] = 0;  // a cache line without gradients
    std::fill_n(table_gradient.begin() + 3 * kernel::kLineFloats, kernel::kLineFloats, 0.0F);
    const std::vector<float> table_before = table;
    const std::vector<float> moving = table_gradient;
    kernel::AdamDense(shape, 0.0F, kFloats, dense.data(), dense_gradient.data(), m1.data(), m2.data());
    kernel::AdamTouched(shape, kFloats / kernel::kLineFloats, touched.data(), table.data(), table_gradient.data(), t1.data(), t2.data());
    for (size_t i = 0; i < kFloats; ++i) {
      adam(InDouble(gradient[i]), correction1, correction2, &exact[i], &e1[i], &e2[i]);
      if (moving[i] != 0.0F) adam(InDouble(moving[i]), correction1, correction2, &lazy[i], &l1[i], &l2[i]);
      // Relative to the parameters' size, which is about one.
      worst.Take(std::abs(InDouble(dense[i]) - exact[i]));
      worst.Take(std::abs(InDouble(table[i]) - lazy[i]));
      holds = holds && (moving[i] != 0.0F || table[i] == table_before[i]) && table_gradient[i] == 0.0F && dense_gradient[i] == 0.0F;
    }
  }
  return {.worst = worst.value(), .holds = holds};
}

// CaseResult a non-finite value at every index, and packing the samples that are kept.
CaseResult FiniteAndCompact() {
  bool holds = true;
  for (const size_t n : {0U, 1U, 15U, 16U, 17U, 100U}) {
    std::vector<float> values(n, 3e38F);
    holds = holds && kernel::AllFinite(values.data(), static_cast<int64_t>(n));
    for (size_t i = 0; i < n; ++i) {
      for (const float bad : {std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity(), std::nanf("")}) {
        values[i] = bad;
        holds = holds && !kernel::AllFinite(values.data(), static_cast<int64_t>(n));
        values[i] = 3e38F;
      }
    }
  }
  base::Random random(103);
  constexpr size_t kSamples = 208;
  for (int round = 0; round < 50; ++round) {
    std::vector<float> keep(kSamples), in = RandomFloats(random, 2 * kSamples), out(2 * kSamples + kernel::kPad, 0.0F), wanted[2];
    for (size_t s = 0; s < kSamples; ++s) {
      keep[s] = random.Uniform() < 0.5F ? 1.0F : 0.0F;
      for (size_t row = 0; row < 2 && keep[s] > 0.0F; ++row) wanted[row].push_back(in[row * kSamples + s]);
    }
    const int64_t kept = kernel::Compact(keep.data(), kSamples, 2, in.data(), kSamples, out.data(), kSamples);
    holds = holds && kept == static_cast<int64_t>(wanted[0].size());
    for (size_t row = 0; row < 2; ++row)
      holds = holds && std::equal(wanted[row].begin(), wanted[row].end(), out.begin() + static_cast<long>(row * kSamples));
  }
  return {.worst = 0.0, .holds = holds};
}

}  // namespace

NumericGroup FieldGroup(const NumericsOptions& options) {
  NumericGroup group{
      .id = "field",
      .title = "Kernels of the field",
      .lead =
          "Each kernel on every instruction set of this processor (named under \xE2\x80\x9Cseen\xE2\x80\x9D) against a scalar version in "
          "double. Errors of sums are relative to the sizes of their terms. The whole field, forward and backward, is checked under Trainer."};
  const std::vector<int64_t> batches = {0, 1, 15, 16, 17, 1000};
  const auto lookups = [&](const std::string& name, const kernel::GridLevel& level, int features, double limit) {
    group.cases.push_back(KernelCase(name, "features and gradients to one float step of the position in the cell; nothing else written", limit,
                                     [level, features, batches] { return HashLookups(level, features, batches); }));
  };
  group.cases.push_back(KernelCase("Dense layers, 4 to 256 wide", "to a few roundings of the sum's terms", 2e-6, DenseLayers));
  lookups("Grid of 16 cells, dense", LevelOf(16, 14), 4, 1e-5);
  lookups("Grid of 512 cells, table of 2^17", LevelOf(512, 17), 4, 2e-4);
  lookups("Grid of 512 cells, table of 2^1", LevelOf(512, 1), 2, 2e-4);
  if (!options.quick) lookups("Grid of 4096 cells, table of 2^24", LevelOf(4096, 24), 2, 2e-3);
  group.cases.push_back(KernelCase("Exponential and sigmoid", "finite from minus to plus infinity, to a few roundings", 2e-6, Elementwise));
  group.cases.push_back(KernelCase("Adam, gradients from 10^-12 to 10^6", "parameters as in double, resting entries untouched", 1e-5,
                                   [] { return AdamSteps(1e-12, 1e6); }));
  group.cases.push_back(KernelCase("Adam, gradients from 10^-17 to 10^18", "parameters as in double, resting entries untouched", 1e-5,
                                   [] { return AdamSteps(1e-17, 1e18); }));
  group.cases.push_back(KernelCase("CaseResult NaN, packing samples", "every place, any number of values", 0.0, FiniteAndCompact));
  return group;
}

}  // namespace skyquilt::bench
