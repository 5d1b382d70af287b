#include "core/geo/geoid.h"

#include <cmath>
#include <memory>
#include <numbers>
#include <stdexcept>
#include <string>

#include "core/base/errors.h"
#include "core/geo/geodetic.h"
#include "core/geo/proj_handles.h"

namespace skyquilt::geo {
namespace {

constexpr const char* kGrid = "egm96_15.gtx";

// PROJ's objects must not be shared between threads.
struct GridShift {
  ProjContext context = QuietProjContext();
  ProjObject shift;
  GridShift() {
    // multiplier 1: adds the undulation to the height.
    std::string definition = "+proj=vgridshift +multiplier=1 +grids=";
    definition += kGrid;
    shift.reset(proj_create(context.get(), definition.c_str()));
  }
};

[[noreturn]] void FailWithoutGrid() {
  throw base::InputError(kGrid, "PROJ does not find this grid of the geoid EGM96",
                         "Install it (Debian: apt-get install proj-data), or set PROJ_DATA to the folder that holds it");
}

}  // namespace

double Egm96Undulation(double latitude_deg, double longitude_deg) {
  if (!IsValid({latitude_deg, longitude_deg, 0.0}))
    throw std::invalid_argument("a geoid height needs finite coordinates and a latitude in [-90, 90]");
  static thread_local std::unique_ptr<GridShift> grid;
  if (!grid) grid = std::make_unique<GridShift>();
  if (!grid->shift) {
    grid.reset();
    FailWithoutGrid();
  }
  constexpr double kRadians = std::numbers::pi / 180.0;
  proj_errno_reset(grid->shift.get());
  const PJ_COORD to =
      proj_trans(grid->shift.get(), PJ_FWD, proj_coord(kRadians * WrapLongitudeDeg(longitude_deg), kRadians * latitude_deg, 0.0, 0.0));
  // A grid that was not found is noticed only when it is used.
  if (proj_errno(grid->shift.get()) != 0 || !std::isfinite(to.v[2]) || to.v[2] == 0.0) {
    grid.reset();
    FailWithoutGrid();
  }
  return to.v[2];
}

}  // namespace skyquilt::geo
