#include "core/geo/geoid.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <numbers>
#include <stdexcept>
#include <string>

#include "core/base/errors.h"
#include "core/geo/proj_handles.h"

namespace skyquilt::geo {

namespace {

constexpr const char* kGrid = "egm96_15.gtx";

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
  // PROJ's objects are for one thread at a time.
  static std::mutex one_at_a_time;
  static std::unique_ptr<GridShift> grid;
  const std::lock_guard lock(one_at_a_time);
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

namespace {

constexpr double kStep_deg = 0.25;
constexpr int kLastRow = 720;                  // at the north pole
constexpr double kMetresPerDegree = 110574.0;  // of latitude at the equator, where a degree is shortest

}  // namespace

GeoidPatch::GeoidPatch(const Geodetic& centre, double radius_m) : middle_longitude_deg_(centre.longitude_deg) {
  if (!IsValid(centre) || !(radius_m >= 0.0)) throw std::invalid_argument("a patch of the geoid without a place");
  const double north_south_deg = std::min(radius_m / kMetresPerDegree, 180.0);
  const double farthest_deg = std::min(std::abs(centre.latitude_deg) + north_south_deg, 90.0);
  // Around a pole all meridians are near.
  const double east_west_deg = std::min(north_south_deg / std::max(std::cos(farthest_deg * std::numbers::pi / 180.0), 1e-9), 180.0);
  const auto step_below = [](double degrees) { return static_cast<int>(std::floor(degrees / kStep_deg)); };
  first_row_ = std::clamp(step_below(centre.latitude_deg - north_south_deg + 90.0), 0, kLastRow - 1);
  rows_ = std::clamp(step_below(centre.latitude_deg + north_south_deg + 90.0) + 1, first_row_ + 1, kLastRow) - first_row_ + 1;
  first_column_ = step_below(middle_longitude_deg_ - east_west_deg + 180.0);
  columns_ = step_below(middle_longitude_deg_ + east_west_deg + 180.0) + 1 - first_column_ + 1;
  node_m_.reserve(static_cast<size_t>(rows_) * static_cast<size_t>(columns_));
  for (int row = first_row_; row < first_row_ + rows_; ++row) {
    for (int column = first_column_; column < first_column_ + columns_; ++column) {
      node_m_.push_back(Egm96Undulation(kStep_deg * row - 90.0, WrapLongitudeDeg(kStep_deg * column - 180.0)));
    }
  }
}

double GeoidPatch::At(double latitude_deg, double longitude_deg) const {
  const double longitude = middle_longitude_deg_ + WrapLongitudeDeg(longitude_deg - middle_longitude_deg_);
  const double y = (latitude_deg + 90.0) / kStep_deg - first_row_, x = (longitude + 180.0) / kStep_deg - first_column_;
  if (!(x >= 0.0 && y >= 0.0 && x <= columns_ - 1 && y <= rows_ - 1)) return Egm96Undulation(latitude_deg, longitude_deg);
  const int column = std::min(static_cast<int>(x), columns_ - 2), row = std::min(static_cast<int>(y), rows_ - 2);
  const double u = x - column, v = y - row;
  const double* node = node_m_.data() + static_cast<size_t>(row) * static_cast<size_t>(columns_) + static_cast<size_t>(column);
  return (1.0 - v) * ((1.0 - u) * node[0] + u * node[1]) + v * ((1.0 - u) * node[columns_] + u * node[columns_ + 1]);
}

}  // namespace skyquilt::geo
