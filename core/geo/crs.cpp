#include "core/geo/crs.h"

#include <proj_experimental.h>

#include <cmath>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "core/base/pattern.h"
#include "core/geo/proj_handles.h"

namespace skyquilt::geo {
namespace {

// "WGS84 UTM 32N" as its EPSG code.
std::string Resolved(const std::string& definition) {
  constexpr const char* kUtm = "\\s*WGS\\s?84[\\s/]+UTM\\s+(?:zone\\s+)?(\\d{1,2})\\s*([NSns])\\s*";
  // Long definitions are WKT, which the expression need not see.
  const auto match = definition.size() <= 64 ? base::MatchWhole(definition, kUtm, true) : std::nullopt;
  if (match) {
    const int zone = std::stoi((*match)[1]);
    if (zone < 1 || zone > 60) throw std::invalid_argument("UTM has zones 1 to 60");
    const bool south = (*match)[2] == "S" || (*match)[2] == "s";
    return "EPSG:" + std::to_string((south ? 32700 : 32600) + zone);
  }
  // PROJ takes a string without this for an operation.
  const bool is_proj_string = definition.find("proj=") != std::string::npos || definition.find("init=") != std::string::npos;
  return is_proj_string && definition.find("type=crs") == std::string::npos ? definition + " +type=crs" : definition;
}

std::string ReasonOf(PJ_CONTEXT* context) {
  const int code = proj_context_errno(context);
  const char* const reason = code == 0 ? nullptr : proj_context_errno_string(context, code);
  return reason == nullptr ? "PROJ does not know it" : reason;
}

// The system inside those that carry a transformation (+towgs84, +geoidgrids).
ProjObject Unbound(PJ_CONTEXT* context, const PJ* crs) {
  ProjObject inner(proj_clone(context, crs));
  while (inner && proj_get_type(inner.get()) == PJ_TYPE_BOUND_CRS) inner.reset(proj_get_source_crs(context, inner.get()));
  return inner;
}

// What the axis of a single system says, from 0.
CrsPart PartOf(PJ_CONTEXT* context, const PJ* crs, int axis) {
  CrsPart part;
  const char* const name = proj_get_name(crs);
  part.name = name == nullptr ? "unknown" : name;
  const ProjObject axes(proj_crs_get_coordinate_system(context, crs));
  const char* direction = nullptr;
  const char* unit = nullptr;
  double factor = 0.0;
  if (!axes || proj_cs_get_axis_info(context, axes.get(), axis, nullptr, nullptr, &direction, &factor, &unit, nullptr, nullptr) == 0) return part;
  part.unit = unit == nullptr ? "" : unit;
  const PJ_COORDINATE_SYSTEM_TYPE type = proj_cs_get_type(context, axes.get());
  const bool angle = type == PJ_CS_TYPE_ELLIPSOIDAL && axis < 2;
  part.unit_m = angle ? 0.0 : factor;
  return part;
}

int AxesOf(PJ_CONTEXT* context, const PJ* crs) {
  const ProjObject axes(proj_crs_get_coordinate_system(context, crs));
  return axes ? proj_cs_get_axis_count(context, axes.get()) : 0;
}

// The name of the operation says when heights above a geoid are passed on as ellipsoidal ones.
bool IsVerticalGuess(PJ* operation) {
  const char* const description = operation == nullptr ? nullptr : proj_pj_info(operation).description;
  return description != nullptr && std::string_view(description).find("ballpark vertical") != std::string_view::npos;
}

}  // namespace

struct Crs::Impl {
  ProjContext context;
  ProjObject crs;
  ProjObject wgs84_from_crs;
  AxisOrder order = AxisOrder::kEastNorth;
  std::string name;
  CrsPart horizontal, vertical;
  CrsHeights heights = CrsHeights::kNone;
  bool geographic = false;
  bool geocentric = false;

