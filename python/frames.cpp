#include "python/frames.h"

#include <algorithm>
#include <functional>
#include <limits>

#include "core/base/errors.h"

namespace skyquilt::python {
namespace {

constexpr size_t kEach = 4096;  // places of one task

const Eigen::Vector3d kNowhere = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());

void ForEach(std::span<const Eigen::Vector3d> in, std::span<Eigen::Vector3d> out, base::ThreadPool& threads,
             const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& convert) {
  threads.ParallelFor(static_cast<int64_t>((in.size() + kEach - 1) / kEach), [&](int64_t task, int) {
    const size_t begin = static_cast<size_t>(task) * kEach;
    for (size_t i = begin; i < std::min(in.size(), begin + kEach); ++i) out[i] = in[i].allFinite() ? convert(in[i]) : kNowhere;
  });
}

}  // namespace

Frame FrameNamed(const std::string& name) {
  if (name == "enu") return Frame::kEnu;
  if (name == "utm") return Frame::kUtm;
  if (name == "wgs84") return Frame::kWgs84;
  throw base::UsageError("the frame '" + name + "' is not known: give 'enu', 'utm' or 'wgs84'");
}

Places::Places(const geo::Geodetic& origin, bool georeferenced) {
  if (!georeferenced) return;
  enu_.emplace(origin);
  zone_ = geo::UtmZoneOf(origin);
}

void Places::Require(Frame frame) const {
  if (frame == Frame::kEnu || enu_) return;
  throw base::UsageError("this survey has no place on Earth, only a local frame: give places as frame='enu'");
}

Eigen::Vector3d Places::EnuOf(Frame from, const Eigen::Vector3d& x) const {
  if (from == Frame::kEnu) return x;
  if (from == Frame::kUtm) {
    try {
      return enu_->EnuFromGeodetic(geo::GeodeticFromUtm(x.head<2>(), x.z(), *zone_));
    } catch (const std::exception&) {  // far outside of what the zone can express
      return kNowhere;
    }
  }
  const geo::Geodetic place{.latitude_deg = x.y(), .longitude_deg = x.x(), .height_m = x.z()};
  return geo::IsValid(place) ? enu_->EnuFromGeodetic(place) : kNowhere;
}

Eigen::Vector3d Places::FrameOf(Frame to, const Eigen::Vector3d& x_in_enu) const {
  if (to == Frame::kEnu) return x_in_enu;
  const geo::Geodetic place = enu_->GeodeticFromEnu(x_in_enu);
  if (to == Frame::kWgs84) return {place.longitude_deg, place.latitude_deg, place.height_m};
  const Eigen::Vector2d map = geo::UtmFromGeodetic(place, *zone_);
  return {map.x(), map.y(), place.height_m};
}

void Places::ToEnu(Frame from, std::span<const Eigen::Vector3d> in, std::span<Eigen::Vector3d> out, base::ThreadPool& threads) const {
  Require(from);
  ForEach(in, out, threads, [&](const Eigen::Vector3d& x) { return EnuOf(from, x); });
}

void Places::FromEnu(Frame to, std::span<const Eigen::Vector3d> in, std::span<Eigen::Vector3d> out, base::ThreadPool& threads) const {
  Require(to);
  ForEach(in, out, threads, [&](const Eigen::Vector3d& x) { return FrameOf(to, x); });
}

Eigen::Vector2d Places::EastingNorthing(Frame from, const Eigen::Vector2d& place) const {
  Require(from);
  if (from != Frame::kWgs84) return place;
  return geo::UtmFromGeodetic({.latitude_deg = place.y(), .longitude_deg = place.x(), .height_m = 0.0}, *zone_);
}

}  // namespace skyquilt::python
