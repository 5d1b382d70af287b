#include "buildings/candidates/find_candidates.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

#include "buildings/candidates/candidate_checks.h"
#include "buildings/candidates/gather_points.h"
#include "buildings/candidates/looks_like_bridge.h"
#include "buildings/candidates/piece_kind.h"
#include "buildings/candidates/plan_index.h"
#include "buildings/candidates/roof_outlines.h"
#include "buildings/candidates/survey_edge.h"
#include "buildings/candidates/top_raster.h"
#include "core/base/cancel.h"
#include "core/base/errors.h"

namespace skyquilt::buildings {
namespace {

constexpr double kPlanCell_m = 2.0;
constexpr double kLeastCell_m = 0.2;  // of outlines
constexpr double kCellSpacings = 0.6;
constexpr double kLowestShare = 0.75;    // of min_height_m: roofs may begin lower at their eaves
constexpr float kSteepestPoint = 0.35F;  // normal.z of points of roofs
constexpr double kGroupCell_m = 1.0;
constexpr double kLeastGreen = 0.01;  // share of green points from which colours tell vegetation
constexpr double kCutReach_m = 1.5;

PlaneOptions PlaneOptionsOf(double gsd_m, double spacing_m) {
  PlaneOptions planes;
  planes.distance_m = 1.75 * gsd_m;
  planes.reach_m = 2.2 * spacing_m;
  planes.min_points = 12;
  planes.min_area_m2 = 1.5;
  return planes;
}

// High enough and not steep.
bool MayBeRoof(const Surface& surface, uint32_t i) {
  const SurfacePoint& point = surface.cloud.points[i];
  if (point.filled != 0 || point.normal.z() < kSteepestPoint) return false;
  const Eigen::Vector3d at = surface.cloud.At(i);
  return at.z() - surface.ground.At(at.head<2>()) >= kLowestShare * surface.options.min_height_m;
}

std::vector<uint32_t> HighPoints(const Surface& surface, base::ThreadPool& threads) {
  const size_t n = surface.cloud.points.size();
  std::vector<uint8_t> high(n, 0);
  constexpr size_t kTaskPoints = 65536;
  threads.ParallelFor(static_cast<int64_t>((n + kTaskPoints - 1) / kTaskPoints), [&](int64_t task, int) {
    if (base::CancelRequested()) return;
    const size_t begin = static_cast<size_t>(task) * kTaskPoints;
    for (size_t i = begin; i < std::min(n, begin + kTaskPoints); ++i) high[i] = MayBeRoof(surface, static_cast<uint32_t>(i)) ? 1 : 0;
  });
  base::ThrowIfCancelled();
  std::vector<uint32_t> chosen;
  for (size_t i = 0; i < n; ++i) {
    if (high[i] != 0) chosen.push_back(static_cast<uint32_t>(i));
  }
  return chosen;
}

std::vector<PlanePiece> FindPieces(const Surface& surface, std::span<const uint32_t> chosen, base::ThreadPool& threads) {
  const PlaneOptions options = PlaneOptionsOf(surface.gsd_m, surface.cloud.spacing_m);
  std::vector<RoofPlane> planes = GrowPlanes(surface.cloud, chosen, options, threads);
  std::vector<PlanePiece> pieces(planes.size());
  threads.ParallelFor(static_cast<int64_t>(planes.size()), [&](int64_t i, int) {
    const auto p = static_cast<size_t>(i);
    pieces[p] = JudgePiece(std::move(planes[p]), surface.cloud, surface.ground, surface.options, options.distance_m);
  });
  return pieces;
}

// Groups of pieces that are near each other seen from above, so that each can be outlined by itself.
std::vector<std::vector<PlanePiece>> GroupPieces(std::vector<PlanePiece> pieces, const PointCloud& cloud) {
  std::erase_if(pieces, [](const PlanePiece& piece) { return piece.kind == PieceKind::kNone; });
  std::vector<size_t> group(pieces.size());
  std::iota(group.begin(), group.end(), size_t{0});
  const auto root = [&](size_t i) {
    while (group[i] != i) i = group[i] = group[group[i]];
    return i;
  };
  std::map<std::pair<int64_t, int64_t>, size_t> at;  // a piece in each coarse cell
  for (size_t p = 0; p < pieces.size(); ++p) {
    for (const uint32_t i : pieces[p].plane.points) {
      const Eigen::Vector2d cell = (cloud.At(i).head<2>() / kGroupCell_m).array().floor();
      const auto x = static_cast<int64_t>(cell.x()), y = static_cast<int64_t>(cell.y());
      if (!at.try_emplace({x, y}, p).second) group[root(p)] = root(at[{x, y}]);
    }
  }
  for (const auto& [cell, p] : at) {
    for (int64_t dx = -1; dx <= 1; ++dx) {
      for (int64_t dy = -1; dy <= 1; ++dy) {
        const auto beside = at.find({cell.first + dx, cell.second + dy});
        if (beside != at.end()) group[root(p)] = root(beside->second);
      }
    }
  }
  std::map<size_t, std::vector<PlanePiece>> groups;
  for (size_t p = 0; p < pieces.size(); ++p) groups[root(p)].push_back(std::move(pieces[p]));
  std::vector<std::vector<PlanePiece>> result;
  result.reserve(groups.size());
  for (auto& [first, members] : groups) result.push_back(std::move(members));
  return result;
}

Eigen::AlignedBox2d BoxAround(std::span<const PlanePiece> pieces, const PointCloud& cloud, double margin_m) {
  Eigen::AlignedBox2d box;
  for (const PlanePiece& piece : pieces) {
    for (const uint32_t i : piece.plane.points) box.extend(Eigen::Vector2d(cloud.At(i).head<2>()));
  }
  const Eigen::Vector2d margin = Eigen::Vector2d::Constant(margin_m);
  return {box.min() - margin, box.max() + margin};
}

// Not finer than the points, or the raster would be full of holes.
double CellOf(const Surface& surface) {
  return std::max({kLeastCell_m, surface.gsd_m, kCellSpacings * surface.cloud.spacing_m});
}

bool ColoursTell(const PointCloud& cloud, double max_green) {
  const auto green = std::count_if(cloud.points.begin(), cloud.points.end(), [&](const SurfacePoint& p) { return ExcessGreen(p) > max_green; });
  return static_cast<double>(green) >= kLeastGreen * static_cast<double>(cloud.points.size());
}

// What the whole survey says about one candidate.
struct SurveyFacts {
  SurveyEdge edge;
  bool colours_tell;
};

std::vector<Gathered> CandidatesOf(std::span<const PlanePiece> pieces, const Surface& surface, const SurveyFacts& facts) {
  const TopRaster top = RasteriseTop(surface.cloud, surface.plan, BoxAround(pieces, surface.cloud, kAround_m + 1.0), CellOf(surface));
  const RoofLevels levels = FindRoofLevels(top, pieces, surface.cloud, surface.options.max_green);
  std::vector<Gathered> found;
  for (const RoofArea& area : FindRoofAreas(top, levels, pieces, surface.options, surface.gsd_m, surface.cloud.spacing_m)) {
    Gathered gathered = GatherPoints(area, pieces, surface);
    std::vector<Polygon> outlines = OutlinesOf(area.mask.value, area.mask.columns, area.mask.rows, area.origin, area.cell_m);
    if (outlines.empty() || gathered.candidate.planes.empty()) continue;
    gathered.candidate.outline = std::move(outlines.front());
    const Standing standing = MeasureStanding(area, top, levels, surface.ground, surface.options.min_height_m);
    Candidate& candidate = gathered.candidate;
    const double area_m2 = Area(candidate.outline);
    if (!LooksLikeBuilding(standing, area_m2, candidate.planes.front().area_m2, candidate.wall.size())) continue;
    if (LooksLikeCrown(SizesOf(candidate.planes, area_m2), surface.gsd_m, facts.colours_tell)) continue;
    if (LooksLikeBridge(area, top, surface.ground, facts.edge, surface.options.min_height_m)) continue;
    candidate.edge_share = facts.edge.ShareOf(candidate.outline, kCutReach_m);
    found.push_back(std::move(gathered));
  }
  return found;
}

std::vector<Candidate> WithSharedWalls(std::vector<Gathered> all) {
  ShareWalls(&all);
  std::vector<Candidate> candidates;
  candidates.reserve(all.size());
  for (Gathered& gathered : all) candidates.push_back(std::move(gathered.candidate));
  return candidates;
}

// The cells of the raster inside an outline.
std::vector<uint32_t> CellsIn(const Polygon& outline, const TopRaster& top) {
  std::vector<uint32_t> cells;
  for (size_t cell = 0; cell < top.size(); ++cell) {
    if (Contains(outline, top.CentreOf(cell))) cells.push_back(static_cast<uint32_t>(cell));
  }
  return cells;
}

// Somebody says that this is a building: pieces that look like vegetation or are low are used when there are no others.
Gathered GatherGiven(const GivenOutline& given, const Surface& surface, base::ThreadPool& threads) {
  Gathered gathered;
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector2d& corner : given.outline.outer) box.extend(corner);
  if (!box.isEmpty() && box.min().allFinite() && box.max().allFinite()) {
    std::vector<uint32_t> chosen;
    surface.plan.ForEachIn(box, [&](uint32_t i) {
      if (MayBeRoof(surface, i) && Contains(given.outline, surface.cloud.At(i).head<2>())) chosen.push_back(i);
    });
    std::sort(chosen.begin(), chosen.end());
    std::vector<PlanePiece> pieces = FindPieces(surface, chosen, threads);
    if (std::none_of(pieces.begin(), pieces.end(), [](const PlanePiece& piece) { return piece.kind != PieceKind::kNone; })) {
      for (PlanePiece& piece : pieces) {
        piece.kind = PieceKind::kRoof;
        piece.green = true;
      }
    }
    const Eigen::Vector2d margin = Eigen::Vector2d::Constant(kAround_m + 1.0);
    const TopRaster top = RasteriseTop(surface.cloud, surface.plan, {box.min() - margin, box.max() + margin}, CellOf(surface));
    const RoofLevels levels = FindRoofLevels(top, pieces, surface.cloud, surface.options.max_green);
    const std::vector<uint32_t> cells = CellsIn(given.outline, top);
    if (!cells.empty()) gathered = GatherPoints(CutOut(top, levels, cells), pieces, surface);
  }
  gathered.candidate.outline = given.outline;
  gathered.candidate.given = true;
  gathered.candidate.given_id = given.id;
  return gathered;
}

}  // namespace

