#include "prepare/poses/seed/verdict.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <numeric>
#include <unordered_map>

#include "core/base/disjoint_sets.h"
#include "core/base/order_statistics.h"
#include "prepare/bundle/resect.h"
#include "prepare/poses/seed/footprint.h"

namespace skyquilt::prepare::poses {
namespace {

constexpr double kMaxError = 1.5;
// Nearly all: the mapper places those that are left out here more often than not.
constexpr double kMinPlaced = 0.97;
constexpr double kMinAgreeing = 0.5;

// Per photo, entries that agree, and entries whose track has at least two placed photos.
struct Tally {
  std::vector<size_t> agreeing, possible;
};

Tally Count(const bundle::BundleProblem& bundle) {
  Tally tally{std::vector<size_t>(bundle.photos.size(), 0), std::vector<size_t>(bundle.photos.size(), 0)};
  for (uint32_t t = 0; t < bundle.tracks.size(); ++t) {
    const uint32_t first = bundle.tracks.first[t], last = bundle.tracks.first[t + 1];
    size_t n_placed = 0;
    for (uint32_t e = first; e < last; ++e) n_placed += bundle.photos[bundle.tracks.entries[e].photo].placed ? 1 : 0;
    if (n_placed < 2) continue;
    for (uint32_t e = first; e < last; ++e) {
      const uint32_t photo = bundle.tracks.entries[e].photo;
      if (!bundle.photos[photo].placed) continue;
      ++tally.possible[photo];
      tally.agreeing[photo] += bundle.agrees[e] != 0 ? 1 : 0;
    }
  }
  return tally;
}

// Numbers of common points of pairs of photos; the key is the first photo times 2^32 plus the second.
std::unordered_map<uint64_t, size_t> SharedPoints(const bundle::BundleProblem& bundle) {
  std::unordered_map<uint64_t, size_t> shared;
  std::vector<uint32_t> seen;
  for (uint32_t t = 0; t < bundle.tracks.size(); ++t) {
    if (bundle.has_point[t] == 0) continue;
    seen.clear();
    for (uint32_t e = bundle.tracks.first[t]; e < bundle.tracks.first[t + 1]; ++e) {
      const uint32_t photo = bundle.tracks.entries[e].photo;
      if (bundle.agrees[e] != 0 && bundle.photos[photo].placed) seen.push_back(photo);
    }
    // The next few in the track: all pairs of a long one would take long.
    constexpr size_t kReach = 5;
    for (size_t i = 0; i < seen.size(); ++i) {
      for (size_t j = i + 1; j < std::min(seen.size(), i + 1 + kReach); ++j) ++shared[(uint64_t{seen[i]} << 32U) + seen[j]];
    }
  }
  return shared;
}

// Placed photos that are tied together by common points, the largest group first.
std::vector<std::vector<uint32_t>> TiedGroups(const bundle::BundleProblem& bundle) {
  base::DisjointSets sets(bundle.photos.size());
  for (const auto& [pair, n] : SharedPoints(bundle)) {
    if (n >= kLeastShared) sets.Join(static_cast<uint32_t>(pair >> 32U), static_cast<uint32_t>(pair));
  }
  std::map<uint32_t, std::vector<uint32_t>> members;
  for (uint32_t i = 0; i < bundle.photos.size(); ++i) {
    if (bundle.photos[i].placed) members[sets.Root(i)].push_back(i);
  }
  std::vector<std::vector<uint32_t>> groups;
  for (auto& [root, group] : members) groups.push_back(std::move(group));
  std::stable_sort(groups.begin(), groups.end(), [](const auto& one, const auto& other) { return one.size() > other.size(); });
  return groups;
}

// Tags hold the frame of a group: enough of them, with angles, or else in a plane and not on a line.
bool IsHeldByTags(const bundle::BundleProblem& bundle, const std::vector<uint32_t>& group, double height_m) {
  std::vector<Eigen::Vector2d> places;
  size_t n_angles = 0;
  for (const uint32_t i : group) {
    if (!bundle.photos[i].gps) continue;
    places.push_back(bundle.photos[i].gps->head<2>());
    n_angles += bundle.photos[i].tagged_rotation ? 1 : 0;
  }
  if (places.size() < kLeastOfPart) return false;
  if (n_angles >= kLeastOfPart) return true;
  constexpr double kLeastWidth = 0.1;  // of the height, one standard deviation
  return SpreadOf(places).smaller > kLeastWidth * height_m;
}

bool AreApart(const bundle::BundleProblem& bundle, const std::vector<uint32_t>& one, const std::vector<uint32_t>& other, double height_m) {
  const auto footprint = [&](uint32_t i) {
    const bundle::BundlePhoto& photo = bundle.photos[i];
    return FootprintOf(bundle.lenses[static_cast<size_t>(photo.lens)].camera, photo.cam_from_enu, photo.centre, height_m);
  };
  std::vector<Footprint> others;
  for (const uint32_t i : other) others.push_back(footprint(i));
  return std::all_of(one.begin(), one.end(), [&](uint32_t i) {
    const Footprint own = footprint(i);
    return std::none_of(others.begin(), others.end(), [&](const Footprint& there) { return own.IsLike(there); });
  });
}

// Of groups that nothing ties, the largest stays, and those that tags can place beside it.
size_t RemoveUntied(bundle::BundleProblem& bundle, std::optional<double> height_m) {
  const std::vector<std::vector<uint32_t>> groups = TiedGroups(bundle);
  size_t removed = 0;
  std::vector<const std::vector<uint32_t>*> kept;
  for (const std::vector<uint32_t>& group : groups) {
    const auto is_apart = [&](const auto* other) { return AreApart(bundle, group, *other, *height_m); };
    if (kept.empty() || (height_m && IsHeldByTags(bundle, group, *height_m) && std::all_of(kept.begin(), kept.end(), is_apart))) {
      kept.push_back(&group);
      continue;
    }
    for (const uint32_t i : group) bundle.photos[i].placed = false;
    removed += group.size();
  }
  return removed;
}

// Per photo, the most tracks that it has in common with one placed photo.
std::vector<size_t> MostCommonTracks(const bundle::BundleProblem& bundle) {
  std::vector<std::unordered_map<uint32_t, size_t>> common(bundle.photos.size());
  for (uint32_t t = 0; t < bundle.tracks.size(); ++t) {
    const uint32_t first = bundle.tracks.first[t], last = bundle.tracks.first[t + 1];
    // The next few in the track, as above.
    constexpr uint32_t kReach = 5;
    for (uint32_t e = first; e < last; ++e) {
      for (uint32_t other = e + 1; other < std::min(last, e + 1 + kReach); ++other) {
        const uint32_t a = bundle.tracks.entries[e].photo, b = bundle.tracks.entries[other].photo;
        if (bundle.photos[b].placed) ++common[a][b];
        if (bundle.photos[a].placed) ++common[b][a];
      }
    }
  }
  std::vector<size_t> most;
  most.reserve(common.size());
  for (const auto& with : common) {
    size_t n = 0;
    for (const auto& [photo, tracks] : with) n = std::max(n, tracks);
    most.push_back(n);
  }
  return most;
}

// Photos without a pose that hardly look like any placed photo, as those of another place: nobody else could place them.
std::vector<char> FindStrangers(const bundle::BundleProblem& bundle) {
  const std::vector<size_t> most = MostCommonTracks(bundle);
  std::vector<double> usual;
  for (size_t i = 0; i < most.size(); ++i) {
    if (bundle.photos[i].placed) usual.push_back(static_cast<double>(most[i]));
  }
  std::vector<char> strange(most.size(), 0);
  if (usual.empty()) return strange;
  const double few = kStrangersShare * base::Median(std::move(usual));
  for (size_t i = 0; i < most.size(); ++i) {
    strange[i] = !bundle.photos[i].placed && most[i] < kStrangersMatches && static_cast<double>(most[i]) < few ? 1 : 0;
  }
  // Many are a part of the survey that is not connected yet.
  const auto n_strange = static_cast<double>(std::count(strange.begin(), strange.end(), 1));
  if (n_strange > kMaxStrangers * static_cast<double>(strange.size())) std::fill(strange.begin(), strange.end(), 0);
  return strange;
}

std::string Percent(double share) {
  return std::to_string(static_cast<int>(100.0 * share + 0.5)) + " %";
}

std::string Fixed(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.1f", value);
  return text;
}

}  // namespace

size_t RemoveContradicted(bundle::BundleProblem& bundle, std::optional<double> height_m) {
  const Tally tally = Count(bundle);
  size_t removed = 0;
  for (size_t i = 0; i < bundle.photos.size(); ++i) {
    if (!bundle.photos[i].placed) continue;
    const auto agreeing = static_cast<double>(tally.agreeing[i]), possible = static_cast<double>(tally.possible[i]);
    if (tally.agreeing[i] >= bundle::kLeastObservations && agreeing >= kLeastShare * possible) continue;
    bundle.photos[i].placed = false;
    ++removed;
  }
  return removed + RemoveUntied(bundle, height_m);
}

Verdict Judge(const bundle::BundleProblem& bundle, double height_m) {
  Verdict verdict;
  std::vector<size_t> n_entries(bundle.photos.size(), 0);
  for (const bundle::TrackEntry& entry : bundle.tracks.entries) ++n_entries[entry.photo];
  const std::vector<char> strange = FindStrangers(bundle);
  std::vector<double> off_m;
  for (size_t i = 0; i < bundle.photos.size(); ++i) {
    const bundle::BundlePhoto& photo = bundle.photos[i];
    verdict.n_matched += n_entries[i] >= bundle::kLeastObservations && strange[i] == 0 ? 1 : 0;
    verdict.n_placed += photo.placed ? 1 : 0;
    if (photo.placed && photo.gps) off_m.push_back((photo.centre - *photo.gps).head<2>().norm());
  }
  std::vector<double> errors;
  for (uint32_t t = 0; t < bundle.tracks.size(); ++t) {
    if (bundle.has_point[t] == 0) continue;
    for (uint32_t e = bundle.tracks.first[t]; e < bundle.tracks.first[t + 1]; ++e) {
      if (bundle.agrees[e] != 0) errors.push_back(bundle.Error(e, bundle.point[t]));
    }
  }
  const Tally tally = Count(bundle);
  const auto n_possible = static_cast<double>(std::accumulate(tally.possible.begin(), tally.possible.end(), size_t{0}));
  const auto n_agreeing = static_cast<double>(std::accumulate(tally.agreeing.begin(), tally.agreeing.end(), size_t{0}));
  verdict.share_agreeing = n_possible > 0.0 ? n_agreeing / n_possible : 0.0;
  verdict.median_error = errors.empty() ? 0.0 : base::Median(std::move(errors));
  verdict.median_gps_m = off_m.empty() ? 0.0 : base::Median(std::move(off_m));
  const double max_gps_m = std::max(10.0, 0.15 * height_m);
  if (verdict.n_placed < 3 || static_cast<double>(verdict.n_placed) < kMinPlaced * static_cast<double>(verdict.n_matched)) {
    verdict.reason = "only " + std::to_string(verdict.n_placed) + " of " + std::to_string(verdict.n_matched) + " photos fit together";
  } else if (verdict.share_agreeing < kMinAgreeing) {
    verdict.reason = "only " + Percent(verdict.share_agreeing) + " of the matches agree with the poses";
  } else if (!(verdict.median_error < kMaxError)) {
    verdict.reason = "the median reprojection error is " + Fixed(verdict.median_error) + " pixels";
  } else if (verdict.median_gps_m > max_gps_m) {
    verdict.reason = "the poses are " + Fixed(verdict.median_gps_m) + " m from the tagged positions";
  } else {
    verdict.good = true;
  }
  return verdict;
}

}  // namespace skyquilt::prepare::poses
