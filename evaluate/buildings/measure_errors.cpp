#include "evaluate/buildings/measure_errors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/base/order_statistics.h"

namespace skyquilt::evaluate::buildings {
namespace {

constexpr double kTwoSided95 = 1.96;   // standard deviations that hold 95 % of normal errors
constexpr double kNearlySquare = 0.9;  // width over length above which either side may come out longer
constexpr double kFarthestCorner_m = 3.0;
constexpr double kStraightSine = 0.087;  // turns of less than 5 degrees are no corners

MeasureError ErrorOf(const Measure& found, double truth) {
  return {found.value - truth, found.sigma};
}

bool IsFlat(const TrueBuilding& building) {
  return building.roof == RoofKind::kFlat;
}

// Of two parts of nearly the same size either may be the larger one.
MeasureError EaveError(const Measure& found, const TrueBuilding& truth) {
  double nearest = truth.eave_z_m;
  for (const double eave : truth.other_eaves_z_m) {
    if (std::abs(found.value - eave) < std::abs(found.value - nearest)) nearest = eave;
  }
  return ErrorOf(found, nearest);
}

struct ScoredMeasure {
  const char* name;
  std::optional<MeasureError> (*error)(const Building& found, const TrueBuilding& truth);  // nothing: the building has no such measure
};

constexpr std::array<ScoredMeasure, 9> kMeasures = {{
    {"ground", [](const Building& f, const TrueBuilding& t) -> std::optional<MeasureError> { return ErrorOf(f.measures.ground_m, t.ground_z_m); }},
    {"eave", [](const Building& f, const TrueBuilding& t) { return IsFlat(t) ? std::nullopt : std::optional(EaveError(f.measures.eave_m, t)); }},
    {"ridge",
     [](const Building& f, const TrueBuilding& t) { return IsFlat(t) ? std::nullopt : std::optional(ErrorOf(f.measures.ridge_m, t.ridge_z_m)); }},
    {"deck",
     [](const Building& f, const TrueBuilding& t) { return IsFlat(t) ? std::optional(ErrorOf(f.measures.ridge_m, t.ridge_z_m)) : std::nullopt; }},
    {"height",
     [](const Building& f, const TrueBuilding& t) -> std::optional<MeasureError> {
       return ErrorOf(f.measures.height_m, t.ridge_z_m - t.ground_z_m);
     }},
    {"length", [](const Building& f, const TrueBuilding& t) -> std::optional<MeasureError> { return ErrorOf(f.measures.length_m, t.length_m); }},
    {"width", [](const Building& f, const TrueBuilding& t) -> std::optional<MeasureError> { return ErrorOf(f.measures.width_m, t.width_m); }},
    {"yaw",
     [](const Building& f, const TrueBuilding& t) -> std::optional<MeasureError> {
       const bool nearly_square = t.width_m > kNearlySquare * t.length_m;
       return MeasureError{YawError(f.measures.yaw_deg.value, t.yaw_deg, nearly_square), f.measures.yaw_deg.sigma};
     }},
    {"footprint",
     [](const Building& f, const TrueBuilding& t) -> std::optional<MeasureError> { return ErrorOf(f.measures.footprint_m2, t.area_m2); }},
}};

void AddCorners(const std::vector<Eigen::Vector2d>& ring, std::vector<Eigen::Vector2d>* corners) {
  for (size_t i = 0; i < ring.size(); ++i) {
    const Eigen::Vector2d &before = ring[(i + ring.size() - 1) % ring.size()], &here = ring[i], &after = ring[(i + 1) % ring.size()];
    const Eigen::Vector2d in = (here - before).normalized(), out = (after - here).normalized();
    if (std::abs(in.x() * out.y() - in.y() * out.x()) > kStraightSine) corners->push_back(here);
  }
}

std::vector<Eigen::Vector2d> CornersOf(const Polygon& polygon) {
  std::vector<Eigen::Vector2d> corners;
  AddCorners(polygon.outer, &corners);
  for (const std::vector<Eigen::Vector2d>& hole : polygon.holes) AddCorners(hole, &corners);
  return corners;
}

// roof: nothing takes all kinds.
BuildingRoofScores ScoresOfKind(std::optional<RoofKind> roof, const BuildingSet& found, const TrueBuildings& truth, const BuildingMatches& matches) {
  BuildingRoofScores scores;
  scores.roof = roof ? NameOf(*roof) : "all";
  std::array<std::vector<MeasureError>, kMeasures.size()> errors;
  int64_t right = 0;
  for (const BuildingPair& pair : matches.pairs) {
    const Building& building = found.buildings[pair.found];
    const TrueBuilding& outline = truth.outlines[pair.truth];
    if (roof && outline.roof != *roof) continue;
    ++scores.matched;
    right += building.roof == outline.roof ? 1 : 0;
    for (size_t m = 0; m < kMeasures.size(); ++m) {
      if (const std::optional<MeasureError> error = kMeasures[m].error(building, outline)) errors[m].push_back(*error);
    }
  }
  if (scores.matched > 0) scores.roof_right = static_cast<double>(right) / static_cast<double>(scores.matched);
  for (size_t m = 0; m < kMeasures.size(); ++m) {
    BuildingErrors summary = SummariseErrors(kMeasures[m].name, errors[m]);
    if (summary.n > 0) scores.errors.push_back(std::move(summary));
  }
  return scores;
}

}  // namespace

double YawError(double found_deg, double true_deg, bool nearly_square) {
  return std::remainder(found_deg - true_deg, nearly_square ? 90.0 : 180.0);
}

BuildingErrors SummariseErrors(const char* measure, std::span<const MeasureError> errors) {
  BuildingErrors summary;
  summary.measure = measure;
  std::vector<double> values, sizes;
  double sum = 0.0, squares = 0.0;
  int64_t within = 0;
  for (const MeasureError& one : errors) {
    if (!std::isfinite(one.error)) continue;
    values.push_back(one.error);
    sizes.push_back(std::abs(one.error));
    sum += one.error;
    squares += one.error * one.error;
    if (!std::isfinite(one.sigma)) continue;
    ++summary.with_sigma;
    within += std::abs(one.error) <= kTwoSided95 * one.sigma ? 1 : 0;
  }
  if (values.empty()) return summary;
  const auto n = static_cast<double>(values.size());
  summary.n = static_cast<int64_t>(values.size());
  summary.bias = sum / n;
  summary.rmse = std::sqrt(squares / n);
  summary.nmad = base::Nmad(std::move(values));
  summary.median_abs = base::Median(sizes);
  summary.p90_abs = base::Quantile(std::move(sizes), 0.9);
  if (summary.with_sigma > 0) summary.within_sigma = static_cast<double>(within) / static_cast<double>(summary.with_sigma);
  return summary;
}

std::vector<BuildingRoofScores> ScoreMeasures(const BuildingSet& found, const TrueBuildings& truth, const BuildingMatches& matches) {
  std::vector<BuildingRoofScores> scores = {ScoresOfKind(std::nullopt, found, truth, matches)};
  for (const RoofKind roof : {RoofKind::kFlat, RoofKind::kGable, RoofKind::kHip, RoofKind::kOther}) {
    BuildingRoofScores one = ScoresOfKind(roof, found, truth, matches);
    if (one.matched > 0) scores.push_back(std::move(one));
  }
  return scores;
}

std::vector<BuildingOutcome> ListOutcomes(const BuildingSet& found, const TrueBuildings& truth, const BuildingMatches& matches) {
  std::vector<const BuildingPair*> pair_of_truth(truth.outlines.size());
  for (const BuildingPair& pair : matches.pairs) pair_of_truth[pair.truth] = &pair;
  std::vector<BuildingOutcome> outcomes;
  for (size_t t = 0; t < truth.outlines.size(); ++t) {
    if (matches.truth[t] == TrueFate::kNotCounted) continue;
    const TrueBuilding& outline = truth.outlines[t];
    BuildingOutcome& outcome = outcomes.emplace_back();
    outcome.truth_id = outline.id;
    outcome.roof = NameOf(outline.roof);
    outcome.area_m2 = outline.area_m2;
    if (pair_of_truth[t] == nullptr) continue;
    const Building& building = found.buildings[pair_of_truth[t]->found];
    outcome.fate = BuildingOutcome::Fate::kMatched;
    outcome.found_id = building.id;
    outcome.roof_found = NameOf(building.roof);
    outcome.overlap = pair_of_truth[t]->overlap;
    for (const ScoredMeasure& measure : kMeasures) {
      const std::optional<MeasureError> error = measure.error(building, outline);
      if (error && std::isfinite(error->error)) outcome.errors.push_back({measure.name, error->error, error->sigma});
    }
  }
  for (size_t f = 0; f < found.buildings.size(); ++f) {
    if (matches.found[f] != FoundFate::kInvented) continue;
    const Building& building = found.buildings[f];
    BuildingOutcome& outcome = outcomes.emplace_back();
    outcome.fate = BuildingOutcome::Fate::kInvented;
    outcome.found_id = building.id;
    outcome.roof_found = NameOf(building.roof);
    outcome.area_m2 = Area(building.footprint);
  }
  return outcomes;
}

void ScoreCorners(const BuildingSet& found, const TrueBuildings& truth, const BuildingMatches& matches, BuildingTruthScores* scores) {
  int64_t n_found = 0;
  double squares = 0.0;
  for (const BuildingPair& pair : matches.pairs) {
    const std::vector<Eigen::Vector2d> candidates = CornersOf(found.buildings[pair.found].footprint);
    for (const Eigen::Vector2d& corner : CornersOf(truth.outlines[pair.truth].walls)) {
      ++scores->corners;
      double nearest_m = std::numeric_limits<double>::infinity();
      for (const Eigen::Vector2d& candidate : candidates) nearest_m = std::min(nearest_m, (candidate - corner).norm());
      if (nearest_m > kFarthestCorner_m) continue;
      ++n_found;
      squares += nearest_m * nearest_m;
    }
  }
  if (scores->corners > 0) scores->corners_found = static_cast<double>(n_found) / static_cast<double>(scores->corners);
  if (n_found > 0) scores->corner_rmse_m = std::sqrt(squares / static_cast<double>(n_found));
}

}  // namespace skyquilt::evaluate::buildings
