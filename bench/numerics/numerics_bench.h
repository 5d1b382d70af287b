// `bench numerics`: every promise about numbers at the extremes as a row of a table.
#pragma once

#include <string>
#include <vector>

#include "bench/bench_page.h"
#include "bench/numerics/groups.h"

namespace skyquilt::bench {

struct GroupResult {
  std::string id, title, lead;
  std::vector<NumericRow> rows;
  std::vector<std::string> charts;
};

struct NumericsResult {
  bool quick = false;
  double seconds = 0.0;
  std::vector<GroupResult> groups;

  int Count(Verdict verdict) const;
  // Largest error of the rows that were judged, of one group and unit; NaN when there is none.
  double WorstOf(const std::string& group, const std::string& unit) const;
  std::vector<NumericRow> Failed() const;
};

// Those of design: space, rays, compositing, kernels, trainer, distance, brightness, not-a-number, storage, Earth.
std::vector<NumericGroup> AllGroups(const NumericsOptions& options);
// Those of the given ids, in their own order. Throws base::UsageError for an id that is not among them.
std::vector<NumericGroup> OnlyGroups(std::vector<NumericGroup> groups, const std::vector<std::string>& ids);
// Runs the groups one after the other. A case that fails or throws is a row; base::Interrupted passes through.
NumericsResult RunNumerics(const std::vector<NumericGroup>& groups, bool quick);

BenchPage NumericsPage(const NumericsResult& result, const std::string& command);
std::string NumericsJson(const NumericsResult& result, const std::string& command);
// base::FailedCheck naming the failed cases, when there are any.
void ThrowIfFailed(const NumericsResult& result);

}  // namespace skyquilt::bench
