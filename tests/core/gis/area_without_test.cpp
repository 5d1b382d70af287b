#include "core/gis/area_without.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/core/gis/made_rings.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::gis {
namespace {

Ring Box(double west, double south, double east, double north) {
  return {{west, south}, {east, south}, {east, north}, {west, north}};
}

// The file holds what is inside the area and outside of the holes, whatever lies within what.
RC_GTEST_PROP(AreaWithout, IsTheAreaLessTheHoles, (bool georeferenced, bool given)) {
  const TemporaryFolder folder;
  const double east = georeferenced ? 430000.0 : 0.0, north = georeferenced ? 4580000.0 : 0.0;
  const auto box = [&](int low, int high) {
    const double x = *rc::gen::inRange(low, high), y = *rc::gen::inRange(low, high);
    return Box(east + x, north + y, east + x + *rc::gen::inRange(5, 60), north + y + *rc::gen::inRange(5, 60));
  };
  // An area with a yard in it; a lake with an island in it, and a pond apart.
  const Boundary area(Rings{Box(east, north, east + 100, north + 80), Box(east + 30, north + 30, east + 50, north + 50)});
  const Ring lake = box(-20, 80);
  const Eigen::Vector2d low = lake[0], size = lake[2] - lake[0];
  const Boundary holes(Rings{lake, Box(low.x() + 0.3 * size.x(), low.y() + 0.3 * size.y(), low.x() + 0.6 * size.x(), low.y() + 0.6 * size.y()),
                             Box(east + 150, north, east + 160, north + 10)});
  const MapExtent all{{east - 50, north - 50}, {east + 200, north + 200}};
  const std::filesystem::path file = folder / "area.geojson";
  WriteAreaWithout(given ? std::optional(area) : std::nullopt, all, holes, georeferenced, kMade31N, file);
  const Boundary rest = Boundary::Read(file, georeferenced, kMade31N);
  for (double x = -48.7; x < 200.0; x += 7.3) {
    for (double y = -48.3; y < 200.0; y += 7.1) {
      const Eigen::Vector2d at(east + x, north + y);
      RC_ASSERT(rest.Contains(at) == ((!given || area.Contains(at)) && !holes.Contains(at)));
    }
  }
}

TEST(AreaWithout, NothingIsAnError) {
  const TemporaryFolder folder;
  const Boundary area(Rings{Box(0, 0, 10, 10)}), holes(Rings{Box(-1, -1, 11, 11)});
  const std::string error = InputErrorOf([&] { WriteAreaWithout(area, {}, holes, false, {}, folder / "area.geojson"); });
  EXPECT_NE(error.find("masks.ignore_ground"), std::string::npos) << error;
}

}  // namespace
}  // namespace skyquilt::gis
