#include "prepare/poses/pairs.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "core/base/cancel.h"
#include "core/base/disjoint_sets.h"
#include "core/base/errors.h"
#include "core/base/order_statistics.h"

namespace skyquilt::prepare::poses {

namespace {

constexpr double kUnknown = std::numeric_limits<double>::infinity();

struct Candidate {
  double distance2;  // m^2
  uint32_t gap;      // in the list of photos
  uint32_t photo;
  auto operator<=>(const Candidate&) const = default;
};

// The others with a place, nearest first; only the first `n` are in order.
template <typename Distance2>
std::vector<Candidate> Nearest(const std::vector<std::optional<PhotoPlace>>& places, uint32_t photo, size_t n, const Distance2& distance2) {
  std::vector<Candidate> candidates;
  candidates.reserve(places.size());
  for (uint32_t other = 0; other < places.size(); ++other) {
    if (other == photo || !places[other]) continue;
    candidates.push_back({distance2(*places[photo], *places[other]), other > photo ? other - photo : photo - other, other});
  }
  n = std::min(n, candidates.size());
  std::partial_sort(candidates.begin(), candidates.begin() + static_cast<std::ptrdiff_t>(n), candidates.end());
  return candidates;
}

double LookDistance2(const PhotoPlace& a, const PhotoPlace& b) {
  return (a.target - b.target).squaredNorm() + (a.view - b.view).squaredNorm();
}

double CameraDistance2(const PhotoPlace& a, const PhotoPlace& b) {
  return (a.camera - b.camera).squaredNorm();
}

// Nothing for targets at the same spot.
std::optional<size_t> SectorOf(const PhotoPlace& from, const PhotoPlace& to, size_t n_sectors) {
  const Eigen::Vector2d step = to.target - from.target;
  if (step.squaredNorm() == 0.0) return std::nullopt;
  const double turn = std::atan2(step.x(), step.y()) / (2.0 * std::numbers::pi);  // of -0.5 to 0.5
  return static_cast<size_t>(std::floor((turn + 1.0) * static_cast<double>(n_sectors))) % n_sectors;
}

// Numbers of photos that the photo is paired with.
std::vector<uint32_t> Neighbors(const std::vector<std::optional<PhotoPlace>>& places, uint32_t photo, const PairRules& rules) {
  const std::vector<Candidate> nearest = Nearest(places, photo, rules.neighbors, LookDistance2);
  const size_t n = std::min(rules.neighbors, nearest.size());
  if (n == 0) return {};
  const double reach2 = nearest[n - 1].distance2 * rules.sector_reach * rules.sector_reach;
  std::vector<std::optional<Candidate>> of_sector(rules.sectors);
  for (const Candidate& candidate : nearest) {
    if (rules.sectors == 0 || candidate.distance2 > reach2) continue;
    const auto sector = SectorOf(*places[photo], *places[candidate.photo], rules.sectors);
    if (sector && (!of_sector[*sector] || candidate < *of_sector[*sector])) of_sector[*sector] = candidate;
  }
  std::vector<Candidate> first;
  for (const auto& candidate : of_sector) {
    if (candidate) first.push_back(*candidate);
  }
  std::sort(first.begin(), first.end());
  std::vector<uint32_t> chosen;
  const auto choose = [&](const Candidate& candidate) {
    if (chosen.size() < n && std::find(chosen.begin(), chosen.end(), candidate.photo) == chosen.end()) chosen.push_back(candidate.photo);
  };
  for (const Candidate& candidate : first) choose(candidate);
  for (size_t i = 0; i < n; ++i) choose(nearest[i]);
  return chosen;
}

// Which photos pairs join, one after the other.
base::DisjointSets GroupsOf(size_t n_photos, const PhotoPairs& pairs) {
  base::DisjointSets groups(n_photos);
  for (const PhotoPair& pair : pairs) groups.Join(pair.a, pair.b);
  return groups;
}

}  // namespace

PhotoPair MakePair(uint32_t a, uint32_t b) {
  SKYQUILT_CHECK(a != b, "a photo is not paired with itself");
  return {std::min(a, b), std::max(a, b)};
}

void SortPairs(PhotoPairs& pairs) {
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
}

PhotoPairs AllPairs(size_t n_photos) {
  PhotoPairs pairs;
  pairs.reserve(n_photos * (n_photos - std::min<size_t>(n_photos, 1)) / 2);
  for (uint32_t a = 0; a < n_photos; ++a) {
    for (uint32_t b = a + 1; b < n_photos; ++b) pairs.push_back({a, b});
  }
  return pairs;
}

PhotoPairs PairsInSpace(const std::vector<std::optional<PhotoPlace>>& places, const PairRules& rules) {
  PhotoPairs pairs;
  const size_t n_by_position = HasObliquePhotos(places) ? rules.position_neighbors : 0;
  for (uint32_t photo = 0; photo < places.size(); ++photo) {
    if (!places[photo]) continue;
    base::ThrowIfCancelled();
    for (const uint32_t other : Neighbors(places, photo, rules)) pairs.push_back(MakePair(photo, other));
    if (n_by_position == 0) continue;
    const std::vector<Candidate> nearest = Nearest(places, photo, n_by_position, CameraDistance2);
    for (size_t i = 0; i < std::min(n_by_position, nearest.size()); ++i) pairs.push_back(MakePair(photo, nearest[i].photo));
  }
  SortPairs(pairs);
  return pairs;
}

PhotoPairs NamePairs(const std::vector<uint32_t>& photos, size_t n_photos, size_t reach) {
  PhotoPairs pairs;
  for (const uint32_t photo : photos) {
    for (uint32_t step = 1; step <= reach; ++step) {
      if (photo >= step) pairs.push_back({photo - step, photo});
      if (photo + step < n_photos) pairs.push_back({photo, photo + step});
    }
  }
  SortPairs(pairs);
  return pairs;
}

size_t CountGroups(size_t n_photos, const PhotoPairs& pairs) {
  return GroupsOf(n_photos, pairs).count();
}

void ConnectGroups(size_t n_photos, size_t links, const std::function<std::vector<double>(uint32_t)>& costs, PhotoPairs& pairs) {
  struct Link {
    double cost;
    PhotoPair pair;
    auto operator<=>(const Link&) const = default;
  };
  // Every group but the largest gets links to others, so that the number of groups falls at least by half in a round.
  for (base::DisjointSets groups = GroupsOf(n_photos, pairs); groups.count() > 1;) {
    std::vector<size_t> size(n_photos, 0);
    std::vector<uint32_t> group(n_photos);
    for (uint32_t photo = 0; photo < n_photos; ++photo) ++size[group[photo] = groups.Root(photo)];
    const auto largest = static_cast<uint32_t>(std::max_element(size.begin(), size.end()) - size.begin());
    std::vector<std::vector<Link>> of_group(n_photos);
    for (uint32_t photo = 0; photo < n_photos; ++photo) {
      if (group[photo] == largest) continue;
      base::ThrowIfCancelled();
      const std::vector<double> cost = costs(photo);
      std::optional<Link> best;
      for (uint32_t other = 0; other < n_photos; ++other) {
        if (group[other] == group[photo]) continue;
        const Link link{cost[other], MakePair(photo, other)};
        if (!best || link < *best) best = link;
      }
      of_group[group[photo]].push_back(*best);
    }
    for (std::vector<Link>& found : of_group) {
      std::sort(found.begin(), found.end());
      if (found.size() > links) found.resize(std::max<size_t>(links, 1));
      for (const Link& link : found) {
        pairs.push_back(link.pair);
        groups.Join(link.pair.a, link.pair.b);
      }
    }
    SortPairs(pairs);
  }
}

std::vector<double> PlaceCosts(const std::vector<std::optional<PhotoPlace>>& places, uint32_t photo) {
  std::vector<double> costs(places.size(), kUnknown);
  if (!places[photo]) return costs;
  for (size_t other = 0; other < places.size(); ++other) {
    if (places[other]) costs[other] = LookDistance2(*places[photo], *places[other]);
  }
  return costs;
}

namespace {

// Distance to the scene over that to the sixth nearest photo, at an overlap of two thirds and a field of view of 60 degrees. Not the nearest: a rig
// may have five cameras at one place.
constexpr double kDepthPerSpacing = 2.0;
constexpr size_t kSpacingNeighbor = 6;
constexpr double kItself = std::numeric_limits<double>::infinity();

struct Pose {
  Eigen::Vector3d centre, direction;
};

std::vector<double> SquaredDistances(const std::vector<Pose>& poses, uint32_t photo, double depth) {
  std::vector<double> costs(poses.size());
  for (size_t other = 0; other < poses.size(); ++other) {
    costs[other] =
        (poses[other].centre - poses[photo].centre).squaredNorm() + depth * depth * (poses[other].direction - poses[photo].direction).squaredNorm();
  }
  costs[photo] = kItself;
  return costs;
}

}  // namespace

PhotoPairs PairsByPose(const std::vector<geo::Rigid3d>& cam_from_world, const PairRules& rules) {
  const size_t n = cam_from_world.size();
  if (n < std::max<size_t>(rules.all_below, 2)) return AllPairs(n);
  std::vector<Pose> poses;
  for (const geo::Rigid3d& pose : cam_from_world) {
    poses.push_back({pose.OriginInSource(), pose.rotation.conjugate() * Eigen::Vector3d::UnitZ()});
  }
  std::vector<double> spacing;
  for (uint32_t photo = 0; photo < n; ++photo) {
    base::ThrowIfCancelled();
    std::vector<double> costs = SquaredDistances(poses, photo, 0.0);
    const auto neighbor = costs.begin() + static_cast<std::ptrdiff_t>(std::min(kSpacingNeighbor, n - 1) - 1);
    std::nth_element(costs.begin(), neighbor, costs.end());
    spacing.push_back(std::sqrt(*neighbor));
  }
  const double depth = kDepthPerSpacing * base::Median(spacing);
  PhotoPairs pairs;
  std::vector<uint32_t> order(n);
  for (uint32_t photo = 0; photo < n; ++photo) {
    base::ThrowIfCancelled();
    const std::vector<double> costs = SquaredDistances(poses, photo, depth);
    std::iota(order.begin(), order.end(), 0U);
    const size_t k = std::min(rules.neighbors, n - 1);
    std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(k), order.end(),
                      [&](uint32_t a, uint32_t b) { return costs[a] != costs[b] ? costs[a] < costs[b] : a < b; });
    for (size_t i = 0; i < k; ++i) pairs.push_back(MakePair(photo, order[i]));
  }
  SortPairs(pairs);
  ConnectGroups(
      n, rules.links, [&](uint32_t photo) { return SquaredDistances(poses, photo, depth); }, pairs);
  return pairs;
}

}  // namespace skyquilt::prepare::poses
