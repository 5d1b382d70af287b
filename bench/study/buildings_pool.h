// Figures about buildings over several towns, with bootstrap intervals. Single buildings are pooled, not figures of towns: a mean of RMSEs would give
// a town with few buildings as much weight as one with many.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "bench/study/study.h"
#include "evaluate/buildings/building_scores.h"

namespace skyquilt::bench {

// A building of one town.
struct PooledBuilding {
  const evaluate::buildings::BuildingOutcome* outcome = nullptr;
  double gsd_m = std::numeric_limits<double>::quiet_NaN();  // ground sampling distance of its town
};
using BuildingPool = std::vector<PooledBuilding>;

// Of all results that have buildings and their truth, in order. Refers to the results.
BuildingPool PoolBuildings(std::span<const VariantResult> towns);
// Those of at least from_m2 and less than to_m2.
BuildingPool OfSize(const BuildingPool& pool, double from_m2, double to_m2);

// A figure and the interval that holds it in 95 % of the samples that were drawn anew. NaN: not known; without at least two buildings there is no
// interval.
struct PooledFigure {
  double value = std::numeric_limits<double>::quiet_NaN();
  double low = std::numeric_limits<double>::quiet_NaN();
  double high = std::numeric_limits<double>::quiet_NaN();
};
using PoolStatistic = std::function<double(const BuildingPool&)>;
inline constexpr int kResamples = 1000;
// Percentile bootstrap (Efron 1979): draws as many buildings as there are, with replacement, and takes the 2.5th and 97.5th percentile of the figures
// of all draws. The same numbers for the same pool. Errors that all buildings of a town share, as of its geo-reference, are not in the interval.
PooledFigure Bootstrap(const BuildingPool& pool, const PoolStatistic& statistic, int resamples = kResamples);

struct PooledCounts {
  int64_t matched = 0, missed = 0, invented = 0;
  int64_t Outlines() const { return matched + missed; }
};
PooledCounts Count(const BuildingPool& pool);
// Matched over matched and missed; over matched and invented; over all. NaN without any.
double Completeness(const BuildingPool& pool);
double Correctness(const BuildingPool& pool);
double Quality(const BuildingPool& pool);
// Of the matched buildings those whose kind of roof was found.
double RoofKindRight(const BuildingPool& pool);

// The names of measures, in the order of tables; lengths first.
std::span<const char* const> PooledMeasures();
// "m", "m2" or degrees; lengths have an RMSE in ground sampling distances too.
std::string UnitOfMeasure(const std::string& measure);
bool IsLength(const std::string& measure);
// Errors of a measure; see evaluate::buildings::SummariseErrors. in_gsd: divided by the ground sampling distance of the building's town.
evaluate::buildings::BuildingErrors PooledErrors(const BuildingPool& pool, const std::string& measure, bool in_gsd = false);
// Share of all errors of all measures that are within 1.96 sigma.
double WithinSigma(const BuildingPool& pool);
// Matched buildings that have the measure.
BuildingPool WithMeasure(const BuildingPool& pool, const std::string& measure);

}  // namespace skyquilt::bench
