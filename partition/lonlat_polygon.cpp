#include "partition/lonlat_polygon.h"

#include <algorithm>
#include <cmath>

#include "core/base/errors.h"
#include "core/geo/geodetic.h"

namespace skyquilt::partition {
namespace {

// The longitude nearest to `near` among longitude + 360 k.
double UnwrapNear(double longitude, double near) {
  return longitude - 360.0 * std::round((longitude - near) / 360.0);
}

// The part of a ring with sign * x <= sign * limit (Sutherland and Hodgman 1974). The ring is not closed and need not be convex.
std::vector<Eigen::Vector2d> Clip(const std::vector<Eigen::Vector2d>& ring, double limit, double sign) {
  std::vector<Eigen::Vector2d> kept;
  for (size_t i = 0; i < ring.size(); ++i) {
    const Eigen::Vector2d& a = ring[i];
    const Eigen::Vector2d& b = ring[(i + 1) % ring.size()];
    const double inside_a = sign * (limit - a.x());
    const double inside_b = sign * (limit - b.x());
    if (inside_a >= 0.0) kept.push_back(a);
    if ((inside_a > 0.0 && inside_b < 0.0) || (inside_a < 0.0 && inside_b > 0.0)) {
      const double share = inside_a / (inside_a - inside_b);
      kept.emplace_back(limit, a.y() + share * (b.y() - a.y()));
    }
  }
  return kept;
}

double SignedArea(const std::vector<Eigen::Vector2d>& ring) {
  double twice = 0.0;
  for (size_t i = 0; i < ring.size(); ++i) {
    // Relative to the first corner: with large longitudes the products would round away the area of a small block.
    const Eigen::Vector2d a = ring[i] - ring[0];
    const Eigen::Vector2d b = ring[(i + 1) % ring.size()] - ring[0];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return 0.5 * twice;
}

Ring Close(std::vector<Eigen::Vector2d> ring) {
  if (SignedArea(ring) < 0.0) std::reverse(ring.begin(), ring.end());
  ring.push_back(ring.front());
  return ring;
}

// `ring` runs once around the pole: cut it at the date line and join the ends along the pole.
LonLatOutline PolarCap(std::vector<Eigen::Vector2d> ring, double pole) {
  for (Eigen::Vector2d& x : ring) x.x() = geo::WrapLongitudeDeg(x.x());
  std::sort(ring.begin(), ring.end(), [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() < b.x(); });
  const Eigen::Vector2d& first = ring.front();
  const Eigen::Vector2d& last = ring.back();
  const double gap = first.x() + 360.0 - last.x();
  const double seam = gap > 0.0 ? last.y() + (first.y() - last.y()) * (180.0 - last.x()) / gap : first.y();
  std::vector<Eigen::Vector2d> cap;
  cap.emplace_back(-180.0, seam);
  for (const Eigen::Vector2d& x : ring) {
    if (x.x() > -180.0) cap.push_back(x);
  }
  cap.emplace_back(180.0, seam);
  cap.emplace_back(180.0, pole);
  cap.emplace_back(-180.0, pole);
  LonLatOutline outline;
  double lowest = seam;
  for (const Eigen::Vector2d& x : ring) lowest = pole > 0.0 ? std::min(lowest, x.y()) : std::max(lowest, x.y());
  outline.parts.push_back(Close(std::move(cap)));
  outline.west_deg = -180.0;
  outline.east_deg = 180.0;
  outline.south_deg = std::min(lowest, pole);
  outline.north_deg = std::max(lowest, pole);
  return outline;
}

}  // namespace

LonLatOutline MakeOutline(const std::vector<Eigen::Vector2d>& corners) {
  SKYQUILT_CHECK(corners.size() >= 3, std::to_string(corners.size()));
  std::vector<Eigen::Vector2d> ring = corners;
  for (size_t i = 1; i < ring.size(); ++i) ring[i].x() = UnwrapNear(ring[i].x(), ring[i - 1].x());
  const double turn = UnwrapNear(ring.front().x(), ring.back().x()) - ring.front().x();
  const double pole = ring.front().y() > 0.0 ? 90.0 : -90.0;
  if (std::abs(turn) > 180.0) return PolarCap(std::move(ring), pole);

  LonLatOutline outline;
  double west = ring.front().x();
  double east = west;
  outline.south_deg = outline.north_deg = ring.front().y();
  for (const Eigen::Vector2d& x : ring) {
    west = std::min(west, x.x());
    east = std::max(east, x.x());
    outline.south_deg = std::min(outline.south_deg, x.y());
    outline.north_deg = std::max(outline.north_deg, x.y());
  }
  for (int k = -2; k <= 2; ++k) {
    const double low = -180.0 + 360.0 * k;
    const double high = low + 360.0;
    if (east <= low || west >= high) continue;
    std::vector<Eigen::Vector2d> part = west >= low && east <= high ? ring : Clip(Clip(ring, high, 1.0), low, -1.0);
    for (Eigen::Vector2d& x : part) x.x() -= 360.0 * k;
    outline.parts.push_back(Close(std::move(part)));
  }
  const bool crosses = outline.parts.size() > 1;
  outline.west_deg = geo::WrapLongitudeDeg(west);
  // The eastern end of an outline that only touches the date line is 180, not -180.
  outline.east_deg = crosses ? geo::WrapLongitudeDeg(east) : outline.west_deg + (east - west);
  return outline;
}

}  // namespace skyquilt::partition
