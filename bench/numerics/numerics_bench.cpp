#include "bench/numerics/numerics_bench.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "core/base/errors.h"
#include "core/base/progress.h"

namespace skyquilt::bench {

int NumericsResult::Count(Verdict verdict) const {
  int count = 0;
  for (const GroupResult& group : groups) {
    for (const NumericRow& row : group.rows) count += row.verdict == verdict ? 1 : 0;
  }
  return count;
}

double NumericsResult::WorstOf(const std::string& group_id, const std::string& unit) const {
  Worst worst;
  bool any = false;
  for (const GroupResult& group : groups) {
    if (group.id != group_id) continue;
    for (const NumericRow& row : group.rows) {
      if (row.verdict == Verdict::kShown || row.unit != unit) continue;
      worst.Take(row.worst);
      any = true;
    }
  }
  return any ? worst.value() : kNoNumber;
}

std::vector<NumericRow> NumericsResult::Failed() const {
  std::vector<NumericRow> failed;
  for (const GroupResult& group : groups) {
    for (const NumericRow& row : group.rows) {
      if (row.verdict == Verdict::kFailed) failed.push_back(row);
    }
  }
  return failed;
}

std::vector<NumericGroup> AllGroups(const NumericsOptions& options) {
  std::vector<NumericGroup> groups = {SpaceGroup(options),      RayGroup(options),       CompositeGroup(options), FieldGroup(options),
                                      TrainerGroup(options),    ConesGroup(options),     PriorsGroup(options),    AwayGroup(options),
                                      BrightnessGroup(options), NonFiniteGroup(options), StorageGroup(options),   PlaceGroup(options),
                                      TilesGroup(options),      EarthGroup(options)};
  std::erase_if(groups, [](const NumericGroup& group) { return group.cases.empty(); });
  return groups;
}

std::vector<NumericGroup> OnlyGroups(std::vector<NumericGroup> groups, const std::vector<std::string>& ids) {
  std::string known;
  for (const NumericGroup& group : groups) known += (known.empty() ? "" : ", ") + group.id;
  for (const std::string& id : ids) {
    const bool found = std::any_of(groups.begin(), groups.end(), [&id](const NumericGroup& group) { return group.id == id; });
    if (!found) throw base::UsageError(fmt::format("--only: there is no group of cases '{}'. Choose from {}", id, known));
  }
  std::erase_if(groups, [&ids](const NumericGroup& group) { return std::find(ids.begin(), ids.end(), group.id) == ids.end(); });
  return groups;
}

NumericsResult RunNumerics(const std::vector<NumericGroup>& groups, bool quick) {
  NumericsResult result;
  result.quick = quick;
  const auto start = std::chrono::steady_clock::now();
  size_t cases = 0;
  for (const NumericGroup& group : groups) cases += group.cases.size();
  base::Progress progress("numerics", static_cast<double>(cases), "cases");
  for (const NumericGroup& group : groups) {
    GroupResult& done = result.groups.emplace_back(GroupResult{.id = group.id, .title = group.title, .lead = group.lead, .rows = {}, .charts = {}});
    for (const NumericCase& one : group.cases) {
      done.rows.push_back(RunCase(group.title, one));
      progress.Advance(1.0, group.title + ": " + one.name);
    }
    if (group.charts) done.charts = group.charts();
  }
  progress.Finish();
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

void ThrowIfFailed(const NumericsResult& result) {
  const std::vector<NumericRow> failed = result.Failed();
  if (failed.empty()) return;
  std::string text =
      fmt::format("{} of {} numeric cases failed:", failed.size(), failed.size() + static_cast<size_t>(result.Count(Verdict::kPassed)));
  for (const NumericRow& row : failed) {
    text += fmt::format("\n  {}: {}: expected {}; seen {}", row.group, row.name, row.expected, row.seen);
    if (!std::isnan(row.worst)) text += ", worst " + FormatError(row.worst, row.unit);
  }
  throw base::FailedCheck(text);
}

}  // namespace skyquilt::bench
