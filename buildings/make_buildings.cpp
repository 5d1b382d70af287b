#include "buildings/make_buildings.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "buildings/candidates/candidate_checks.h"
#include "buildings/fit/fit_parameters.h"
#include "buildings/fit/fit_shape.h"
#include "buildings/outline_block.h"
#include "buildings/shape/find_shape.h"
#include "buildings/solids/build_solids.h"
#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/base/order_statistics.h"
#include "core/base/progress.h"
#include "core/base/text.h"

namespace skyquilt::buildings {
namespace {

constexpr double kAccepted = 0.85;     // share of roof points within 2 GSD of an accepted shape (structure.md, section 6)
constexpr double kDescribed = 0.5;     // below it the shape is a block
constexpr double kShapeless = 0.35;    // below it a block along an outline is no roof
constexpr double kFewestPlanes = 0.4;  // share of an outline that planes must cover, or it is no building
constexpr double kShortestWall_m = 1.5;
constexpr double kLowestMean_m = 0.5;         // of a roof above the ground; what is lower is the ground itself
constexpr std::ptrdiff_t kNamedOutlines = 5;  // in a warning
constexpr double kCutShare = 0.05;            // of an outline that is the edge of the survey

struct Fitted {
  FittedShape fit;
  bool manhattan = true;
  bool follows_outline = false;  // a rectangle would be too large
};

bool IsPitched(const Shape& shape) {
  return std::any_of(shape.parts.begin(), shape.parts.end(), [](const Part& part) { return buildings::IsPitched(part); });
}

// A pitched roof whose ridge the fit has moved below its eaves, or its eaves into the ground: no gable and no hip.
bool HasImpossibleRoof(const Shape& shape) {
  return std::any_of(shape.parts.begin(), shape.parts.end(),
                     [&](const Part& part) { return buildings::IsPitched(part) && (part.ridge_z < part.eave_z || part.eave_z < shape.ground_z); });
}

double PlanArea(const Shape& shape, const Part& part) {
  return (shape.MaxOf(part, false) - shape.MinOf(part, false)).prod();
}

const Part& LargestPart(const Shape& shape) {
  return *std::max_element(shape.parts.begin(), shape.parts.end(),
                           [&](const Part& a, const Part& b) { return PlanArea(shape, a) < PlanArea(shape, b); });
}

double HeightOf(const Shape& shape) {
  double top = shape.ground_z;
  for (const Part& part : shape.parts) top = std::max(top, part.ridge_z);
  return top - shape.ground_z;
}

// Ground at the candidate's place: of the points around it, else of the terrain.
double GroundUnder(const Candidate& candidate, const PointCloud& cloud, const GroundGrid& ground) {
  std::vector<double> heights;
  for (const uint32_t i : candidate.ground) heights.push_back(cloud.At(i).z());
  if (heights.size() >= 10) return base::Median(std::move(heights));
  const double terrain = ground.At(Centroid(candidate.outline));
  if (std::isfinite(terrain)) return terrain;
  for (const Eigen::Vector2d& corner : candidate.outline.outer) {
    const double z = ground.At(corner);
    if (std::isfinite(z)) heights.push_back(z);
  }
  return heights.empty() ? kUnknown : base::Median(std::move(heights));
}

// Median distance of roof edges from walls over the buildings that show both, with its scatter.
struct Overhang {
  double value_m, sigma_m;
  bool measured = false;
};
Overhang UsualOverhang(const std::vector<std::optional<Fitted>>& fits, double assumed_m) {
  std::vector<double> seen;
  for (const std::optional<Fitted>& one : fits) {
    if (one && IsPitched(one->fit.shape) && std::isfinite(one->fit.overhang_m)) seen.push_back(one->fit.overhang_m);
  }
  if (seen.size() < 3) return {assumed_m, 0.3};
  const double middle = base::Median(seen);
  for (double& value : seen) value = std::abs(value - middle);
  return {middle, std::max(0.1, 1.4826 * base::Median(std::move(seen))), true};
}

class BuildingsMaker {
 public:
  BuildingsMaker(const BuildingsInput& input, base::ThreadPool& threads) : input_(input), threads_(threads) {
    fit_options_.gsd_m = input.gsd_m;
    fit_options_.accuracy = input.accuracy;
  }

