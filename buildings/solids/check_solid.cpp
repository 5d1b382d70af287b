#include <algorithm>
#include <numeric>
#include <string>

#include "buildings/solids/build_solids.h"
#include "buildings/solids/solid_checks.h"

namespace skyquilt::buildings {
namespace {

constexpr double kNearM = 0.001;  // metres, val3dity's default

// Pairs of vertices that would become one when the file is read with a tolerance.
std::vector<SolidProblem> CheckVertices(const Solid& solid) {
  std::vector<SolidProblem> problems;
  std::vector<size_t> order(solid.vertex.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::sort(order.begin(), order.end(), [&](size_t i, size_t j) { return solid.vertex[i].x() < solid.vertex[j].x(); });
  // The margin lets neighbours on a grid of millimetres be apart.
  constexpr double kNear = kNearM * (1.0 - 1e-6);
  for (size_t i = 0; i < order.size(); ++i) {
    const Eigen::Vector3d& a = solid.vertex[order[i]];
    for (size_t j = i + 1; j < order.size() && solid.vertex[order[j]].x() - a.x() < kNear; ++j) {
      if ((solid.vertex[order[j]] - a).norm() < kNear) {
        const auto [low, high] = std::minmax(order[i], order[j]);
        problems.push_back({kNearVertices, "Vertices " + std::to_string(low) + " and " + std::to_string(high) + " are less than 1 mm apart."});
      }
    }
  }
  return problems;
}

bool HasNumbers(const Solid& solid) {
  const auto known = [&](uint32_t v) { return v < solid.vertex.size(); };
  const bool finite = std::all_of(solid.vertex.begin(), solid.vertex.end(), [](const Eigen::Vector3d& v) { return v.allFinite(); });
  return finite && std::all_of(solid.face.begin(), solid.face.end(), [&](const Face& face) {
           return std::all_of(face.outer.begin(), face.outer.end(), known) &&
                  std::all_of(face.holes.begin(), face.holes.end(),
                              [&](const std::vector<uint32_t>& hole) { return std::all_of(hole.begin(), hole.end(), known); });
         });
}

}  // namespace

std::vector<SolidProblem> CheckSolid(const Solid& solid) {
  if (!HasNumbers(solid)) return {{902, "A coordinate is no number, or a face names a vertex that does not exist."}};
  const SolidTriangles triangles = Triangulate(solid);
  std::vector<SolidProblem> problems = CheckVertices(solid);
  // As val3dity: shells are looked at when their faces are right, and geometry when the topology is.
  for (SolidProblem& problem : CheckFaces(solid, triangles)) problems.push_back(std::move(problem));
  if (!problems.empty()) return problems;
  problems = CheckShell(solid, triangles);
  if (!problems.empty()) return problems;
  for (const auto& [f, g] : CrossingFaces(solid, triangles)) {
    problems.push_back({306, "Faces " + std::to_string(f) + " and " + std::to_string(g) + " cross or overlap."});
  }
  return problems;
}

}  // namespace skyquilt::buildings
