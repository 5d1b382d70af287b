#include "tests/buildings/sample_buildings.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace skyquilt::buildings {
namespace {

using Ring = std::vector<Eigen::Vector3d>;  // u, v, z

// Joins faces given by coordinates in the axes of a shape into a solid.
class SolidMaker {
 public:
  explicit SolidMaker(const Shape& shape) : shape_(shape) {}

  void Add(FaceKind kind, const Ring& outer, const std::vector<Ring>& holes = {}) {
    Face face;
    face.kind = kind;
    face.outer = Indices(outer);
    for (const Ring& hole : holes) face.holes.push_back(Indices(hole));
    solid_.face.push_back(std::move(face));
  }
  Solid Take() { return std::move(solid_); }

 private:
  std::vector<uint32_t> Indices(const Ring& ring) {
    std::vector<uint32_t> indices;
    for (const Eigen::Vector3d& x : ring) {
      const auto key = std::make_pair(std::make_pair(std::llround(1e4 * x.x()), std::llround(1e4 * x.y())), std::llround(1e4 * x.z()));
      const auto [place, is_new] = index_.try_emplace(key, static_cast<uint32_t>(solid_.vertex.size()));
      if (is_new) {
        const Eigen::Vector2d enu = EnuOf(shape_, x.head<2>());
        solid_.vertex.emplace_back(enu.x(), enu.y(), x.z());
      }
      indices.push_back(place->second);
    }
    return indices;
  }

