// Triangle mesh of a simulated place, with normals and a tag per triangle that says which part of which object it is. ENU metres in single precision,
// as a simulated survey spans a few kilometres at most.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace skyquilt::simulate {

enum class Part : uint8_t {
  kGround,
  kWater,
  kWall,
  kFlatRoof,
  kPitchedRoof,
  kParapet,
  kRooftopBox,
  kChimney,
  kTrunk,
  kLeaves,
  kCarBody,
  kCarGlass,
  kCarTyre,
  kBridgeRoad,
  kBridgeConcrete,
  kSolarPanel,  // the side to the sun
  kSolarFrame,  // of tables: below, edges and posts
  kRoomFloor,
  kRoomWall,       // ceiling and outside too
  kRoomFurniture,  // doors, pictures and the window's frame too
  kPerson,
  kLampPost,  // and its arm
  kLampHead
};

struct Tag {
  Part part = Part::kGround;
  uint32_t object = 0;  // index of the building, tree, car, person or lamp
};

struct Mesh {
  std::vector<Eigen::Vector3f> position;
  std::vector<Eigen::Vector3f> normal;            // per vertex, unit, outwards
  std::vector<std::array<uint32_t, 3>> triangle;  // counter-clockwise seen from outside
  std::vector<Tag> tag;                           // per triangle

  // Flat faces, not sharing vertices with others; corners counter-clockwise seen from outside.
  void AddTriangle(const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c, Tag t);
  void AddQuad(const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c, const Eigen::Vector3f& d, Tag t);
  // Sides and top of a box whose bottom is centred on `centre_bottom`, turned by yaw (radians, counter-clockwise); half: half sizes along its own
  // axes, z unused.
  void AddBox(const Eigen::Vector3f& centre_bottom, const Eigen::Vector3f& half, float height, float yaw, Tag sides, Tag top);
  // Sphere from an icosahedron subdivided `subdivisions` times, with smooth normals. `place` maps each unit vector to the vertex position.
  template <typename Place>
  void AddSphere(int subdivisions, const Place& place, Tag t) {
    const Mesh& sphere = UnitSphere(subdivisions);
    const auto first = static_cast<uint32_t>(position.size());
    for (const Eigen::Vector3f& unit : sphere.position) position.push_back(place(unit));
    AppendSmooth(sphere, first, t);
  }

  Eigen::Vector3f FaceNormal(uint32_t triangle_index) const;
  Eigen::Vector3f ShadingNormal(uint32_t triangle_index, float u, float v) const;

 private:
  static const Mesh& UnitSphere(int subdivisions);
  void AppendSmooth(const Mesh& shape, uint32_t first, Tag t);
};

}  // namespace skyquilt::simulate
