#include "core/trust/evidence.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "core/base/errors.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::trust {
namespace {

// One pixel of each of n photos per metre of a level square about the origin.
std::vector<Sighting> Square(int half_m, int photos, float squared_error) {
  std::vector<Sighting> sightings;
  for (int photo = 0; photo < photos; ++photo) {
    for (int y = -half_m; y < half_m; ++y) {
      for (int x = -half_m; x < half_m; ++x) sightings.push_back({{x + 0.5, y + 0.5, 0.3}, photo, squared_error});
    }
  }
  return sightings;
}

TEST(EvidenceCells, CountPhotosAndAverageErrors) {
  const EvidenceCells cells(Square(10, 7, 0.01F), 1.0);
  EXPECT_EQ(cells.size(), 400U);
  const Evidence inside = cells.At({2.2, -3.7, 0.8});
  EXPECT_TRUE(inside.seen);
  EXPECT_EQ(inside.photos, 7.0F);
  EXPECT_NEAR(inside.log_residual, std::log(0.01F + kLeastError * kLeastError), 1e-4F);
}

TEST(EvidenceCells, FallBackToLargerCellsAndThenToNothing) {
  const EvidenceCells cells(Square(10, 7, 0.01F), 1.0);
  // Above the square: outside its cells of 1 m, inside those of 2 m, and of 4 m.
  EXPECT_EQ(cells.At({0.5, 0.5, 1.5}).photos, 7.0F);
  EXPECT_EQ(cells.At({0.5, 0.5, 3.5}).photos, 7.0F);
  EXPECT_FALSE(cells.At({0.5, 0.5, 4.5}).seen);
  EXPECT_FALSE(cells.At({30.0, 0.0, 0.0}).seen);
  EXPECT_FALSE(cells.At({std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0}).seen);
  EXPECT_FALSE(cells.At({1e12, 0.0, 0.0}).seen);
  EXPECT_FALSE(EvidenceCells().At({0.0, 0.0, 0.0}).seen);
}

TEST(EvidenceCells, OneBadPixelDoesNotSpoilAPlace) {
  std::vector<Sighting> sightings = Square(10, 9, 1e-4F);
  sightings.push_back({{0.5, 0.5, 0.3}, 9, 1.0F});
  const EvidenceCells cells(sightings, 1.0);
  EXPECT_LT(std::exp(cells.At({0.5, 0.5, 0.3}).log_residual), 3e-4F);
}

RC_GTEST_PROP(EvidenceCells, DoNotDependOnTheOrderOfSightings, ()) {
  const int n = *rc::gen::inRange(1, 200);
  std::vector<Sighting> sightings;
  for (int i = 0; i < n; ++i) {
    sightings.push_back({{0.1 * *rc::gen::inRange(-50, 50), 0.1 * *rc::gen::inRange(-50, 50), 0.1 * *rc::gen::inRange(-10, 10)},
                         *rc::gen::inRange(0, 5),
                         0.001F * static_cast<float>(*rc::gen::inRange(0, 1000))});
  }
  std::vector<Sighting> turned(sightings.rbegin(), sightings.rend());
  const EvidenceCells one(sightings, 0.7), other(turned, 0.7);
  RC_ASSERT(one.size() == other.size());
  for (const Sighting& sighting : sightings) {
    const Evidence a = one.At(sighting.place_enu), b = other.At(sighting.place_enu);
    RC_ASSERT(a.seen);
    RC_ASSERT(b.seen);
    RC_ASSERT(a.photos == b.photos);
    RC_ASSERT(a.log_residual == b.log_residual);
    RC_ASSERT(a.photos >= 1.0F);
    RC_ASSERT(a.log_residual <= 0.01F);
  }
}

TEST(EvidenceCells, RefusePlacesThatNoSurveyHas) {
  EXPECT_THROW(EvidenceCells({{{1e9, 0.0, 0.0}, 0, 0.1F}}, 1.0), std::logic_error);
  EXPECT_THROW(EvidenceCells({}, 0.0), std::logic_error);
}

TEST(EvidenceCells, AreTheSameFromAFile) {
  const TemporaryFolder folder;
  std::vector<Sighting> sightings = Square(6, 3, 0.02F);
  for (Sighting& sighting : sightings) sighting.squared_error *= static_cast<float>(1.5 + std::sin(sighting.place_enu.x()));
  const EvidenceCells cells(sightings, 0.5);
  checkpoint::ArchiveWriter writer("trust", 1);
  cells.Put(writer);
  writer.Commit(folder / "cells.h5");
  const checkpoint::ArchiveReader reader(folder / "cells.h5");
  const EvidenceCells again = EvidenceCells::Get(reader, folder / "cells.h5");
  EXPECT_EQ(again.size(), cells.size());
  EXPECT_EQ(again.cell_m(), 0.5);
  for (const Sighting& sighting : sightings) {
    const Evidence before = cells.At(sighting.place_enu), after = again.At(sighting.place_enu);
    ASSERT_EQ(before.seen, after.seen);
    ASSERT_EQ(before.photos, after.photos);
    ASSERT_NEAR(before.log_residual, after.log_residual, 0.03F);  // one byte
  }
}

}  // namespace
}  // namespace skyquilt::trust
