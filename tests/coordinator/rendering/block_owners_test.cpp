#include "coordinator/rendering/block_owners.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "tests/support/random_scene.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::coordinator {
namespace {

constexpr int kRows = 4, kColumns = 4;

class BlockOwners : public ::testing::Test {
 protected:
  BlockOwners() {
    scene::WriteRandomScene(folder_ / "scene.h5", kRows, kColumns, 0.5, -2.0, true);
    store_ = std::make_unique<scene::FieldStore>(checkpoint::ArchiveReader(folder_ / "scene.h5"), folder_ / "scene.h5", 0.0, false);
  }
  double AllBytes() const {
    double bytes = store_->ContextBytes();
    for (int k = 0; k < store_->size(); ++k) bytes += store_->Bytes(k);
    return bytes;
  }

  TemporaryFolder folder_;
  std::unique_ptr<scene::FieldStore> store_;
};

TEST_F(BlockOwners, PartsAreEqualAndConnected) {
  const std::vector<int> owner = AssignBlocks(*store_, 4);
  for (int part = 0; part < 4; ++part) {
    EXPECT_EQ(std::count(owner.begin(), owner.end(), part), 4);
    // Four consecutive blocks of a Z-order curve form a square: any two of them are neighbours.
    for (size_t a = 0; a < owner.size(); ++a) {
      for (size_t b = 0; b < owner.size(); ++b) {
        if (owner[a] != part || owner[b] != part) continue;
        const auto n = static_cast<size_t>(kColumns);
        EXPECT_LE(std::max(a / n, b / n) - std::min(a / n, b / n), 1U);
        EXPECT_LE(std::max(a % n, b % n) - std::min(a % n, b % n), 1U);
      }
    }
  }
}

TEST_F(BlockOwners, APartIncludesTheNeighboursItIsBlendedWith) {
  const std::vector<std::vector<int>> lower = OverlappingLowerBlocks(*store_);
  EXPECT_TRUE(lower[0].empty());
  EXPECT_EQ(lower[5], (std::vector<int>{0, 1, 2, 4}));
  const std::vector<int> one(static_cast<size_t>(store_->size()), 0);
  EXPECT_NEAR(MaxBytesPerRank(*store_, lower, one, 1), AllBytes(), 1.0);
  const std::vector<int> own = [] {
    std::vector<int> numbers(kRows * kColumns);
    std::iota(numbers.begin(), numbers.end(), 0);
    return numbers;
  }();
  // The block itself and up to four neighbours with a higher index.
  EXPECT_NEAR(MaxBytesPerRank(*store_, lower, own, kRows * kColumns), store_->ContextBytes() + 5.0 * store_->Bytes(0), 0.2 * store_->Bytes(0));
}

TEST_F(BlockOwners, RanksThatHoldTheWholeSceneFormGroupsOfOne) {
  const std::vector<int> ranks = {1, 2, 3, 4, 5};
  const std::vector<RenderGroup> plenty = MakeRenderGroups(*store_, ranks, std::vector<double>(5, 2.0 * AllBytes()));
  EXPECT_EQ(plenty.size(), 5U);
  const std::vector<RenderGroup> half = MakeRenderGroups(*store_, ranks, std::vector<double>(5, 0.85 * AllBytes()));
  ASSERT_EQ(half.size(), 2U);
  EXPECT_EQ(half[0].ranks.size() + half[1].ranks.size(), 5U) << "every rank is in a group";
  const std::vector<RenderGroup> scarce = MakeRenderGroups(*store_, ranks, std::vector<double>(5, 0.01 * AllBytes()));
  ASSERT_EQ(scarce.size(), 1U);
  EXPECT_EQ(scarce[0].ranks, ranks);
  for (const std::vector<RenderGroup>& groups : {plenty, half, scarce}) {
    for (const RenderGroup& group : groups) {
      ASSERT_EQ(group.owner.size(), static_cast<size_t>(store_->size()));
      for (const int owner : group.owner) EXPECT_LT(owner, static_cast<int>(group.ranks.size()));
    }
  }
}

TEST_F(BlockOwners, MoreOwnersThanBlocks) {
  const std::vector<int> owner = AssignBlocks(*store_, 50);
  std::vector<int> sorted = owner;
  std::sort(sorted.begin(), sorted.end());
  EXPECT_TRUE(std::adjacent_find(sorted.begin(), sorted.end()) == sorted.end()) << "every block has a different owner";
}

}  // namespace
}  // namespace skyquilt::coordinator