  const Shape& shape_;
  Solid solid_;
  std::map<std::pair<std::pair<long long, long long>, long long>, uint32_t> index_;
};

Ring Lifted(const std::vector<Eigen::Vector2d>& ring, double z) {
  Ring lifted;
  for (const Eigen::Vector2d& uv : ring) lifted.emplace_back(uv.x(), uv.y(), z);
  return lifted;
}

std::vector<Eigen::Vector2d> Box(double u0, double v0, double u1, double v1) {
  return {{u0, v0}, {u1, v0}, {u1, v1}, {u0, v1}};
}

// A block over a footprint in u, v.
Solid Block(const Shape& shape, const Polygon& footprint, double bottom, double top) {
  SolidMaker maker(shape);
  std::vector<Ring> low, high;
  for (const auto& hole : footprint.holes) {
    low.push_back(Lifted({hole.rbegin(), hole.rend()}, bottom));
    high.push_back(Lifted(hole, top));
  }
  maker.Add(FaceKind::kGround, Lifted({footprint.outer.rbegin(), footprint.outer.rend()}, bottom), low);
  maker.Add(FaceKind::kRoof, Lifted(footprint.outer, top), high);
  std::vector<std::vector<Eigen::Vector2d>> rings = footprint.holes;
  rings.insert(rings.begin(), footprint.outer);
  for (const auto& ring : rings) {
    for (size_t i = 0; i < ring.size(); ++i) {
      const Eigen::Vector2d &a = ring[i], &b = ring[(i + 1) % ring.size()];
      maker.Add(FaceKind::kWall, {{a.x(), a.y(), bottom}, {b.x(), b.y(), bottom}, {b.x(), b.y(), top}, {a.x(), a.y(), top}});
    }
  }
  return maker.Take();
}

std::vector<Eigen::Vector2d> ToEnu(const Shape& shape, const std::vector<Eigen::Vector2d>& ring) {
  std::vector<Eigen::Vector2d> enu;
  for (const Eigen::Vector2d& uv : ring) enu.push_back(EnuOf(shape, uv));
  return enu;
}

double RingArea(const std::vector<Eigen::Vector2d>& ring) {
  double twice = 0.0;
  for (size_t i = 0; i < ring.size(); ++i) {
    const Eigen::Vector2d &a = ring[i], &b = ring[(i + 1) % ring.size()];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return 0.5 * twice;
}

Eigen::Vector3d AreaVector(const Solid& solid, const Face& face) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  const auto add = [&](const std::vector<uint32_t>& ring) {
    const Eigen::Vector3d first = solid.vertex[ring[0]];
    for (size_t i = 1; i + 1 < ring.size(); ++i) sum += 0.5 * (solid.vertex[ring[i]] - first).cross(solid.vertex[ring[i + 1]] - first);
  };
  add(face.outer);
  for (const auto& hole : face.holes) add(hole);
  return sum;
}

// Any planar face: its cone to a point has a third of area times height, whatever the place on the face the height is taken at.
double VolumeOf(const Solid& solid) {
  double volume = 0.0;
  for (const Face& face : solid.face) volume += AreaVector(solid, face).dot(solid.vertex[face.outer[0]] - solid.vertex[0]) / 3.0;
  return volume;
}

// The plane roofs of one part, continued without end.
double PartRoof(const Shape& shape, const Part& part, const Eigen::Vector2d& uv) {
  const double from_u = std::min(uv.x() - shape.u[static_cast<size_t>(part.u0)], shape.u[static_cast<size_t>(part.u1)] - uv.x());
  const double from_v = std::min(uv.y() - shape.v[static_cast<size_t>(part.v0)], shape.v[static_cast<size_t>(part.v1)] - uv.y());
  if (part.roof == RoofKind::kHip) return part.eave_z + SlopeOf(shape, part) * std::min(from_u, from_v);
  if (part.roof == RoofKind::kGable) return part.eave_z + SlopeOf(shape, part) * (part.along_u ? from_v : from_u);
  return part.eave_z;
}

// Fills in what follows from shape and solids. rings: the footprint in u, v.
Building Finished(int id, const Shape& shape, double overhang_m, const Polygon& footprint_uv, Solid lod22) {
  Building building;
  building.id = id;
  building.shape = shape;
  const Part& main = shape.parts[0];
  building.roof = main.roof;
  building.footprint.outer = ToEnu(shape, footprint_uv.outer);
  for (const auto& hole : footprint_uv.holes) building.footprint.holes.push_back(ToEnu(shape, hole));
  building.overhang_m = main.roof == RoofKind::kFlat ? 0.0 : overhang_m;
  building.overhang_measured = true;
  building.walls_from_points = true;
  building.share_within = 1.0;
  building.lod22 = std::move(lod22);
  Measures& m = building.measures;
  const double length = shape.u.back() - shape.u.front(), width = shape.v.back() - shape.v.front();
  double top = main.ridge_z;
  for (const Part& part : shape.parts) top = std::max(top, part.ridge_z);
  m.ground_m.value = shape.ground_z;
  m.eave_m.value = main.eave_z;
  m.ridge_m.value = top;
  m.height_m.value = top - shape.ground_z;
  m.length_m.value = std::max(length, width);
  m.width_m.value = std::min(length, width);
  const double yaw = (shape.yaw_rad * 180.0 / std::numbers::pi) + (width > length ? 90.0 : 0.0);
  m.yaw_deg.value = yaw - 180.0 * std::floor(yaw / 180.0);
  m.footprint_m2.value = RingArea(footprint_uv.outer);
  for (const auto& hole : footprint_uv.holes) m.footprint_m2.value += RingArea(hole);
  m.roof_m2.value = 0.0;
  for (const Face& face : building.lod22.face) {
    if (face.kind == FaceKind::kRoof) m.roof_m2.value += AreaVector(building.lod22, face).norm();
  }
  m.volume_m3.value = VolumeOf(building.lod22);
  m.pitch_deg.value = std::atan(SlopeOf(shape, main)) * 180.0 / std::numbers::pi;
  m.wall_seen = 1.0;
  building.lod12 = Block(shape, footprint_uv, shape.ground_z, shape.ground_z + m.volume_m3.value / m.footprint_m2.value);
  return building;
}

Shape ShapeOf(const HousePlan& plan) {
  Shape shape;
  shape.origin = plan.origin;
  shape.yaw_rad = plan.yaw_rad;
  shape.u = {0.0, plan.length_m};
  shape.v = {0.0, plan.width_m};
  shape.ground_z = plan.ground_z;
  Part part;
  part.roof = plan.roof;
  part.along_u = plan.roof == RoofKind::kHip ? plan.length_m >= plan.width_m : plan.along_u;
  part.eave_z = plan.eave_z;
  part.ridge_z = plan.roof == RoofKind::kFlat || plan.roof == RoofKind::kOther ? plan.eave_z : plan.ridge_z;
  shape.parts = {part};
  return shape;
}

// Gable or hip over u = 0 .. l, v = 0 .. w with the ridge between two points; the ends are vertical for a gable.
Solid PitchedSolid(const Shape& shape, double l, double w, double g, double e, const Eigen::Vector3d& r0, const Eigen::Vector3d& r1, bool along_u,
                   bool hip) {
  SolidMaker maker(shape);
  const Eigen::Vector3d a(0, 0, e), b(l, 0, e), c(l, w, e), d(0, w, e);
  maker.Add(FaceKind::kGround, {{0, 0, g}, {0, w, g}, {l, w, g}, {l, 0, g}});
  const Ring walls[4] = {{{0, 0, g}, {l, 0, g}, b, a}, {{l, 0, g}, {l, w, g}, c, b}, {{l, w, g}, {0, w, g}, d, c}, {{0, w, g}, {0, 0, g}, a, d}};
  for (int side = 0; side < 4; ++side) {
    Ring wall = walls[side];
    // Walls 1 and 3 are at the ends of u, 0 and 2 at those of v.
    if (!hip && (side % 2 == 1) == along_u) wall.insert(wall.begin() + 3, side == 1 || side == 2 ? r1 : r0);
    maker.Add(FaceKind::kWall, wall);
  }
  if (along_u) {
    maker.Add(FaceKind::kRoof, {a, b, r1, r0});
    maker.Add(FaceKind::kRoof, {c, d, r0, r1});
    if (hip) maker.Add(FaceKind::kRoof, {b, c, r1});
    if (hip) maker.Add(FaceKind::kRoof, {d, a, r0});
  } else {
    maker.Add(FaceKind::kRoof, {b, c, r1, r0});
    maker.Add(FaceKind::kRoof, {d, a, r0, r1});
    if (hip) maker.Add(FaceKind::kRoof, {a, b, r0});
    if (hip) maker.Add(FaceKind::kRoof, {c, d, r1});
  }
  return maker.Take();
}

}  // namespace

