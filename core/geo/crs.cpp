#include "core/geo/crs.h"

#include <proj.h>

#include <regex>
#include <stdexcept>

namespace skyquilt::geo {
namespace {

struct FreeContext {
  void operator()(PJ_CONTEXT* context) const { proj_context_destroy(context); }
};
struct FreeTransformation {
  void operator()(PJ* transformation) const { proj_destroy(transformation); }
};

// "WGS84 UTM 32N" as its EPSG code.
std::string Resolved(const std::string& definition) {
  static const std::regex kUtm("\\s*WGS\\s?84[\\s/]+UTM\\s+(?:zone\\s+)?(\\d{1,2})\\s*([NSns])\\s*", std::regex::icase);
  // Long definitions are WKT, which the expression need not see.
  std::smatch match;
  if (definition.size() > 64 || !std::regex_match(definition, match, kUtm)) return definition;
  const int zone = std::stoi(match[1]);
  if (zone < 1 || zone > 60) throw std::invalid_argument("UTM has zones 1 to 60");
  const bool south = match[2] == "S" || match[2] == "s";
  return "EPSG:" + std::to_string((south ? 32700 : 32600) + zone);
}

std::string ReasonOf(PJ_CONTEXT* context) {
  const int code = proj_context_errno(context);
  const char* const reason = code == 0 ? nullptr : proj_context_errno_string(context, code);
  return reason == nullptr ? "PROJ does not know it" : reason;
}

}  // namespace

struct Crs::Impl {
  std::unique_ptr<PJ_CONTEXT, FreeContext> context;
  std::unique_ptr<PJ, FreeTransformation> wgs84_from_crs;
  bool east_north = true;
};

Crs::Crs(const std::string& definition, AxisOrder order) : impl_(std::make_unique<Impl>()) {
  const std::string resolved = Resolved(definition);
  impl_->context.reset(proj_context_create());
  PJ_CONTEXT* const context = impl_->context.get();
  proj_log_level(context, PJ_LOG_NONE);
  PJ* transformation = proj_create_crs_to_crs(context, resolved.c_str(), "EPSG:4979", nullptr);
  if (transformation == nullptr) throw std::invalid_argument(ReasonOf(context));
  impl_->wgs84_from_crs.reset(transformation);
  // Longitude comes before latitude in a normalized transformation, on both sides.
  if (order == AxisOrder::kEastNorth) {
    transformation = proj_normalize_for_visualization(context, transformation);
    if (transformation == nullptr) throw std::invalid_argument(ReasonOf(context));
    impl_->wgs84_from_crs.reset(transformation);
  }
  impl_->east_north = order == AxisOrder::kEastNorth;
}

Crs::~Crs() = default;
Crs::Crs(Crs&&) noexcept = default;
Crs& Crs::operator=(Crs&&) noexcept = default;

Geodetic Crs::ToGeodetic(const Eigen::Vector3d& x_in_crs) const {
  PJ* const transformation = impl_->wgs84_from_crs.get();
  proj_errno_reset(transformation);
  const PJ_COORD to = proj_trans(transformation, PJ_FWD, proj_coord(x_in_crs.x(), x_in_crs.y(), x_in_crs.z(), 0.0));
  const double latitude_deg = impl_->east_north ? to.v[1] : to.v[0];
  const double longitude_deg = impl_->east_north ? to.v[0] : to.v[1];
  const Geodetic position{latitude_deg, longitude_deg, to.v[2]};
  if (proj_errno(transformation) != 0 || !IsValid(position)) throw std::invalid_argument("the position is outside this coordinate system");
  return {latitude_deg, WrapLongitudeDeg(longitude_deg), position.height_m};
}

}  // namespace skyquilt::geo
