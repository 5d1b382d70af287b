#include "evaluate/ortho/true_map.h"

#include <gtest/gtest.h>

#include "core/image/srgb.h"
#include "tests/evaluate/ortho/made_map.h"
#include "tests/support/error_of.h"
#include "tests/support/in_temporary_folder.h"

namespace skyquilt::evaluate::ortho {
namespace {

using TrueMapTest = InTemporaryFolder;

TEST_F(TrueMapTest, IsTheSameInTheSameCells) {
  const gis::MapGrid grid = LocalGrid(10.0, 20.0, 0.5, 40, 30);
  WriteColours(
      grid,
      [](double x, double y) {
        return std::array{4.0 * x, 3.0 * y, x < 10.5 ? -1.0 : 7.0};
      },
      folder_ / "truth.tif");
  const MapPart part = TrueMap(folder_ / "truth.tif", grid).Read(-1, 0, 42, 30, Eigen::Vector2d::Zero());
  EXPECT_EQ(*part.known.At(0, 3), 0) << "beyond the map";
  EXPECT_EQ(*part.known.At(41, 3), 0) << "beyond the map";
  ASSERT_EQ(*part.known.At(5, 3), 1);
  const Eigen::Vector2d place = grid.CellCentre(4, 3);
  EXPECT_NEAR(part.rgb.At(5, 3)[0] * 255.0F, std::round(4.0 * place.x()), 1e-3);
  EXPECT_NEAR(part.rgb.At(5, 3)[1] * 255.0F, std::round(3.0 * place.y()), 1e-3);
}

TEST_F(TrueMapTest, InterpolatesInSmallerCellsAndWhereTheMapIsShifted) {
  const gis::MapGrid coarse = LocalGrid(0.0, 20.0, 1.0, 50, 20), fine = LocalGrid(2.0, 18.0, 0.25, 100, 40);
  WriteColours(
      coarse,
      [](double x, double) {
        return std::array{4.0 * (x + 0.5), 100.0, 100.0};
      },
      folder_ / "truth.tif");
  const TrueMap truth(folder_ / "truth.tif", fine);
  for (const double shift_m : {0.0, 0.3, -0.7}) {
    const MapPart part = truth.Read(8, 8, 50, 20, {shift_m, 0.1});
    for (const int x : {0, 7, 49}) {
      ASSERT_EQ(*part.known.At(x, 9), 1);
      EXPECT_NEAR(static_cast<double>(part.rgb.At(x, 9)[0]) * 255.0, 4.0 * (fine.CellCentre(8 + x, 0).x() - shift_m + 0.5), 0.01) << shift_m;
    }
  }
}

TEST_F(TrueMapTest, AveragesLightInLargerCells) {
  const gis::MapGrid fine = LocalGrid(0.0, 6.0, 0.1, 60, 60), coarse = LocalGrid(0.0, 6.0, 0.25, 24, 24);
  // Stripes of cells, black and white in turn.
  WriteColours(
      fine,
      [](double x, double) {
        return std::array{std::lround(x / 0.1 - 0.5) % 2 == 0 ? 0.0 : 255.0, 255.0, x > 5.0 ? 0.0 : 255.0};
      },
      folder_ / "truth.tif");
  const MapPart part = TrueMap(folder_ / "truth.tif", coarse).Read(0, 0, 24, 24, Eigen::Vector2d::Zero());
  // Cells 0, 1 and half of 2; then half of 2, 3 and 4.
  EXPECT_NEAR(part.rgb.At(0, 5)[0], image::SrgbFromLinear(1.0F / 2.5F), 1e-5);
  EXPECT_NEAR(part.rgb.At(1, 5)[0], image::SrgbFromLinear(1.0F / 2.5F), 1e-5);
  EXPECT_NEAR(part.rgb.At(2, 5)[0], image::SrgbFromLinear(1.5F / 2.5F), 1e-5);
  EXPECT_NEAR(part.rgb.At(2, 5)[1], 1.0F, 1e-5);
}

TEST_F(TrueMapTest, RefusesAMapElsewhere) {
  WriteColours(
      LocalGrid(0.0, 5.0, 0.5, 10, 10),
      [](double, double) {
        return std::array{1.0, 1.0, 1.0};
      },
      folder_ / "truth.tif");
  const auto error_with = [&](const gis::MapGrid& grid) { return InputErrorOf([&] { TrueMap(folder_ / "truth.tif", grid); }); };
  EXPECT_EQ(error_with(LocalGrid(4.0, 5.0, 0.5, 10, 10)), "");
  EXPECT_NE(error_with(LocalGrid(5.0, 5.0, 0.5, 10, 10)).find("does not overlap"), std::string::npos);
  gis::MapGrid placed = LocalGrid(0.0, 5.0, 0.5, 10, 10);
  placed.georeferenced = true;
  placed.zone = {32, true};
  EXPECT_NE(error_with(placed).find("zone"), std::string::npos);
}

}  // namespace
}  // namespace skyquilt::evaluate::ortho