  BuildingSet Make() {
    const bool given = !input_.footprints.empty();
    candidates_ = given ? CandidatesIn(input_.footprints, *input_.cloud, *input_.ground, input_.options, input_.gsd_m, threads_)
                        : FindCandidates(*input_.cloud, *input_.ground, input_.options, input_.gsd_m, threads_);
    matched_ = CountMatched(candidates_, input_.matched, *input_.cloud, *input_.ground, threads_);
    FindDirections();
    FitAll();
    BuildingSet set;
    set.gsd_m = input_.gsd_m;
    for (size_t i = 0; i < candidates_.size(); ++i) {
      base::ThrowIfCancelled();
      if (std::optional<Building> building = BuildingOf(i)) {
        set.buildings.push_back(*std::move(building));
      } else if (candidates_[i].given) {
        empty_outlines_.push_back(candidates_[i].given_id.empty() ? std::to_string(i + 1) : candidates_[i].given_id);
      }
    }
    WarnOfEmptyOutlines();
    std::stable_sort(set.buildings.begin(), set.buildings.end(), [](const Building& a, const Building& b) {
      const Eigen::Vector2d at = Centroid(a.footprint), other = Centroid(b.footprint);
      return at.x() != other.x() ? at.x() < other.x() : at.y() < other.y();
    });
    for (size_t i = 0; i < set.buildings.size(); ++i) set.buildings[i].id = static_cast<int>(i) + 1;
    return set;
  }

 private:
  void FindDirections() {
    std::vector<Direction> own(candidates_.size());
    threads_.ParallelFor(static_cast<int64_t>(own.size()),
                         [&](int64_t i, int) { own[static_cast<size_t>(i)] = FindDirection(candidates_[static_cast<size_t>(i)], *input_.cloud); });
    std::vector<Eigen::Vector2d> places;
    for (const Candidate& candidate : candidates_) places.push_back(Centroid(candidate.outline));
    directions_ = ShareDirections(own, places, kShareYaw_m);
  }

  // Twice: where no wall was seen, the second time knows how far the roofs of the survey reach over walls that were.
  void FitAll() {
    fits_.resize(candidates_.size());
    guesses_.resize(candidates_.size());
    fit_options_.default_overhang_m = input_.options.overhang_m;
    base::Progress progress("buildings", static_cast<double>(candidates_.size()), "buildings");
    threads_.ParallelFor(static_cast<int64_t>(candidates_.size()), [&](int64_t i, int) {
      base::ThrowIfCancelled();
      FitOne(static_cast<size_t>(i));
      progress.Advance(1.0);
    });
    progress.Finish();
    const Overhang usual = UsualOverhang(fits_, input_.options.overhang_m);
    fit_options_.default_overhang_m = usual.value_m;
    fit_options_.overhang_sigma_m = usual.sigma_m;
    overhang_measured_ = usual.measured;
    threads_.ParallelFor(static_cast<int64_t>(candidates_.size()), [&](int64_t i, int) {
      base::ThrowIfCancelled();
      const std::optional<Fitted>& first = fits_[static_cast<size_t>(i)];
      if (first && IsPitched(first->fit.shape) && !std::isfinite(first->fit.overhang_m)) FitOne(static_cast<size_t>(i));
    });
  }

  void FitOne(size_t i) {
    const Candidate& candidate = candidates_[i];
    std::optional<ShapeGuess>& guess = guesses_[i];
    if (!guess) {
      const double ground = GroundUnder(candidate, *input_.cloud, *input_.ground);
      if (!std::isfinite(ground)) return;
      guess = FindShape(candidate, directions_[i], *input_.cloud, ground, input_.gsd_m);
    }
    if (!guess) return;
    fits_[i] = Fitted{FitShape(guess->shape, candidate, *input_.cloud, fit_options_), guess->manhattan};
    const Shape& fitted = fits_[i]->fit.shape;
    fits_[i]->follows_outline = !guess->manhattan && LeavesCorners(candidate, fitted);
    if (fits_[i]->fit.share_within >= kDescribed && !fits_[i]->follows_outline && !HasImpossibleRoof(fitted)) return;
    for (Part& part : guess->shape.parts) {
      part.roof = RoofKind::kOther;
      part.joins = -1;
    }
    fits_[i]->fit = FitShape(guess->shape, candidate, *input_.cloud, fit_options_);
  }