  // Takes the system, whose context it must be.
  Impl(ProjContext its_context, ProjObject its_crs, AxisOrder its_order)
      : context(std::move(its_context)), crs(std::move(its_crs)), order(its_order) {
    PJ_CONTEXT* const c = context.get();
    if (!crs || proj_is_crs(crs.get()) == 0) throw std::invalid_argument(crs ? "it is not a coordinate system" : ReasonOf(c));
    const ProjObject wgs84(proj_create(c, "EPSG:4979"));
    if (!wgs84) throw std::invalid_argument("PROJ does not find its database proj.db");
    wgs84_from_crs.reset(proj_create_crs_to_crs_from_pj(c, crs.get(), wgs84.get(), nullptr, nullptr));
    // Longitude comes before latitude in a normalized transformation, on both sides.
    if (wgs84_from_crs && order == AxisOrder::kEastNorth) wgs84_from_crs.reset(proj_normalize_for_visualization(c, wgs84_from_crs.get()));
    if (!wgs84_from_crs) throw std::invalid_argument(ReasonOf(c));
    Describe();
  }

  void Describe() {
    PJ_CONTEXT* const c = context.get();
    const char* const text = proj_get_name(crs.get());
    name = text == nullptr ? "unknown" : text;
    ProjObject base = Unbound(c, crs.get());
    if (!base) return;
    if (proj_get_type(base.get()) == PJ_TYPE_COMPOUND_CRS) {
      if (const ProjObject up = ProjObject(proj_crs_get_sub_crs(c, base.get(), 1))) {
        vertical = PartOf(c, Unbound(c, up.get()).get(), 0);
        heights = CrsHeights::kGravity;
      }
      const ProjObject plane(proj_crs_get_sub_crs(c, base.get(), 0));
      base = plane ? Unbound(c, plane.get()) : nullptr;
      if (!base) return;
    }
    horizontal = PartOf(c, base.get(), 0);
    const PJ_TYPE type = proj_get_type(base.get());
    geographic = type == PJ_TYPE_GEOGRAPHIC_2D_CRS || type == PJ_TYPE_GEOGRAPHIC_3D_CRS;
    geocentric = type == PJ_TYPE_GEOCENTRIC_CRS;
    if (heights == CrsHeights::kNone && AxesOf(c, base.get()) > 2) {
      vertical = PartOf(c, base.get(), 2);
      vertical.name = "ellipsoid";
      heights = CrsHeights::kEllipsoidal;
    }
  }

  // Throws std::invalid_argument when the result is not finite, or is the height as it came in where a geoid lies between.
  PJ_COORD Transform(PJ_DIRECTION direction, const PJ_COORD& from) const {
    PJ* const transformation = wgs84_from_crs.get();
    proj_errno_reset(transformation);
    const PJ_COORD to = proj_trans(transformation, direction, from);
    const bool finite = std::isfinite(to.v[0]) && std::isfinite(to.v[1]) && std::isfinite(to.v[2]);
    if (proj_errno(transformation) != 0 || !finite) {
      if (heights == CrsHeights::kGravity && PlaneWorks(direction, from)) throw std::invalid_argument(NoGrid());
      throw std::invalid_argument("the position is outside this coordinate system");
    }
    // A geoid is nowhere exactly at the ellipsoid.
    const double from_m = from.v[2] * (direction == PJ_FWD ? vertical.unit_m : 1.0);
    const double to_m = to.v[2] * (direction == PJ_FWD ? 1.0 : vertical.unit_m);
    if (heights == CrsHeights::kGravity && (std::abs(to_m - from_m) < 1e-9 || IsVerticalGuess(LastUsed().get()))) {
      throw std::invalid_argument(NoGrid());
    }
    return to;
  }

  ProjObject LastUsed() const { return ProjObject(proj_trans_get_last_used_operation(wgs84_from_crs.get())); }

  // Whether the position is good apart from its height.
  bool PlaneWorks(PJ_DIRECTION direction, const PJ_COORD& from) const {
    try {
      Plane()->Transform(direction, from);
      return true;
    } catch (const std::invalid_argument&) {
      return false;
    }
  }

