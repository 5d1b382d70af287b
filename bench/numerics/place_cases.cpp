// The geo-reference under faults of the tags: what it finds, and whether the accuracy that it states is true.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "bench/numerics/fault_survey.h"
#include "bench/numerics/groups.h"

namespace skyquilt::bench {
namespace {

constexpr double kMountingTilt_deg = prepare::georeference::kCameraCommon_deg;  // as the geo-reference assumes

// A town in which the tags have a noise of 2 m and gimbal angles with the errors of a good drone.
simulate::SimulateOptions Town() {
  simulate::SimulateOptions options;
  options.place = "town";
  options.gps_noise_m = 2.0;
  options.exact_frame = false;
  options.gimbal_common_error_deg = 0.2;
  options.gimbal_random_error_deg = 0.5;
  return options;
}

bool Covered(double error, double sigma) {
  constexpr double kNinetyFivePercent = 1.96;
  return error <= kNinetyFivePercent * sigma;
}

// One fault at a time. With gimbal angles: fixed limits of the errors. Without, and where few tags in one direction decide: the stated accuracy has
// to cover the errors.
struct Fault {
  const char* name;
  void (*set)(simulate::SimulateOptions&);
  bool few_tags = false;
};

constexpr Fault kFaults[] = {
    {"no fault", [](simulate::SimulateOptions&) {}},
    {"a lag of 2 s", [](simulate::SimulateOptions& options) { options.tag_lag_s = 2.0; }},
    {"heights that drift by 100 m", [](simulate::SimulateOptions& options) { options.tag_drift_m = 100.0; }},
    {"a third of the tags off by 50 m", [](simulate::SimulateOptions& options) { options.tag_outliers = 1.0 / 3.0; }},
    {"a jump of 30 m", [](simulate::SimulateOptions& options) { options.tag_jump_m = 30.0; }},
    {"heights in another datum", [](simulate::SimulateOptions& options) { options.tag_height_offset_m = 47.0; }},
    {"all heights 0", [](simulate::SimulateOptions& options) { options.tag_heights = "zero"; }},
    {"a hillside of 8\xC2\xB0", [](simulate::SimulateOptions& options) { options.hillside_deg = 8.0; }},
    {"one straight line", [](simulate::SimulateOptions& options) { options.single_line = true; }, true},
};

std::string Seen(const PlaceErrors& errors) {
  if (!errors.georeferenced) return "local frame: " + (errors.problems.empty() ? "" : errors.problems.front());
  std::string codes;
  for (const std::string& code : errors.problems) codes += (codes.empty() ? "; " : ", ") + code;
  return fmt::format(
      "tilt {:.2f}\xC2\xB0 \xC2\xB1 {:.2f}, scale {:.2f} % \xC2\xB1 {:.2f}, yaw {:.2f}\xC2\xB0 \xC2\xB1 {:.2f}, position {:.1f} m \xC2\xB1 {:.1f}, "
      "lag {:.2f} s{}",
      errors.tilt_deg, errors.sigma.tilt_deg, errors.scale_percent, errors.sigma.scale_percent, errors.yaw_deg, errors.sigma.yaw_deg,
      errors.horizontal_m, errors.sigma.horizontal_m, errors.lag_s, codes);
}

// Over these seeds the worst counts.
constexpr int kFaultSeeds = 5;

NumericCase FaultCase(const Fault& fault, bool gimbal) {
  constexpr double kTilt_deg = 0.5, kScale_percent = 1.0, kYaw_deg = 0.5;
  constexpr double kCoverage = 3.0;
  NumericCase result{.name = fmt::format("{}, {}", fault.name, gimbal ? "with gimbal angles" : "without gimbal angles")};
  const bool limits = gimbal && !fault.few_tags;
  result.expected =
      limits ? fmt::format("tilt at most {:g}\xC2\xB0, scale {:g} %, yaw {:g}\xC2\xB0 ({} seeds)", kTilt_deg, kScale_percent, kYaw_deg, kFaultSeeds)
             : fmt::format("tilt, scale and yaw within {:g} of the stated standard deviations ({} seeds)", kCoverage, kFaultSeeds);
  result.unit = limits ? "of the limit" : "standard deviations";
  result.limit = limits ? 1.0 : kCoverage;
  result.run = [fault, gimbal, limits] {
    CaseResult worst{.worst = 0.0};
    for (int seed = 1; seed <= kFaultSeeds; ++seed) {
      simulate::SimulateOptions options = Town();
      options.seed = seed;
      options.gimbal_tags = gimbal;
      fault.set(options);
      const PlaceErrors errors = FindPlace(MakeFaultSurvey(options, gimbal ? 0.0 : kMountingTilt_deg));
      const geo::PlaceAccuracy& sigma = errors.sigma;
      const double ratio =
          limits ? std::max({errors.tilt_deg / kTilt_deg, errors.scale_percent / kScale_percent, errors.yaw_deg / kYaw_deg})
                 : std::max({errors.tilt_deg / sigma.tilt_deg, errors.scale_percent / sigma.scale_percent, errors.yaw_deg / sigma.yaw_deg});
      worst.holds = worst.holds && errors.georeferenced && std::isfinite(errors.vertical_m);
      if (!worst.seen.empty() && !(ratio > worst.worst)) continue;
      worst.worst = ratio;
      worst.seen = "worst: " + Seen(errors);
    }
    return worst;
  };
  return result;
}

// Random faults: the share of errors within 1.96 standard deviations, and how large errors are against what was stated.
using Outcomes = std::vector<PlaceErrors>;

NumericCase CoverageCase(const char* name, double PlaceErrors::*error, double geo::PlaceAccuracy::*sigma, int n_cases,
                         const std::shared_ptr<Outcomes>& outcomes) {
  return {.name = fmt::format("stated accuracy of {}", name),
          .expected = fmt::format(
              "{} random cases: 90 to 99 % of errors within 1.96 standard deviations, RMS error 0.6 to 1.4 of the RMS standard deviation", n_cases),
          .unit = "%",
          .run = [=] {
            for (int seed = static_cast<int>(outcomes->size()) + 1; seed <= n_cases; ++seed) {
              outcomes->push_back(FindPlace(MakeFaultSurvey(RandomFaults(static_cast<uint64_t>(seed)), kMountingTilt_deg)));
            }
            double n = 0.0, covered = 0.0, errors = 0.0, stated = 0.0;
            for (const PlaceErrors& outcome : *outcomes) {
              if (!outcome.georeferenced || !std::isfinite(outcome.sigma.*sigma)) continue;
              n += 1.0;
              covered += Covered(outcome.*error, outcome.sigma.*sigma) ? 1.0 : 0.0;
              errors += std::pow(outcome.*error, 2);
              stated += std::pow(outcome.sigma.*sigma, 2);
            }
            const double share = 100.0 * covered / n, ratio = std::sqrt(errors / stated);
            return CaseResult{.seen = fmt::format("{:.1f} % of {:.0f} cases, ratio {:.2f}, RMS error {:.3g}", share, n, ratio, std::sqrt(errors / n)),
                              .worst = 100.0 - share,
                              .holds = share >= 90.0 && share <= 99.0 && ratio >= 0.6 && ratio <= 1.4};
          }};
}

// Faults that forbid a place, or must be named.
NumericCase NamedCase(const char* name, const char* code, bool placed, void (*set)(simulate::SimulateOptions&)) {
  return {.name = name, .expected = fmt::format("{}, and the problem {}", placed ? "a place" : "a levelled local frame", code), .run = [=] {
            simulate::SimulateOptions options = Town();
            set(options);
            const PlaceErrors errors = FindPlace(MakeFaultSurvey(options, 0.0));
            const bool named = std::find(errors.problems.begin(), errors.problems.end(), code) != errors.problems.end();
            return CaseResult{.seen = Seen(errors), .holds = named && errors.georeferenced == placed};
          }};
}

NumericCase ElsewhereCase(const char* name, double latitude_deg, double longitude_deg, double height_m) {
  return {.name = fmt::format("lag, drift and outliers {}", name),
          .expected = "errors of tilt, scale and yaw as at home, within 0.02\xC2\xB0 and 0.02 %",
          .unit = "\xC2\xB0 or %",
          .limit = 0.02,
          .run = [=] {
            simulate::SimulateOptions options = Town();
            options.tag_lag_s = 1.3;
            options.tag_drift_m = -60.0;
            options.tag_outliers = 0.2;
            const PlaceErrors home = FindPlace(MakeFaultSurvey(options, 0.0));
            options.latitude_deg = latitude_deg;
            options.longitude_deg = longitude_deg;
            options.height_m = height_m;
            const PlaceErrors there = FindPlace(MakeFaultSurvey(options, 0.0));
            const double difference = std::max({std::abs(there.tilt_deg - home.tilt_deg), std::abs(there.scale_percent - home.scale_percent),
                                                std::abs(there.yaw_deg - home.yaw_deg)});
            return CaseResult{.seen = Seen(there), .worst = difference, .holds = home.georeferenced && there.georeferenced};
          }};
}

}  // namespace

NumericGroup PlaceGroup(const NumericsOptions& /*options*/) {
  NumericGroup group{
      .id = "place",
      .title = "Place on Earth from faulty tags",
      .lead =
          "Flights over the simulated town with one fault of their tags at a time, and random flights with several, in a random model "
          "frame. No pixels are needed: poses, tags and ground points only. Errors are those of the fitted similarity; the accuracy is "
          "what the geo-reference states, one standard deviation."};
  for (const bool gimbal : {true, false}) {
    for (const Fault& fault : kFaults) group.cases.push_back(FaultCase(fault, gimbal));
  }
  using Options = simulate::SimulateOptions;
  group.cases.push_back(NamedCase("latitude and longitude exchanged", "swapped_coordinates", false, [](Options& o) { o.tags_swapped = true; }));
  group.cases.push_back(NamedCase("all tags equal", "equal_tags", false, [](Options& o) { o.tags_equal = true; }));
  group.cases.push_back(NamedCase("all heights 0 are named", "no_heights", true, [](Options& o) { o.tag_heights = "zero"; }));
  group.cases.push_back(NamedCase("one straight line is named", "one_line", true, [](Options& o) { o.single_line = true; }));
  group.cases.push_back(NamedCase("a drift of 100 m is named", "gravity_conflict", true, [](Options& o) { o.tag_drift_m = 100.0; }));
  group.cases.push_back(NamedCase("a hillside without gimbal angles is named", "ground_leans", true, [](Options& o) {
    o.hillside_deg = 8.0;
    o.gimbal_tags = false;
  }));
  constexpr int kCases = 200;
  const auto outcomes = std::make_shared<Outcomes>();
  group.cases.push_back(CoverageCase("tilt", &PlaceErrors::tilt_deg, &geo::PlaceAccuracy::tilt_deg, kCases, outcomes));
  group.cases.push_back(CoverageCase("scale", &PlaceErrors::scale_percent, &geo::PlaceAccuracy::scale_percent, kCases, outcomes));
  group.cases.push_back(CoverageCase("yaw", &PlaceErrors::yaw_deg, &geo::PlaceAccuracy::yaw_deg, kCases, outcomes));
  group.cases.push_back(CoverageCase("horizontal position", &PlaceErrors::horizontal_m, &geo::PlaceAccuracy::horizontal_m, kCases, outcomes));
  group.cases.push_back(CoverageCase("height", &PlaceErrors::vertical_m, &geo::PlaceAccuracy::vertical_m, kCases, outcomes));
  group.cases.push_back(ElsewhereCase("at the north pole", 90.0, 0.0, 2.0));
  group.cases.push_back(ElsewhereCase("at the south pole", -90.0, 0.0, 2835.0));
  group.cases.push_back(
      ElsewhereCase("across \xC2\xB1"
                    "180\xC2\xB0",
                    -16.8, 180.0, 5.0));
  group.cases.push_back(ElsewhereCase("below sea level, -430 m", 31.5, 35.5, -430.0));
  return group;
}

}  // namespace skyquilt::bench