Eigen::Vector2d EnuOf(const Shape& shape, const Eigen::Vector2d& uv) {
  const Eigen::Vector2d axis(std::cos(shape.yaw_rad), std::sin(shape.yaw_rad));
  return shape.origin + uv.x() * axis + uv.y() * Eigen::Vector2d(-axis.y(), axis.x());
}

double SlopeOf(const Shape& shape, const Part& part) {
  const double u = shape.u[static_cast<size_t>(part.u1)] - shape.u[static_cast<size_t>(part.u0)];
  const double v = shape.v[static_cast<size_t>(part.v1)] - shape.v[static_cast<size_t>(part.v0)];
  if (part.roof != RoofKind::kGable && part.roof != RoofKind::kHip) return 0.0;
  const double run = part.roof == RoofKind::kHip ? 0.5 * std::min(u, v) : 0.5 * (part.along_u ? v : u);
  return (part.ridge_z - part.eave_z) / run;
}

RoofBox RoofBoxOf(const Shape& shape, const Part& part, double overhang_m) {
  RoofBox box{{shape.u[static_cast<size_t>(part.u0)], shape.v[static_cast<size_t>(part.v0)]},
              {shape.u[static_cast<size_t>(part.u1)], shape.v[static_cast<size_t>(part.v1)]}};
  if (SlopeOf(shape, part) > 0.0) {
    box.low -= Eigen::Vector2d::Constant(overhang_m);
    box.high += Eigen::Vector2d::Constant(overhang_m);
  }
  if (part.joins >= 0) {
    const Part& main = shape.parts[static_cast<size_t>(part.joins)];
    box.high.y() = 0.5 * (shape.v[static_cast<size_t>(main.v0)] + shape.v[static_cast<size_t>(main.v1)]);
  }
  return box;
}

