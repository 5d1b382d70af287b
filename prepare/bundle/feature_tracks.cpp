#include "prepare/bundle/feature_tracks.h"

#include <algorithm>
#include <numeric>

#include "core/base/cancel.h"
#include "core/base/disjoint_sets.h"

namespace skyquilt::prepare::bundle {
namespace {

// Groups of nodes, each a ring. Every node belongs to a photo; no group has two nodes of one photo.
class Groups {
 public:
  Groups(std::vector<uint32_t> photo, size_t n_photos) : photo_(std::move(photo)), next_(photo_.size()), sets_(photo_.size()), seen_(n_photos, 0) {
    std::iota(next_.begin(), next_.end(), 0U);
  }

  void Join(uint32_t a, uint32_t b) {
    const uint32_t root_a = Root(a), root_b = Root(b);
    if (root_a == root_b || ShareAPhoto(root_a, root_b)) return;
    sets_.Join(root_a, root_b);
    std::swap(next_[root_a], next_[root_b]);
  }

  uint32_t Root(uint32_t node) { return sets_.Root(node); }

  uint32_t Next(uint32_t node) const { return next_[node]; }
  uint32_t Photo(uint32_t node) const { return photo_[node]; }

 private:
  bool ShareAPhoto(uint32_t a, uint32_t b) {
    ++mark_;
    uint32_t node = a;
    do {
      seen_[photo_[node]] = mark_;
      node = next_[node];
    } while (node != a);
    node = b;
    do {
      if (seen_[photo_[node]] == mark_) return true;
      node = next_[node];
    } while (node != b);
    return false;
  }

  std::vector<uint32_t> photo_, next_;
  base::DisjointSets sets_;
  std::vector<uint64_t> seen_;
  uint64_t mark_ = 0;
};

constexpr int kGrid = 8;

int CellOf(const BundleProblem& bundle, uint32_t entry) {
  const BundlePhoto& photo = bundle.photos[bundle.tracks.entries[entry].photo];
  const camera::Camera& camera = bundle.lenses[static_cast<size_t>(photo.lens)].camera;
  const Eigen::Vector2d& pixel = bundle.pixel[entry];
  const auto cell = [](double at, int size) { return std::clamp(static_cast<int>(kGrid * at / size), 0, kGrid - 1); };
  return kGrid * cell(pixel.y(), camera.height) + cell(pixel.x(), camera.width);
}

}  // namespace

FeatureTracks JoinMatches(const std::vector<IndexedPair>& pairs, const std::vector<size_t>& n_features) {
  std::vector<size_t> offset(n_features.size() + 1, 0);
  std::partial_sum(n_features.begin(), n_features.end(), offset.begin() + 1);
  std::vector<uint32_t> photo(offset.back());
  for (size_t i = 0; i < n_features.size(); ++i) {
    std::fill(photo.begin() + static_cast<std::ptrdiff_t>(offset[i]), photo.begin() + static_cast<std::ptrdiff_t>(offset[i + 1]),
              static_cast<uint32_t>(i));
  }
  Groups groups(std::move(photo), n_features.size());
  std::vector<size_t> order(pairs.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](size_t x, size_t y) { return pairs[x].features.size() > pairs[y].features.size(); });
  for (const size_t k : order) {
    base::ThrowIfCancelled();
    const IndexedPair& pair = pairs[k];
    for (const auto& [a, b] : pair.features) groups.Join(static_cast<uint32_t>(offset[pair.a] + a), static_cast<uint32_t>(offset[pair.b] + b));
  }
  FeatureTracks tracks;
  std::vector<uint32_t> members;
  for (uint32_t root = 0; root < offset.back(); ++root) {
    if (groups.Root(root) != root || groups.Next(root) == root) continue;
    members.clear();
    uint32_t node = root;
    do {
      members.push_back(node);
      node = groups.Next(node);
    } while (node != root);
    std::sort(members.begin(), members.end());
    for (const uint32_t member : members) {
      const uint32_t owner = groups.Photo(member);
      tracks.entries.push_back({owner, static_cast<uint32_t>(member - offset[owner])});
    }
    tracks.first.push_back(static_cast<uint32_t>(tracks.entries.size()));
  }
  return tracks;
}

std::vector<uint32_t> ChooseTracks(const BundleProblem& bundle, const std::vector<char>& usable, const std::vector<char>& counts, size_t per_photo) {
  const FeatureTracks& tracks = bundle.tracks;
  std::vector<uint32_t> length(tracks.size(), 0), order;
  for (uint32_t t = 0; t < tracks.size(); ++t) {
    if (usable[t] == 0) continue;
    for (uint32_t e = tracks.first[t]; e < tracks.first[t + 1]; ++e) length[t] += counts[e] != 0 ? 1 : 0;
    if (length[t] >= 2) order.push_back(t);
  }
  std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return length[a] > length[b]; });
  const size_t per_cell = std::max<size_t>(1, per_photo / (kGrid * kGrid));
  std::vector<uint32_t> filled(bundle.photos.size() * kGrid * kGrid, 0);
  std::vector<size_t> in_photo(bundle.photos.size(), 0);
  const auto least = static_cast<size_t>(kLeastFilled * static_cast<double>(per_photo));
  std::vector<uint32_t> chosen, cells;
  for (const uint32_t t : order) {
    cells.clear();
    size_t wanting = 0;
    bool needed = false;
    for (uint32_t e = tracks.first[t]; e < tracks.first[t + 1]; ++e) {
      if (counts[e] == 0) continue;
      cells.push_back(tracks.entries[e].photo * kGrid * kGrid + static_cast<uint32_t>(CellOf(bundle, e)));
      wanting += filled[cells.back()] < per_cell ? 1 : 0;
      needed = needed || in_photo[tracks.entries[e].photo] < least;
    }
    if (!needed && 2 * wanting < cells.size()) continue;
    for (const uint32_t cell : cells) {
      ++filled[cell];
      ++in_photo[cell / (kGrid * kGrid)];
    }
    chosen.push_back(t);
  }
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

}  // namespace skyquilt::prepare::bundle
