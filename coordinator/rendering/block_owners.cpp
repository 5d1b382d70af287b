#include "coordinator/rendering/block_owners.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <numeric>
#include <set>

#include "core/base/errors.h"

namespace skyquilt::coordinator {
namespace {

// The bits of two 16-bit numbers in turn: the position on a Z-order curve (Morton 1966).
uint64_t Interleave(uint32_t x, uint32_t y) {
  uint64_t key = 0;
  for (uint32_t bit = 0; bit < 16; ++bit) {
    key |= static_cast<uint64_t>((x >> bit) & 1U) << (2 * bit);
    key |= static_cast<uint64_t>((y >> bit) & 1U) << (2 * bit + 1);
  }
  return key;
}

// The blocks in Z-order of their centres.
std::vector<int> AlongCurve(const scene::FieldStore& store) {
  Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector2d high = -low;
  const auto centre = [&](int k) -> Eigen::Vector2d { return 0.5 * (store.block(k).box.min_enu + store.block(k).box.max_enu).head<2>(); };
  for (int k = 0; k < store.size(); ++k) {
    low = low.cwiseMin(centre(k));
    high = high.cwiseMax(centre(k));
  }
  const double extent = std::max((high - low).maxCoeff(), 1e-9);
  std::vector<uint64_t> key;
  for (int k = 0; k < store.size(); ++k) {
    const Eigen::Vector2d on_grid = (centre(k) - low) / extent * 65535.0;
    key.push_back(Interleave(static_cast<uint32_t>(on_grid.x()), static_cast<uint32_t>(on_grid.y())));
  }
  std::vector<int> order(key.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return key[static_cast<size_t>(a)] < key[static_cast<size_t>(b)]; });
  return order;
}

// Whether two blocks, with their blend margins, touch or overlap in plan view.
bool Overlap(const render::TrainedField& a, const render::TrainedField& b) {
  const double reach = a.blend_m + b.blend_m;
  return (a.box.min_enu.head<2>().array() - reach <= b.box.max_enu.head<2>().array()).all() &&
         (b.box.min_enu.head<2>().array() - reach <= a.box.max_enu.head<2>().array()).all();
}

}  // namespace

std::vector<int> AssignBlocks(const scene::FieldStore& store, int n) {
  SKYQUILT_CHECK(n >= 1, std::to_string(n));
  double total = 0.0;
  for (int k = 0; k < store.size(); ++k) total += store.Bytes(k);
  std::vector<int> owner(static_cast<size_t>(store.size()), 0);
  double dealt = 0.0;
  for (const int k : AlongCurve(store)) {
    // The middle of the block decides, so that parts are about equal.
    const double middle = dealt + 0.5 * store.Bytes(k);
    owner[static_cast<size_t>(k)] = std::min(n - 1, static_cast<int>(middle / std::max(total, 1.0) * n));
    dealt += store.Bytes(k);
  }
  return owner;
}

std::vector<std::vector<int>> OverlappingLowerBlocks(const scene::FieldStore& store) {
  std::vector<std::vector<int>> lower(static_cast<size_t>(store.size()));
  for (int k = 0; k < store.size(); ++k) {
    for (int other = 0; other < k; ++other) {
      if (Overlap(store.block(other), store.block(k))) lower[static_cast<size_t>(k)].push_back(other);
    }
  }
  return lower;
}

double MaxBytesPerRank(const scene::FieldStore& store, const std::vector<std::vector<int>>& lower_neighbours, std::span<const int> owner, int n) {
  std::vector<double> bytes(static_cast<size_t>(n), 0.0);
  std::set<int> holders;
  for (size_t k = 0; k < owner.size(); ++k) {
    holders = {owner[k]};
    // Where blocks overlap, the owner of the first renders both.
    for (const int first : lower_neighbours[k]) holders.insert(owner[static_cast<size_t>(first)]);
    for (const int holder : holders) bytes[static_cast<size_t>(holder)] += store.Bytes(static_cast<int>(k));
  }
  return *std::max_element(bytes.begin(), bytes.end()) + store.ContextBytes();
}

std::vector<RenderGroup> MakeRenderGroups(const scene::FieldStore& store, std::span<const int> ranks, std::span<const double> memory_bytes) {
  SKYQUILT_CHECK(!ranks.empty() && ranks.size() == memory_bytes.size(), "one memory size per rank");
  const double least = *std::min_element(memory_bytes.begin(), memory_bytes.end());
  const auto n = static_cast<int>(ranks.size());
  int size = 1;
  const std::vector<std::vector<int>> neighbours = OverlappingLowerBlocks(store);
  while (size < n && MaxBytesPerRank(store, neighbours, AssignBlocks(store, size), size) > least) ++size;
  const int n_groups = n / size;
  std::vector<RenderGroup> groups(static_cast<size_t>(n_groups));
  for (int i = 0; i < n; ++i) groups[static_cast<size_t>(i % n_groups)].ranks.push_back(ranks[static_cast<size_t>(i)]);
  for (RenderGroup& group : groups) group.owner = AssignBlocks(store, static_cast<int>(group.ranks.size()));
  return groups;
}

}  // namespace skyquilt::coordinator