double MadeRoofHeight(const Building& building, const Eigen::Vector2d& uv, int* part) {
  double height = kUnknown;
  for (size_t i = 0; i < building.shape.parts.size(); ++i) {
    const RoofBox box = RoofBoxOf(building.shape, building.shape.parts[i], building.overhang_m);
    if ((uv.array() < box.low.array()).any() || (uv.array() > box.high.array()).any()) continue;
    const double z = PartRoof(building.shape, building.shape.parts[i], uv);
    if (z <= height) continue;
    height = z;
    if (part) *part = static_cast<int>(i);
  }
  return height;
}

Building MadeHouse(const HousePlan& plan, int id) {
  const Shape shape = ShapeOf(plan);
  const double l = plan.length_m, w = plan.width_m, g = plan.ground_z, e = plan.eave_z;
  const Part& part = shape.parts[0];
  const Polygon footprint{Box(0, 0, l, w), {}};
  Solid solid;
  if (SlopeOf(shape, part) == 0.0) {
    solid = Block(shape, footprint, g, e);
  } else {
    const bool hip = plan.roof == RoofKind::kHip;
    const double in = hip ? 0.5 * std::min(l, w) : 0.0;
    const double z = part.ridge_z;
    const Eigen::Vector3d r0 = part.along_u ? Eigen::Vector3d(in, 0.5 * w, z) : Eigen::Vector3d(0.5 * l, in, z);
    const Eigen::Vector3d r1 = part.along_u ? Eigen::Vector3d(l - in, 0.5 * w, z) : Eigen::Vector3d(0.5 * l, w - in, z);
    solid = PitchedSolid(shape, l, w, g, e, r0, r1, part.along_u, hip);
  }
  Building building = Finished(id, shape, plan.overhang_m, footprint, std::move(solid));
  const double o = building.overhang_m;
  building.roofprint = {{ToEnu(shape, Box(-o, -o, l + o, w + o)), {}}};
  return building;
}

Building MadeTHouse(const HousePlan& plan, const WingPlan& wing, int id) {
  HousePlan main = plan;
  main.roof = RoofKind::kGable;
  main.along_u = true;
  Shape shape = ShapeOf(main);
  const double l = plan.length_m, w = plan.width_m, g = plan.ground_z, e = plan.eave_z, r = plan.ridge_z, rw = wing.ridge_z;
  const double a = wing.from_m, b = wing.to_m, d = wing.depth_m, middle = 0.5 * (a + b);
  shape.u = {0.0, a, b, l};
  shape.v = {-d, 0.0, w};
  shape.parts[0].u1 = 3;
  shape.parts[0].v0 = 1;
  shape.parts[0].v1 = 2;
  Part part;
  part.u0 = 1;
  part.u1 = 2;
  part.v1 = 1;
  part.roof = RoofKind::kGable;
  part.along_u = false;
  part.eave_z = e;
  part.ridge_z = rw;
  part.joins = 0;
  shape.parts.push_back(part);
  // Where the wing's ridge meets the main slope.
  const Eigen::Vector3d join(middle, 0.5 * w * (rw - e) / (r - e), rw), end(middle, -d, rw), r0(0, 0.5 * w, r), r1(l, 0.5 * w, r);
  const Polygon footprint{{{0, 0}, {a, 0}, {a, -d}, {b, -d}, {b, 0}, {l, 0}, {l, w}, {0, w}}, {}};
  SolidMaker maker(shape);
  maker.Add(FaceKind::kGround, Lifted({footprint.outer.rbegin(), footprint.outer.rend()}, g));
  for (size_t i = 0; i < footprint.outer.size(); ++i) {
    const Eigen::Vector2d &p = footprint.outer[i], &q = footprint.outer[(i + 1) % footprint.outer.size()];
    Ring wall = {{p.x(), p.y(), g}, {q.x(), q.y(), g}, {q.x(), q.y(), e}, {p.x(), p.y(), e}};
    if (i == 2) wall.insert(wall.begin() + 3, end);
    if (i == 5) wall.insert(wall.begin() + 3, r1);
    if (i == 7) wall.insert(wall.begin() + 3, r0);
    maker.Add(FaceKind::kWall, wall);
  }
  maker.Add(FaceKind::kRoof, {{0, 0, e}, {a, 0, e}, join, {b, 0, e}, {l, 0, e}, r1, r0});
  maker.Add(FaceKind::kRoof, {{l, w, e}, {0, w, e}, r0, r1});
  maker.Add(FaceKind::kRoof, {{a, 0, e}, {a, -d, e}, end, join});
  maker.Add(FaceKind::kRoof, {{b, -d, e}, {b, 0, e}, join, end});
  Building building = Finished(id, shape, plan.overhang_m, footprint, maker.Take());
  const double o = building.overhang_m;
  building.roofprint = {
      {ToEnu(shape, {{-o, -o}, {a - o, -o}, {a - o, -d - o}, {b + o, -d - o}, {b + o, -o}, {l + o, -o}, {l + o, w + o}, {-o, w + o}}), {}}};
  return building;
}

