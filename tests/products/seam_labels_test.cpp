#include "products/photo_map/seam_labels.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cstddef>
#include <random>
#include <stdexcept>

namespace skyquilt::products {
namespace {

LabelLattice EmptyLattice(int columns, int rows, int candidates) {
  LabelLattice lattice;
  lattice.columns = columns;
  lattice.rows = rows;
  lattice.candidates = candidates;
  const size_t places = static_cast<size_t>(columns) * static_cast<size_t>(rows) * static_cast<size_t>(candidates);
  lattice.label.assign(places, -1);
  lattice.cost.assign(places, 0.0F);
  lattice.rgb.assign(3 * places, 0.5F);
  return lattice;
}

// Each node has some of the photos, in any order. fewest: candidates per node.
LabelLattice RandomLattice(int columns, int rows, int candidates, int photos, int fewest, uint32_t seed) {
  std::mt19937 random(seed);
  LabelLattice lattice = EmptyLattice(columns, rows, candidates);
  std::vector<int32_t> numbers;
  for (int32_t photo = 0; photo < photos; ++photo) numbers.push_back(photo * 7);
  for (size_t node = 0; node < lattice.label.size(); node += static_cast<size_t>(candidates)) {
    for (size_t i = numbers.size() - 1; i > 0; --i) std::swap(numbers[i], numbers[random() % (i + 1)]);
    const size_t count = static_cast<size_t>(fewest) + random() % static_cast<size_t>(candidates - fewest + 1);
    std::copy_n(numbers.begin(), count, lattice.label.begin() + static_cast<std::ptrdiff_t>(node));
  }
  for (float& cost : lattice.cost) cost = static_cast<float>(random() % 1000) / 1000.0F;
  for (float& value : lattice.rgb) value = static_cast<float>(random() % 1000) / 1000.0F;
  return lattice;
}

std::vector<int8_t> CheapestChoice(const LabelLattice& lattice) {
  std::vector<int8_t> chosen;
  for (size_t first = 0; first < lattice.label.size(); first += static_cast<size_t>(lattice.candidates)) {
    int8_t best = -1;
    for (int8_t k = 0; k < lattice.candidates; ++k) {
      const size_t place = first + static_cast<size_t>(k);
      if (lattice.label[place] >= 0 && (best < 0 || lattice.cost[place] < lattice.cost[first + static_cast<size_t>(best)])) best = k;
    }
    chosen.push_back(best);
  }
  return chosen;
}

TEST(LabelEnergy, IsCostsAndSeams) {
  // Nodes a and b with photos 3 and 4, node c below a with photo 5 only, node d without any.
  LabelLattice lattice = EmptyLattice(2, 2, 2);
  lattice.label = {3, 4, 4, 3, 5, -1, -1, -1};
  lattice.cost = {0.1F, 0.2F, 0.3F, 0.6F, 0.5F, 9.0F, 9.0F, 9.0F};
  lattice.rgb = {0.1F, 0.1F, 0.1F, 0.4F, 0.1F, 0.1F, 0.5F, 0.5F, 0.5F, 0.5F, 0.8F, 0.8F,
                 0.0F, 0.0F, 0.0F, 0.0F, 0.0F, 0.0F, 0.0F, 0.0F, 0.0F, 0.0F, 0.0F, 0.0F};
  const double unknown = 2.0 * (0.02 + 0.25 + 0.25);
  // 3 beside 4: the photos differ by 0.3 in red at a, by 0.3 in green and blue at b.
  EXPECT_NEAR(LabelEnergy(lattice, std::vector<int8_t>{0, 0, 0, -1}, 2.0F), 0.1 + 0.3 + 0.5 + 2.0 * (0.02 + 0.1 + 0.2) + unknown, 1e-6);
  EXPECT_NEAR(LabelEnergy(lattice, std::vector<int8_t>{1, 0, 0, -1}, 2.0F), 0.2 + 0.3 + 0.5 + unknown, 1e-6);
  EXPECT_EQ(ChooseLabels(lattice, 2.0F), (std::vector<int8_t>{1, 0, 0, -1}));
  EXPECT_EQ(ChooseLabels(lattice, 0.0F), (std::vector<int8_t>{0, 0, 0, -1}));
  EXPECT_THROW(LabelEnergy(lattice, std::vector<int8_t>{0, 0, 0}, 2.0F), std::logic_error);
  EXPECT_THROW(LabelEnergy(lattice, std::vector<int8_t>{0, 0, 1, -1}, 2.0F), std::logic_error);
  lattice.cost.pop_back();
  EXPECT_THROW(ChooseLabels(lattice, 2.0F), std::logic_error);
}

RC_GTEST_PROP(ChooseLabels, IsNeverWorseThanTheCheapest, ()) {
  const int candidates = *rc::gen::inRange(1, 9);
  const LabelLattice lattice =
      RandomLattice(*rc::gen::inRange(1, 9), *rc::gen::inRange(1, 9), candidates, candidates + 2, 0, *rc::gen::arbitrary<uint32_t>());
  const float smoothness = static_cast<float>(*rc::gen::inRange(0, 400)) / 100.0F;
  const std::vector<int8_t> chosen = ChooseLabels(lattice, smoothness, *rc::gen::inRange(0, 13));
  const std::vector<int8_t> cheapest = CheapestChoice(lattice);
  RC_ASSERT(chosen.size() == cheapest.size());
  for (size_t node = 0; node < chosen.size(); ++node) RC_ASSERT((chosen[node] < 0) == (cheapest[node] < 0));
  RC_ASSERT(LabelEnergy(lattice, chosen, smoothness) <= LabelEnergy(lattice, cheapest, smoothness) + 1e-9);
}

TEST(ChooseLabels, IsNearTheBestOfAll) {
  int near = 0;
  const int tries = 200;
  for (int i = 0; i < tries; ++i) {
    const LabelLattice lattice = RandomLattice(3, 3, 2, 3, 2, static_cast<uint32_t>(i));
    const float smoothness = 0.05F + 0.01F * static_cast<float>(i % 100);
    double best = 1e9;
    std::vector<int8_t> chosen(9);
    for (unsigned choice = 0; choice < 512; ++choice) {
      for (unsigned node = 0; node < 9; ++node) chosen[node] = static_cast<int8_t>(choice >> node & 1U);
      best = std::min(best, LabelEnergy(lattice, chosen, smoothness));
    }
    const double found = LabelEnergy(lattice, ChooseLabels(lattice, smoothness), smoothness);
    ASSERT_GE(found, best - 1e-9);
    if (found <= 1.05 * best) ++near;
  }
  EXPECT_GE(near, tries * 95 / 100);
}

TEST(ChooseLabels, LeadsSeamsAroundWhatMoves) {
  // Photo 0 is cheap on the left, photo 1 on the right; photo 1 shows something bright across the middle.
  const int size = 14;
  LabelLattice lattice = EmptyLattice(size, size, 2);
  const auto moves = [](int column, int row) { return column >= 6 && column < 10 && row >= 4 && row < 9; };
  for (int row = 0; row < size; ++row) {
    for (int column = 0; column < size; ++column) {
      const size_t first = static_cast<size_t>(2 * (row * size + column));
      lattice.label[first] = 0;
      lattice.label[first + 1] = 1;
      lattice.cost[first] = 0.03F * static_cast<float>(column);
      lattice.cost[first + 1] = 0.03F * static_cast<float>(size - 1 - column);
      if (moves(column, row)) std::fill_n(lattice.rgb.begin() + static_cast<std::ptrdiff_t>(3 * (first + 1)), 3, 1.0F);
    }
  }
  const std::vector<int8_t> chosen = ChooseLabels(lattice, 1.0F);
  const auto photo = [&](int column, int row) { return chosen[static_cast<size_t>(row * size + column)]; };
  for (int row = 0; row < size; ++row) {
    EXPECT_EQ(photo(0, row), 0);
    EXPECT_EQ(photo(size - 1, row), 1);
    for (int column = 0; column < size; ++column) {
      if (!moves(column, row)) continue;
      EXPECT_EQ(photo(column, row), photo(column - 1, row)) << column << " " << row;
      EXPECT_EQ(photo(column, row), photo(column + 1, row)) << column << " " << row;
      EXPECT_EQ(photo(column, row), photo(column, row - 1)) << column << " " << row;
      EXPECT_EQ(photo(column, row), photo(column, row + 1)) << column << " " << row;
    }
  }
}

TEST(ChooseLabels, TakesNothingWhereThereIsNothing) {
  EXPECT_TRUE(ChooseLabels(EmptyLattice(0, 0, 3), 1.0F).empty());
  EXPECT_EQ(ChooseLabels(EmptyLattice(2, 1, 3), 1.0F), (std::vector<int8_t>{-1, -1}));
  EXPECT_THROW(ChooseLabels(EmptyLattice(2, 1, 9), 1.0F), std::logic_error);
}

}  // namespace
}  // namespace skyquilt::products