  // Whether there is enough of a roof, high and wide enough; outlines that were given are believed.
  bool IsBuilding(size_t i, const Fitted& fitted) const {
    const Candidate& candidate = candidates_[i];
    if (candidate.given) return true;
    if (matched_[i].DenyRoof()) return false;
    // Neither shape nor level: crowns of trees, unless photos show that there is a roof.
    if (fitted.follows_outline && fitted.fit.share_within < kShapeless && matched_[i].high == 0) return false;
    double planes_m2 = 0.0;
    for (const RoofPlane& plane : candidate.planes) planes_m2 += plane.area_m2 * std::max(plane.normal.z(), 0.0);
    const Shape& shape = fitted.fit.shape;
    return planes_m2 >= kFewestPlanes * Area(candidate.outline) && HeightOf(shape) >= input_.options.min_height_m &&
           shape.u.back() - shape.u.front() >= kShortestWall_m && shape.v.back() - shape.v.front() >= kShortestWall_m;
  }

  std::optional<Building> BuildingOf(size_t i) {
    const Candidate& candidate = candidates_[i];
    if (!fits_[i]) return std::nullopt;
    const Fitted& fitted = *fits_[i];
    if (!IsBuilding(i, fitted)) return std::nullopt;
    Building building;
    building.shape = fitted.fit.shape;
    building.given = candidate.given;
    building.given_id = candidate.given_id;
    building.share_within = fitted.fit.share_within;
    building.residual_m = fitted.fit.residual_m;
    building.roof_points = fitted.fit.roof_points;
    building.wall_points = fitted.fit.wall_points;
    const bool cut = candidate.edge_share > kCutShare;
    building.accepted = fitted.fit.converged && building.share_within >= kAccepted && (fitted.manhattan || fitted.follows_outline) && !cut;
    const auto seen = [](const std::vector<bool>& lines) { return std::any_of(lines.begin(), lines.end(), [](bool one) { return one; }); };
    building.walls_from_points = seen(fitted.fit.u_seen) || seen(fitted.fit.v_seen);
    SetOverhang(fitted, &building);
    building.roof = LargestPart(building.shape).roof;
    building.measures = MeasureShape(fitted.fit, fit_options_);
    building.measures.wall_seen = ShareOfWallSeen(building.shape, candidate, *input_.cloud, input_.gsd_m);
    if (!Describe(candidate, fitted, &building)) return std::nullopt;
    if (fitted.follows_outline) FollowOutline(candidate, input_.gsd_m, input_.accuracy, &building);
    return building;
  }

  // One line, for a cadastre may have thousands that the survey does not reach.
  void WarnOfEmptyOutlines() const {
    if (empty_outlines_.empty()) return;
    std::vector<std::string> named(empty_outlines_.begin(),
                                   empty_outlines_.begin() + std::min<std::ptrdiff_t>(kNamedOutlines, std::ssize(empty_outlines_)));
    if (named.size() < empty_outlines_.size()) named.emplace_back("...");
    const bool all = empty_outlines_.size() == candidates_.size();
    base::LogWarning("{} of {} outlines have no roof in the surface and are left out: {}{}", empty_outlines_.size(), candidates_.size(),
                     base::Join(named), all ? ". Do they lie in the survey, in the coordinate system that their file names?" : "");
  }

  void SetOverhang(const Fitted& fitted, Building* building) const {
    if (!IsPitched(building->shape)) return;
    building->overhang_measured = std::isfinite(fitted.fit.overhang_m);
    building->overhang_m = building->overhang_measured ? fitted.fit.overhang_m : fit_options_.default_overhang_m;
  }