Building MadeLHouse(const HousePlan& plan, double wing_m, double depth_m, double wing_deck_z, int id) {
  HousePlan main = plan;
  main.roof = RoofKind::kFlat;
  Shape shape = ShapeOf(main);
  const double l = plan.length_m, w = plan.width_m, g = plan.ground_z, h = plan.eave_z, low = wing_deck_z, a = wing_m, d = depth_m;
  shape.u = {0.0, a, l};
  shape.v = {-d, 0.0, w};
  shape.parts[0].u1 = 2;
  shape.parts[0].v0 = 1;
  shape.parts[0].v1 = 2;
  Part part;
  part.eave_z = part.ridge_z = low;
  shape.parts.push_back(part);
  const Polygon footprint{{{0, -d}, {a, -d}, {a, 0}, {l, 0}, {l, w}, {0, w}}, {}};
  SolidMaker maker(shape);
  maker.Add(FaceKind::kGround, Lifted({footprint.outer.rbegin(), footprint.outer.rend()}, g));
  maker.Add(FaceKind::kRoof, Lifted(Box(0, 0, l, w), h));
  maker.Add(FaceKind::kRoof, Lifted(Box(0, -d, a, 0), low));
  maker.Add(FaceKind::kWall, {{0, -d, g}, {a, -d, g}, {a, -d, low}, {0, -d, low}});
  maker.Add(FaceKind::kWall, {{a, -d, g}, {a, 0, g}, {a, 0, low}, {a, -d, low}});
  maker.Add(FaceKind::kWall, {{a, 0, g}, {l, 0, g}, {l, 0, h}, {0, 0, h}, {0, 0, low}, {a, 0, low}});
  maker.Add(FaceKind::kWall, {{l, 0, g}, {l, w, g}, {l, w, h}, {l, 0, h}});
  maker.Add(FaceKind::kWall, {{l, w, g}, {0, w, g}, {0, w, h}, {l, w, h}});
  maker.Add(FaceKind::kWall, {{0, w, g}, {0, -d, g}, {0, -d, low}, {0, 0, low}, {0, 0, h}, {0, w, h}});
  Building building = Finished(id, shape, 0.0, footprint, maker.Take());
  building.roofprint = {building.footprint};
  return building;
}

Building MadeCourtyard(const HousePlan& plan, double depth_m, int id) {
  HousePlan main = plan;
  main.roof = RoofKind::kFlat;
  Shape shape = ShapeOf(main);
  const double l = plan.length_m, w = plan.width_m, d = depth_m;
  shape.u = {0.0, d, l - d, l};
  shape.v = {0.0, d, w - d, w};
  const Part part = shape.parts[0];
  shape.parts.assign(4, part);
  const int lines[4][4] = {{0, 3, 0, 1}, {0, 3, 2, 3}, {0, 1, 0, 3}, {2, 3, 0, 3}};
  for (size_t i = 0; i < 4; ++i) {
    Part& side = shape.parts[i];
    side.u0 = lines[i][0];
    side.u1 = lines[i][1];
    side.v0 = lines[i][2];
    side.v1 = lines[i][3];
  }
  const std::vector<Eigen::Vector2d> hole = Box(d, d, l - d, w - d);
  const Polygon footprint{Box(0, 0, l, w), {{hole.rbegin(), hole.rend()}}};
  Building building = Finished(id, shape, 0.0, footprint, Block(shape, footprint, plan.ground_z, plan.eave_z));
  building.roofprint = {building.footprint};
  return building;
}

}  // namespace skyquilt::buildings
