#include "simulate/tagged_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace skyquilt::simulate {
namespace {

using Eigen::Vector3f;

struct Shape {
  std::vector<Vector3f> position;
  std::vector<std::array<uint32_t, 3>> triangle;
};

Shape Icosahedron() {
  const float g = 0.5F * (1.0F + std::sqrt(5.0F));
  Shape shape;
  shape.position = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                    {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  for (Vector3f& p : shape.position) p.normalize();
  shape.triangle = {{0, 11, 5}, {0, 5, 1}, {0, 1, 7}, {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                    {3, 9, 4},  {3, 4, 2}, {3, 2, 6}, {3, 6, 8},  {3, 8, 9},   {4, 9, 5}, {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  return shape;
}

Shape Subdivide(const Shape& in) {
  Shape out;
  out.position = in.position;
  std::map<std::pair<uint32_t, uint32_t>, uint32_t> middle;
  const auto Middle = [&](uint32_t a, uint32_t b) {
    const auto key = std::minmax(a, b);
    const auto [it, fresh] = middle.try_emplace({key.first, key.second}, static_cast<uint32_t>(out.position.size()));
    if (fresh) out.position.push_back((in.position[a] + in.position[b]).normalized());
    return it->second;
  };
  for (const auto& [a, b, c] : in.triangle) {
    const uint32_t ab = Middle(a, b);
    const uint32_t bc = Middle(b, c);
    const uint32_t ca = Middle(c, a);
    out.triangle.insert(out.triangle.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
  }
  return out;
}

}  // namespace

void Mesh::AddTriangle(const Vector3f& a, const Vector3f& b, const Vector3f& c, Tag t) {
  const Vector3f n = (b - a).cross(c - a).normalized();
  const auto first = static_cast<uint32_t>(position.size());
  position.insert(position.end(), {a, b, c});
  normal.insert(normal.end(), 3, n);
  triangle.push_back({first, first + 1, first + 2});
  tag.push_back(t);
}

void Mesh::AddQuad(const Vector3f& a, const Vector3f& b, const Vector3f& c, const Vector3f& d, Tag t) {
  const Vector3f n = (c - a).cross(d - b).normalized();
  const auto first = static_cast<uint32_t>(position.size());
  position.insert(position.end(), {a, b, c, d});
  normal.insert(normal.end(), 4, n);
  triangle.push_back({first, first + 1, first + 2});
  triangle.push_back({first, first + 2, first + 3});
  tag.insert(tag.end(), 2, t);
}

void Mesh::AddBox(const Vector3f& centre_bottom, const Vector3f& half, float height, float yaw, Tag sides, Tag top) {
  const Vector3f u = Vector3f(std::cos(yaw), std::sin(yaw), 0.0F) * half.x();
  const Vector3f v = Vector3f(-std::sin(yaw), std::cos(yaw), 0.0F) * half.y();
  const Vector3f up(0.0F, 0.0F, height);
  const std::array<Vector3f, 4> corner = {centre_bottom - u - v, centre_bottom + u - v, centre_bottom + u + v, centre_bottom - u + v};
  for (size_t i = 0; i < 4; ++i) {
    const Vector3f& a = corner[i];
    const Vector3f& b = corner[(i + 1) % 4];
    AddQuad(a, b, b + up, a + up, sides);
  }
  AddQuad(corner[0] + up, corner[1] + up, corner[2] + up, corner[3] + up, top);
}

const Mesh& Mesh::UnitSphere(int subdivisions) {
  static const std::array<Mesh, 4> spheres = [] {
    std::array<Mesh, 4> levels;
    Shape shape = Icosahedron();
    for (Mesh& mesh : levels) {
      mesh.position = shape.position;
      mesh.triangle = shape.triangle;
      shape = Subdivide(shape);
    }
    return levels;
  }();
  return spheres[static_cast<size_t>(std::clamp(subdivisions, 0, 3))];
}

void Mesh::AppendSmooth(const Mesh& shape, uint32_t first, Tag t) {
  normal.resize(position.size(), Vector3f::Zero());
  for (const auto& [a, b, c] : shape.triangle) {
    const std::array<uint32_t, 3> corner = {first + a, first + b, first + c};
    const Vector3f n = (position[corner[1]] - position[corner[0]]).cross(position[corner[2]] - position[corner[0]]);
    for (const uint32_t vertex : corner) normal[vertex] += n;
    triangle.push_back(corner);
    tag.push_back(t);
  }
  for (size_t vertex = first; vertex < normal.size(); ++vertex) normal[vertex].normalize();
}

Vector3f Mesh::FaceNormal(uint32_t triangle_index) const {
  const auto& [a, b, c] = triangle[triangle_index];
  return (position[b] - position[a]).cross(position[c] - position[a]).normalized();
}

Vector3f Mesh::ShadingNormal(uint32_t triangle_index, float u, float v) const {
  const auto& [a, b, c] = triangle[triangle_index];
  return ((1.0F - u - v) * normal[a] + u * normal[b] + v * normal[c]).normalized();
}

}  // namespace skyquilt::simulate
