#include "core/geo/enu_frame.h"

#include <GeographicLib/LocalCartesian.hpp>
#include <stdexcept>

namespace skyquilt::geo {

struct EnuFrame::Impl {
  GeographicLib::LocalCartesian local;
};

EnuFrame::EnuFrame(const Geodetic& origin) : origin_(origin) {
  if (!IsValid(origin)) throw std::invalid_argument("the origin of an ENU frame needs finite coordinates and a latitude in [-90, 90]");
  origin_.longitude_deg = WrapLongitudeDeg(origin.longitude_deg);
  impl_ = std::make_unique<Impl>();
  impl_->local.Reset(origin_.latitude_deg, origin_.longitude_deg, origin_.height_m);
}

EnuFrame::~EnuFrame() = default;
EnuFrame::EnuFrame(EnuFrame&&) noexcept = default;
EnuFrame& EnuFrame::operator=(EnuFrame&&) noexcept = default;

Eigen::Vector3d EnuFrame::EnuFromGeodetic(const Geodetic& position) const {
  Eigen::Vector3d x;
  impl_->local.Forward(position.latitude_deg, position.longitude_deg, position.height_m, x.x(), x.y(), x.z());
  return x;
}

Geodetic EnuFrame::GeodeticFromEnu(const Eigen::Vector3d& x_in_enu) const {
  Geodetic position;
  impl_->local.Reverse(x_in_enu.x(), x_in_enu.y(), x_in_enu.z(), position.latitude_deg, position.longitude_deg, position.height_m);
  position.longitude_deg = WrapLongitudeDeg(position.longitude_deg);
  return position;
}

}  // namespace skyquilt::geo
