#include "buildings/building.h"

#include <algorithm>
#include <cmath>

#include "core/base/errors.h"

namespace skyquilt::buildings {
namespace {

bool Covers(const Eigen::Vector2d& low, const Eigen::Vector2d& high, const Eigen::Vector2d& uv) {
  return (uv.array() >= low.array()).all() && (uv.array() <= high.array()).all();
}

// The part whose roof this one's runs into; null: none.
const Part* HostOf(const Shape& shape, const Part& part) {
  if (part.roof != RoofKind::kGable || part.joins < 0 || static_cast<size_t>(part.joins) >= shape.parts.size()) return nullptr;
  const Part& host = shape.parts[static_cast<size_t>(part.joins)];
  return &host == &part ? nullptr : &host;
}

// Corners of the walls, extended along the ridge up to the middle of the host when asked.
struct Box {
  Eigen::Vector2d low, high;
};
Box BoxOf(const Shape& shape, const Part& part, bool roof) {
  const auto line = [](const std::vector<double>& lines, int i) { return lines[static_cast<size_t>(i)]; };
  Box box{{line(shape.u, part.u0), line(shape.v, part.v0)}, {line(shape.u, part.u1), line(shape.v, part.v1)}};
  const Part* host = roof ? HostOf(shape, part) : nullptr;
  if (host == nullptr) return box;
  const Box beside = BoxOf(shape, *host, false);
  const int axis = part.along_u ? 0 : 1;
  const double middle = 0.5 * (beside.low[axis] + beside.high[axis]);
  if (middle > 0.5 * (box.low[axis] + box.high[axis])) {
    box.high[axis] = std::max(box.high[axis], middle);
  } else {
    box.low[axis] = std::min(box.low[axis], middle);
  }
  return box;
}

}  // namespace

const char* NameOf(RoofKind roof) {
  switch (roof) {
    case RoofKind::kFlat:
      return "flat";
    case RoofKind::kGable:
      return "gable";
    case RoofKind::kHip:
      return "hip";
    case RoofKind::kOther:
      return "other";
  }
  return "";
}

RoofKind RoofNamed(const std::string& name) {
  for (const RoofKind roof : {RoofKind::kFlat, RoofKind::kGable, RoofKind::kHip, RoofKind::kOther}) {
    if (name == NameOf(roof)) return roof;
  }
  throw base::UsageError("'" + name + "' is no kind of roof: it must be flat, gable, hip or other");
}

Eigen::Vector2d Shape::AxisU() const {
  return {std::cos(yaw_rad), std::sin(yaw_rad)};
}

Eigen::Vector2d Shape::AxisV() const {
  return {-std::sin(yaw_rad), std::cos(yaw_rad)};
}

Eigen::Vector2d Shape::EnuFrom(const Eigen::Vector2d& uv) const {
  return origin + uv.x() * AxisU() + uv.y() * AxisV();
}

Eigen::Vector2d Shape::FromEnu(const Eigen::Vector2d& enu) const {
  return {AxisU().dot(enu - origin), AxisV().dot(enu - origin)};
}

Eigen::Vector2d Shape::MinOf(const Part& part, bool roof) const {
  return BoxOf(*this, part, roof).low;
}

Eigen::Vector2d Shape::MaxOf(const Part& part, bool roof) const {
  return BoxOf(*this, part, roof).high;
}

double RoofHeight(const Shape& shape, const Part& part, const Eigen::Vector2d& uv) {
  if (part.roof == RoofKind::kFlat || part.roof == RoofKind::kOther) return part.eave_z;
  const Box walls = BoxOf(shape, part, false);
  // Distances into the building from the nearer wall of each pair, and the distance at which the ridge is reached.
  const Eigen::Array2d inside = (uv - walls.low).cwiseMin(walls.high - uv).array();
  const Eigen::Array2d half = 0.5 * (walls.high - walls.low).array();
  const int across = part.along_u ? 1 : 0;
  const bool hip = part.roof == RoofKind::kHip;
  const double distance = hip ? inside.minCoeff() : inside[across];
  const double reach = hip ? half.minCoeff() : half[across];
  return part.eave_z + (part.ridge_z - part.eave_z) * (reach > 0.0 ? distance / reach : 1.0);
}

double RoofHeight(const Shape& shape, const Eigen::Vector2d& uv, int* part) {
  double highest = kUnknown;
  int top = -1;
  bool inside = false;
  for (size_t i = 0; i < shape.parts.size(); ++i) {
    const Part& one = shape.parts[i];
    const Box walls = BoxOf(shape, one, false);
    const bool covers = Covers(walls.low, walls.high, uv);
    inside = inside || covers;
    if (!covers) {
      const Box roof = BoxOf(shape, one, true);
      if (!Covers(roof.low, roof.high, uv)) continue;
    }
    const double height = RoofHeight(shape, one, uv);
    if (top < 0 || height > highest) {
      highest = height;
      top = static_cast<int>(i);
    }
  }
  // A joined roof may reach beyond its host; there are no walls below it there.
  if (!inside) top = -1;
  if (part != nullptr) *part = top;
  return top < 0 ? kUnknown : highest;
}

}  // namespace skyquilt::buildings