  std::string NoGrid() const {
    return "PROJ has no grid here for heights of '" + vertical.name + "' and would take them for heights above the ellipsoid";
  }

  std::unique_ptr<Impl> Plane() const {
    if (geocentric) throw std::invalid_argument("a geocentric system has no heights that could be left out");
    ProjContext own = QuietProjContext();
    PJ_CONTEXT* const c = own.get();
    ProjObject plane(proj_clone(c, crs.get()));
    if (heights == CrsHeights::kGravity) {
      plane = Unbound(c, plane.get());
      if (plane) plane.reset(proj_crs_get_sub_crs(c, plane.get(), 0));
    } else if (heights == CrsHeights::kEllipsoidal) {
      plane.reset(proj_crs_demote_to_2D(c, nullptr, plane.get()));
    }
    return std::make_unique<Impl>(std::move(own), std::move(plane), order);
  }
};

Crs::Crs(const std::string& definition, AxisOrder order) {
  ProjContext context = QuietProjContext();
  ProjObject crs(proj_create(context.get(), Resolved(definition).c_str()));
  impl_ = std::make_unique<Impl>(std::move(context), std::move(crs), order);
}

Crs::Crs(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

Crs::~Crs() = default;
Crs::Crs(Crs&&) noexcept = default;
Crs& Crs::operator=(Crs&&) noexcept = default;

const std::string& Crs::name() const {
  return impl_->name;
}

const CrsPart& Crs::horizontal() const {
  return impl_->horizontal;
}

const CrsPart& Crs::vertical() const {
  return impl_->vertical;
}

CrsHeights Crs::heights() const {
  return impl_->heights;
}

bool Crs::IsGeographic() const {
  return impl_->geographic;
}

Crs Crs::WithoutHeights() const {
  return Crs(impl_->Plane());
}

Geodetic Crs::ToGeodetic(const Eigen::Vector3d& x_in_crs) const {
  const PJ_COORD to = impl_->Transform(PJ_FWD, proj_coord(x_in_crs.x(), x_in_crs.y(), x_in_crs.z(), 0.0));
  const bool east_north = impl_->order == AxisOrder::kEastNorth;
  const Geodetic position{east_north ? to.v[1] : to.v[0], east_north ? to.v[0] : to.v[1], to.v[2]};
  if (!IsValid(position)) throw std::invalid_argument("the position is outside this coordinate system");
  return {position.latitude_deg, WrapLongitudeDeg(position.longitude_deg), position.height_m};
}

Eigen::Vector3d Crs::FromGeodetic(const Geodetic& position) const {
  if (!IsValid(position)) throw std::invalid_argument("the position is not valid");
  const bool east_north = impl_->order == AxisOrder::kEastNorth;
  const double first = east_north ? position.longitude_deg : position.latitude_deg;
  const double second = east_north ? position.latitude_deg : position.longitude_deg;
  const PJ_COORD once = impl_->Transform(PJ_INV, proj_coord(first, second, position.height_m, 0.0));
  // The inverse of a change of datum may be off by a millimetre, as its formulas are approximate; a step of correction removes that.
  const PJ_COORD back = impl_->Transform(PJ_FWD, once);
  const PJ_COORD to =
      impl_->Transform(PJ_INV, proj_coord(first - std::remainder(back.v[0] - first, 360.0), second - std::remainder(back.v[1] - second, 360.0),
                                          2.0 * position.height_m - back.v[2], 0.0));
  return {to.v[0], to.v[1], to.v[2]};
}

bool Crs::IsDatumGuessed(const Eigen::Vector3d& x_in_crs) const {
  impl_->Transform(PJ_FWD, proj_coord(x_in_crs.x(), x_in_crs.y(), x_in_crs.z(), 0.0));
  const ProjObject used = impl_->LastUsed();
  return used && proj_coordoperation_has_ballpark_transformation(impl_->context.get(), used.get()) != 0;
}

}  // namespace skyquilt::geo