std::vector<Candidate> FindCandidates(const PointCloud& cloud, const GroundGrid& ground, const BuildingsOptions& options, double gsd_m,
                                      base::ThreadPool& threads) {
  SKYQUILT_CHECK(gsd_m > 0.0 && cloud.spacing_m > 0.0, "GSD and spacing must be known");
  const PlanIndex plan(cloud, kPlanCell_m);
  const Surface surface{cloud, ground, plan, options, gsd_m};
  const SurveyFacts facts{SurveyEdge(cloud), ColoursTell(cloud, options.max_green)};
  const std::vector<std::vector<PlanePiece>> groups = GroupPieces(FindPieces(surface, HighPoints(surface, threads), threads), cloud);
  std::vector<std::vector<Gathered>> of_group(groups.size());
  threads.ParallelFor(static_cast<int64_t>(groups.size()), [&](int64_t g, int) {
    if (base::CancelRequested()) return;
    of_group[static_cast<size_t>(g)] = CandidatesOf(groups[static_cast<size_t>(g)], surface, facts);
  });
  base::ThrowIfCancelled();
  std::vector<Gathered> all;
  for (std::vector<Gathered>& found : of_group) std::move(found.begin(), found.end(), std::back_inserter(all));
  std::vector<Candidate> candidates = WithSharedWalls(std::move(all));
  std::stable_sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) { return Area(a.outline) > Area(b.outline); });
  return candidates;
}

std::vector<Candidate> CandidatesIn(std::span<const GivenOutline> outlines, const PointCloud& cloud, const GroundGrid& ground,
                                    const BuildingsOptions& options, double gsd_m, base::ThreadPool& threads) {
  SKYQUILT_CHECK(gsd_m > 0.0 && cloud.spacing_m > 0.0, "GSD and spacing must be known");
  const PlanIndex plan(cloud, kPlanCell_m);
  const Surface surface{cloud, ground, plan, options, gsd_m};
  const SurveyEdge edge(cloud);
  std::vector<Gathered> all;
  for (const GivenOutline& given : outlines) {
    base::ThrowIfCancelled();
    all.push_back(GatherGiven(given, surface, threads));
    all.back().candidate.edge_share = edge.ShareOf(given.outline, kCutReach_m);
  }
  return WithSharedWalls(std::move(all));
}

}  // namespace skyquilt::buildings
