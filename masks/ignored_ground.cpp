#include "masks/ignored_ground.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/order_statistics.h"
#include "core/base/packed_bytes.h"
#include "core/gis/map_projection.h"
#include "core/scene/point_heights.h"
#include "core/survey/seen_ground.h"

namespace skyquilt::masks {
namespace {

constexpr double kLongestEdge_m = 200.0;  // straight on the map is hardly bent in ENU over such lengths
// Rays that are less steep meet no ground (HeightMap::Intersect), so it is at most this many heights of the camera away.
constexpr double kFarthestHeights = 20.0;

using Ring = std::vector<Eigen::Vector2d>;

// The part of the ring on one side of a line: where inside(point) >= 0, which is linear along edges (Sutherland and Hodgman 1974). Even-odd insides
// stay the same there.
Ring ClipAt(const Ring& ring, const std::function<double(const Eigen::Vector2d&)>& inside) {
  Ring clipped;
  for (size_t i = 0; i < ring.size(); ++i) {
    const Eigen::Vector2d &a = ring[i], &b = ring[(i + 1) % ring.size()];
    const double at_a = inside(a), at_b = inside(b);
    if (at_a >= 0.0) clipped.push_back(a);
    if ((at_a >= 0.0) != (at_b >= 0.0)) clipped.emplace_back(a + at_a / (at_a - at_b) * (b - a));
  }
  return clipped;
}

// To a rectangle on the map.
Ring Clip(Ring ring, const gis::MapExtent& map) {
  for (int axis = 0; axis < 2; ++axis) {
    ring = ClipAt(ring, [&](const Eigen::Vector2d& point) { return point[axis] - map.low[axis]; });
    ring = ClipAt(ring, [&](const Eigen::Vector2d& point) { return map.high[axis] - point[axis]; });
  }
  return ring;
}

// A ring on the map, at one height, in ENU.
Ring ToEnu(const Ring& ring, const gis::MapProjection& projection, double ground_z) {
  Ring enu;
  for (size_t i = 0; i < ring.size(); ++i) {
    const Eigen::Vector2d &a = ring[i], &b = ring[(i + 1) % ring.size()];
    const int n = std::max(1, static_cast<int>(std::ceil((b - a).norm() / kLongestEdge_m)));
    for (int k = 0; k < n; ++k) {
      const gis::MapProjection::VerticalLine line = projection.VerticalLineAt(a + (b - a) * k / n);
      const double s = (ground_z - line.start_enu.z()) / line.down_enu.z();
      enu.emplace_back((line.start_enu + s * line.down_enu).head<2>());
    }
  }
  return enu;
}

// Height of the highest camera above the ground.
double Highest(const survey::Survey& survey, double ground_z) {
  double highest = 0.0;
  for (const survey::Photo& photo : survey.photos) highest = std::max(highest, photo.cam_from_enu.OriginInSource().z() - ground_z);
  return highest;
}

gis::MapExtent ExtentOf(const Eigen::AlignedBox2d& area, double ground_z, const gis::MapProjection& projection) {
  return gis::ProjectedExtent({area.min().x(), area.min().y(), ground_z}, {area.max().x(), area.max().y(), ground_z}, projection);
}

}  // namespace

IgnoredGround::IgnoredGround(const survey::Survey& survey, const std::filesystem::path& polygons) {
  gis::MapGrid grid;
  grid.georeferenced = survey.georeferenced;
  if (survey.georeferenced) grid.zone = geo::UtmZoneOf(survey.origin);
  const gis::Boundary given = gis::Boundary::Read(polygons, grid.georeferenced, grid.zone);
  const std::vector<Eigen::Vector3d> points = survey::SteadyPoints(survey);
  if (points.empty()) {
    throw base::InputError(survey.photo_root, "the survey has no sparse points, so the height of the ground to ignore is unknown",
                           "Give a camera model with points, or leave masks.ignore_ground empty");
  }
  std::vector<double> z;
  z.reserve(points.size());
  for (const Eigen::Vector3d& point : points) z.push_back(point.z());
  const double ground_z = base::Median(std::move(z));
  Eigen::AlignedBox2d area = survey::SeenGround(survey, points, ground_z);
  if (area.isEmpty()) {
    for (const Eigen::Vector3d& point : points) area.extend(point.head<2>());
  }
  heights_ = scene::HeightsOfPoints(points, area);

  const gis::MapProjection projection(survey.origin, grid);
  const double reach_m = kFarthestHeights * Highest(survey, ground_z);
  const gis::MapExtent seen = ExtentOf(area, ground_z, projection);
  const Eigen::AlignedBox2d around(area.min().array() - reach_m, area.max().array() + reach_m);
  const gis::MapExtent reached = ExtentOf(around, ground_z, projection);
  std::vector<Ring> rings;
  bool meets = false;
  for (const Ring& ring : given.rings()) {
    meets = meets || Clip(ring, seen).size() >= 3;
    Ring near = Clip(ring, reached);
    if (near.size() >= 3) rings.push_back(ToEnu(near, projection, ground_z));
  }
  if (!meets) {
    throw base::InputError(polygons, "has no polygon on the ground that the photos see, so there is nothing to ignore",
                           "Draw polygons there, check the coordinate system of the file, or leave masks.ignore_ground empty");
  }
  inside_ = gis::Boundary(std::move(rings));
  base::BytePacker bytes;
  for (const Ring& ring : inside_.rings()) {
    bytes.Add(static_cast<int64_t>(ring.size()));
    for (const Eigen::Vector2d& point : ring) {
      bytes.Add(point.x());
      bytes.Add(point.y());
    }
  }
  bytes.Add(heights_.heights());
  key_ = base::HashHex(bytes.bytes());
}

image::Image8 IgnoredGround::Mask(const camera::Camera& camera, const geo::Rigid3d& cam_from_enu) const {
  image::Image8 mask(camera.width, camera.height, 1, 255);
  const Eigen::Vector3d eye = cam_from_enu.OriginInSource();
  const Eigen::Matrix3d enu_from_cam = cam_from_enu.rotation.conjugate().toRotationMatrix();
  for (int y = 0; y < mask.height; ++y) {
    for (int x = 0; x < mask.width; ++x) {
      const Eigen::Vector3d ray = enu_from_cam * camera.RayFromImg({x + 0.5, y + 0.5});
      Eigen::Vector3d ground;
      if (heights_.Intersect(eye, ray, &ground) && inside_.Contains(ground.head<2>())) *mask.At(x, y) = 0;
    }
  }
  return mask;
}

}  // namespace skyquilt::masks
