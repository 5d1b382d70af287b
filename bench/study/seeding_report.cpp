#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "bench/study/growth_bench.h"
#include "bench/study/seeding_bench.h"
#include "core/base/json_text.h"
#include "core/base/system.h"
#include "core/page/curve_chart.h"

namespace skyquilt::bench {
namespace {

using SeedingPoints = std::vector<std::pair<double, double>>;

// By threads.
template <typename Value>
std::map<int, SeedingPoints> SeedingCurves(const SeedingResult& result, const Value& value) {
  std::map<int, SeedingPoints> curves;
  for (const SeedingRow& row : result.rows) curves[row.threads].emplace_back(row.photos, value(row));
  return curves;
}

double SeedingSeconds(const SeedingRow& row) {
  return row.seconds;
}
double SeedingPeak(const SeedingRow& row) {
  return row.peak_bytes;
}

std::string ThreadsText(int threads) {
  return fmt::format("{} thread{}", threads, threads == 1 ? "" : "s");
}

template <typename Value>
std::string SeedingChart(const SeedingResult& result, const Value& value, const char* title, const char* y_label) {
  std::vector<page::Curve> curves;
  for (auto& [threads, points] : SeedingCurves(result, value)) curves.push_back({.name = ThreadsText(threads), .points = points, .marks = true});
  return page::CurveChart(curves, {.title = title, .x_label = "photos", .y_label = y_label, .log_y = true, .log_x = true});
}

BenchTable SeedingTable(const SeedingResult& result) {
  BenchTable table{
      .name = "",
      .title = "",
      .note =
          "Time and peak memory: from tags and matches to the model; before: memory of the process with its input. Right: off by less than 2 % of "
          "the height above ground and by less than 2 degrees, after the model was moved, turned and scaled to the true positions. Position "
          "and rotation: medians. Error: median reprojection error at 1600 pixels width.",
      .columns = {"photos", "threads", "time", "ms per photo", "before", "peak", "with a pose", "right", "position", "rotation", "focal length",
                  "error"},
      .rows = {}};
  for (const SeedingRow& row : result.rows) {
    table.rows.push_back({BenchCell::Number(row.photos, 0), BenchCell::Number(row.threads, 0), BenchCell::Seconds(row.seconds),
                          BenchCell::Number(1e3 * row.seconds / std::max(1, row.photos), 1), BenchCell::Bytes(row.input_bytes),
                          BenchCell::Bytes(row.peak_bytes), BenchCell::Number(static_cast<double>(row.score.registered), 0),
                          BenchCell::Number(static_cast<double>(row.score.right), 0), BenchCell::Number(row.score.position_m, 3, "m"),
                          BenchCell::Number(row.score.rotation_deg, 3, "deg"), BenchCell::Percent(row.score.focal_error, 2),
                          BenchCell::Number(row.median_error, 2, "px")});
  }
  return table;
}

BenchTable TracksTable(const SeedingResult& result) {
  BenchTable table{
      .name = "tracks", .title = "Input", .note = "", .columns = {"photos", "pairs", "features per photo", "matches", "wrong", "points"}, .rows = {}};
  int last = 0;
  for (const SeedingRow& row : result.rows) {
    if (row.photos == last) continue;
    last = row.photos;
    table.rows.push_back({BenchCell::Number(row.photos, 0), BenchCell::Number(static_cast<double>(row.pairs), 0),
                          BenchCell::Number(row.features_per_photo, 0), BenchCell::Count(static_cast<double>(row.matches)),
                          BenchCell::Percent(static_cast<double>(row.wrong) / static_cast<double>(std::max<size_t>(1, row.matches))),
                          BenchCell::Count(static_cast<double>(row.points))});
  }
  return table;
}

std::string RightVerdict(const SeedingResult& result) {
  std::string wrong;
  for (const SeedingRow& row : result.rows) {
    if (row.score.right == row.score.n_photos && row.failure.empty()) continue;
    wrong += fmt::format("{}{} of {} with {}{}", wrong.empty() ? "" : ", ", row.score.right, row.photos, ThreadsText(row.threads),
                         row.failure.empty() ? "" : " (" + row.failure + ")");
  }
  return wrong.empty() ? "Met: every photo has the right pose." : "Missed: every photo has the right pose, but only " + wrong + ".";
}

std::string GrowthVerdict(const SeedingResult& result) {
  const double most = std::log(kMostGrowth) / std::log(kGrowthPhotos);
  std::string powers;
  bool met = true;
  for (const auto& [threads, points] : SeedingCurves(result, SeedingSeconds)) {
    if (points.size() < 2) continue;  // the bench has not come so far
    const double power = FitGrowth(points).exponent;
    met = met && power <= most;
    powers += fmt::format("{}{:.2f} with {}", powers.empty() ? "" : ", ", power, ThreadsText(threads));
  }
  return fmt::format("{}: time grows by a power of the photos of at most {:.2f}: {}.", met ? "Met" : "Missed", most, powers);
}

}  // namespace

BenchPage SeedingPage(const SeedingResult& result, const std::string& command) {
  BenchPage page;
  page.name = "seeding";
  page.title = "Poses by tags and matches, by number of photos";
  page.lead = fmt::format(
      "Flights over '{}' of growing area. Features are the projections of true points with {:.1f} pixels of noise per axis, {:.1f} % of the "
      "matches are wrong, and the focal length to begin with is off by {:.1f} %. No picture is rendered and no feature is sought.",
      result.place, result.errors.noise_px, 100.0 * result.errors.wrong_share, 100.0 * result.errors.focal_share);
  page.SetOrigin(command);
  if (result.rows.empty()) return page;
  page.verdicts.push_back(RightVerdict(result));
  if (result.rows.front().photos != result.rows.back().photos) page.verdicts.push_back(GrowthVerdict(result));
  page.sections.push_back(
      {.id = "growth",
       .title = "Time and memory",
       .lead = "",
       .charts = {SeedingChart(result, SeedingSeconds, "Time", "seconds"), SeedingChart(result, SeedingPeak, "Peak memory", "bytes")},
       .tables = {SeedingTable(result), TracksTable(result)},
       .pictures = {}});
  return page;
}

std::string SeedingJson(const SeedingResult& result, const std::string& command) {
  using nlohmann::json;
  json rows = json::array();
  for (const SeedingRow& row : result.rows) {
    rows.push_back({{"photos", row.photos},
                    {"threads", row.threads},
                    {"pairs", row.pairs},
                    {"matches", row.matches},
                    {"wrong_matches", row.wrong},
                    {"features_per_photo", row.features_per_photo},
                    {"points", row.points},
                    {"seconds", row.seconds},
                    {"input_bytes", row.input_bytes},
                    {"peak_bytes", row.peak_bytes},
                    {"median_error_px", row.median_error},
                    {"registered", row.score.registered},
                    {"right", row.score.right},
                    {"position_m", row.score.position_m},
                    {"rotation_deg", row.score.rotation_deg},
                    {"focal_error", row.score.focal_error},
                    {"failure", row.failure.empty() ? row.score.problem : row.failure}});
  }
  const json all = {{"command", command},
                    {"machine", base::MachineDescription()},
                    {"date", base::UtcTimestamp()},
                    {"place", result.place},
                    {"noise_px", result.errors.noise_px},
                    {"seen_share", result.errors.seen_share},
                    {"wrong_share", result.errors.wrong_share},
                    {"focal_share", result.errors.focal_share},
                    {"rows", std::move(rows)}};
  return base::JsonText(all, 2) + "\n";
}

}  // namespace skyquilt::bench
