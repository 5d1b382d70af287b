#include "bench/study/buildings_pool.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/base/order_statistics.h"
#include "core/base/random.h"
#include "evaluate/buildings/measure_errors.h"

namespace skyquilt::bench {
namespace {

using evaluate::buildings::BuildingOutcome;
using Fate = BuildingOutcome::Fate;

constexpr std::array<const char*, 9> kPooledMeasures = {"deck", "eave", "ridge", "ground", "height", "length", "width", "yaw", "footprint"};

double ShareOrNone(int64_t part, int64_t whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : VariantResult::kNone;
}

const BuildingOutcome::Error* Find(const BuildingOutcome& outcome, const std::string& measure) {
  const auto at = std::find_if(outcome.errors.begin(), outcome.errors.end(), [&](const auto& error) { return error.measure == measure; });
  return at == outcome.errors.end() ? nullptr : &*at;
}

template <typename Keep>
BuildingPool Those(const BuildingPool& pool, const Keep& keep) {
  BuildingPool kept;
  std::copy_if(pool.begin(), pool.end(), std::back_inserter(kept), keep);
  return kept;
}

}  // namespace

BuildingPool PoolBuildings(std::span<const VariantResult> towns) {
  BuildingPool pool;
  for (const VariantResult& town : towns) {
    if (!town.buildings || !town.buildings->truth) continue;
    for (const BuildingOutcome& outcome : town.buildings->truth->each) pool.push_back({&outcome, town.buildings->gsd_m});
  }
  return pool;
}

BuildingPool OfSize(const BuildingPool& pool, double from_m2, double to_m2) {
  return Those(pool, [&](const PooledBuilding& one) { return one.outcome->area_m2 >= from_m2 && one.outcome->area_m2 < to_m2; });
}

PooledFigure Bootstrap(const BuildingPool& pool, const PoolStatistic& statistic, int resamples) {
  constexpr double kTail = 0.025;
  PooledFigure figure;
  figure.value = statistic(pool);
  if (pool.size() < 2 || !std::isfinite(figure.value)) return figure;
  std::vector<double> drawn;
  BuildingPool sample(pool.size());
  base::Random random(1);  // any sequence does; the same one makes the figures repeatable
  for (int i = 0; i < resamples; ++i) {
    for (PooledBuilding& one : sample) one = pool[random.Below(static_cast<uint32_t>(pool.size()))];
    if (const double value = statistic(sample); std::isfinite(value)) drawn.push_back(value);
  }
  figure.low = base::Quantile(drawn, kTail);
  figure.high = base::Quantile(std::move(drawn), 1.0 - kTail);
  return figure;
}

PooledCounts Count(const BuildingPool& pool) {
  PooledCounts counts;
  for (const PooledBuilding& one : pool) {
    const Fate fate = one.outcome->fate;
    ++(fate == Fate::kMatched ? counts.matched : fate == Fate::kMissed ? counts.missed : counts.invented);
  }
  return counts;
}

double Completeness(const BuildingPool& pool) {
  const PooledCounts counts = Count(pool);
  return ShareOrNone(counts.matched, counts.Outlines());
}

double Correctness(const BuildingPool& pool) {
  const PooledCounts counts = Count(pool);
  return ShareOrNone(counts.matched, counts.matched + counts.invented);
}

double Quality(const BuildingPool& pool) {
  const PooledCounts counts = Count(pool);
  return ShareOrNone(counts.matched, counts.Outlines() + counts.invented);
}

double RoofKindRight(const BuildingPool& pool) {
  int64_t right = 0, matched = 0;
  for (const PooledBuilding& one : pool) {
    if (one.outcome->fate != Fate::kMatched) continue;
    ++matched;
    right += one.outcome->roof == one.outcome->roof_found ? 1 : 0;
  }
  return ShareOrNone(right, matched);
}

std::span<const char* const> PooledMeasures() {
  return kPooledMeasures;
}

std::string UnitOfMeasure(const std::string& measure) {
  if (measure == "yaw") return "\xC2\xB0";
  return measure == "footprint" ? "m\xC2\xB2" : "m";
}

bool IsLength(const std::string& measure) {
  return UnitOfMeasure(measure) == "m";
}

evaluate::buildings::BuildingErrors PooledErrors(const BuildingPool& pool, const std::string& measure, bool in_gsd) {
  std::vector<evaluate::buildings::MeasureError> errors;
  for (const PooledBuilding& one : pool) {
    const BuildingOutcome::Error* error = Find(*one.outcome, measure);
    if (error == nullptr) continue;
    const double unit = in_gsd ? one.gsd_m : 1.0;
    errors.push_back({error->error / unit, error->sigma / unit});
  }
  return evaluate::buildings::SummariseErrors(measure.c_str(), errors);
}

double WithinSigma(const BuildingPool& pool) {
  std::vector<evaluate::buildings::MeasureError> errors;
  for (const PooledBuilding& one : pool) {
    for (const BuildingOutcome::Error& error : one.outcome->errors) errors.push_back({error.error, error.sigma});
  }
  return evaluate::buildings::SummariseErrors("", errors).within_sigma;
}

BuildingPool WithMeasure(const BuildingPool& pool, const std::string& measure) {
  return Those(pool, [&](const PooledBuilding& one) { return Find(*one.outcome, measure) != nullptr; });
}

}  // namespace skyquilt::bench