  // Solids and outlines, with a note on what could not be had. False when nothing is left of the building.
  bool Describe(const Candidate& candidate, const Fitted& fitted, Building* building) const {
    std::vector<Polygon> footprints = Footprints(building->shape);
    if (footprints.empty() || (!candidate.given && Area(footprints.front()) < input_.options.min_area_m2)) return false;
    building->footprint = footprints.front();
    building->roofprint = {candidate.outline};
    const std::vector<RoofFacet> facets = RoofFacets(building->shape);
    const double top_z = MeanRoof(facets, building->shape);
    if (!(top_z >= building->shape.ground_z + kLowestMean_m)) return false;
    building->lod12 = ExtrudeBlock(building->footprint, building->shape.ground_z, top_z);
    std::vector<std::string> notes;
    if (footprints.size() == 1) building->lod22 = ExtrudeFacets(building->shape, facets);
    building->lod22_valid = !building->lod22.Empty() && CheckSolid(building->lod22).empty();
    if (!building->lod22_valid) {
      building->lod22 = building->lod12;
      notes.push_back("no valid solid with its roof could be built, so LoD 2.2 is a block");
    }
    if (!fitted.manhattan) notes.push_back("the outline has no right angles; length and width are those of the smallest rectangle around it");
    if (candidate.edge_share > kCutShare) notes.push_back("the survey ends at its outline, so it may go on beyond what was measured");
    if (fitted.follows_outline) {
      notes.push_back("it is a block that follows the roof's outline, up to the median height of its roof");
    } else if (building->roof == RoofKind::kOther) {
      notes.push_back("neither a flat, gable nor hip roof describes it, so it is a block up to the median height of its roof");
    } else if (building->share_within < kAccepted) {
      notes.push_back("only " + std::to_string(static_cast<int>(std::lround(100.0 * building->share_within))) +
                      " % of the roof's points lie within two ground sampling distances of the model");
    }
    if (!building->walls_from_points && !IsPitched(building->shape)) {
      notes.push_back("no walls were seen; they stand where the roof ends");
    } else if (!building->walls_from_points) {
      notes.push_back(overhang_measured_ ? "no walls were seen; they stand as far inside the roof's edge as at other buildings"
                                         : "no walls were seen; length and width include the roof's overhang but for buildings.overhang_m");
    }
    building->note = base::Join(notes, "; ");
    return true;
  }

  static double MeanRoof(const std::vector<RoofFacet>& facets, const Shape& shape) {
    double area = 0.0, sum = 0.0;
    for (const RoofFacet& facet : facets) {
      const double own = Area(facet.outline);
      area += own;
      sum += own * facet.HeightAt(Centroid(facet.outline));
    }
    return area > 0.0 ? sum / area : shape.ground_z + HeightOf(shape);
  }

  const BuildingsInput& input_;
  base::ThreadPool& threads_;
  FitOptions fit_options_;
  bool overhang_measured_ = false;
  std::vector<Candidate> candidates_;
  std::vector<MatchedPoints> matched_;  // of each candidate
  std::vector<Direction> directions_;
  std::vector<std::optional<ShapeGuess>> guesses_;
  std::vector<std::optional<Fitted>> fits_;
  std::vector<std::string> empty_outlines_;  // names of given ones without a building
};

void Scale(double factor, BuildingSet* set) {
  for (Building& building : set->buildings) {
    Measures& m = building.measures;
    for (Measure* length : {&m.ground_m, &m.eave_m, &m.ridge_m, &m.height_m, &m.length_m, &m.width_m}) {
      length->value *= factor;
      length->sigma *= factor;
    }
    for (Measure* area : {&m.footprint_m2, &m.roof_m2}) {
      area->value *= factor * factor;
      area->sigma *= factor * factor;
    }
    m.volume_m3.value *= factor * factor * factor;
    m.volume_m3.sigma *= factor * factor * factor;
  }
}

// Lengths in metres need a scale: of the geo-reference, or of two points whose distance was measured on site.
void ApplyScale(const BuildingsInput& input, BuildingSet* set) {
  const std::vector<double>& bar = input.options.scale_bar;
  if (bar.empty()) {
    set->metric = input.georeferenced || input.accuracy.HasScale();
    set->scale_source = input.georeferenced ? "geo-reference" : set->metric ? "scale bar" : "unknown";
    return;
  }
  set->metric = true;
  set->scale = ScaleOf(bar);
  set->scale_source = "scale bar";
  Scale(set->scale, set);
}

}  // namespace

BuildingSet MakeBuildings(const BuildingsInput& input, base::ThreadPool& threads) {
  SKYQUILT_CHECK(input.cloud != nullptr && input.ground != nullptr && input.gsd_m > 0.0, "cloud, ground and gsd must be set");
  input.options.Check();
  BuildingSet set = BuildingsMaker(input, threads).Make();
  ApplyScale(input, &set);
  return set;
}

}  // namespace skyquilt::buildings
