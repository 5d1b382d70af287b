// `bench numerics`: runs all numerical checks and reports each as one row of a table.
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

// All groups: space, rays, compositing, field kernels, trainer, distance from the origin, brightness, NaN and infinity, storage, places on Earth.
std::vector<NumericGroup> AllGroups(const NumericsOptions& options);
// The groups with these ids, in the order of `groups`. Throws base::UsageError for an unknown id.
std::vector<NumericGroup> OnlyGroups(std::vector<NumericGroup> groups, const std::vector<std::string>& ids);
// Runs the groups one after the other. A case that fails or throws becomes a failed row; only base::Interrupted is not caught.
NumericsResult RunNumerics(const std::vector<NumericGroup>& groups, bool quick);

BenchPage NumericsPage(const NumericsResult& result, const std::string& command);
std::string NumericsJson(const NumericsResult& result, const std::string& command);
// Throws base::FailedCheck with the names of the failed cases, if there are any.
void ThrowIfFailed(const NumericsResult& result);

}  // namespace skyquilt::bench
