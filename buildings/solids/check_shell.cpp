// How faces hang together at edges and vertices.
#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "buildings/solids/solid_checks.h"

namespace skyquilt::buildings {
namespace {

// The faces that run along an edge from its smaller vertex to the other, and against it.
struct ShellEdge {
  std::vector<uint32_t> along, against;
};

class ShellChecker {
 public:
  ShellChecker(const Solid& solid, const SolidTriangles& triangles) : solid_(solid), triangles_(triangles) {
    for (uint32_t f = 0; f < solid.face.size(); ++f) {
      AddRing(f, solid.face[f].outer);
      for (const std::vector<uint32_t>& hole : solid.face[f].holes) AddRing(f, hole);
    }
  }

  std::vector<SolidProblem> Run() {
    if (solid_.face.size() < 4) {
      problems_.push_back({301, "The shell has fewer than four faces."});
      return problems_;
    }
    CheckEdges();
    if (problems_.empty()) CheckFans();
    CheckComponents();
    if (problems_.empty() && !(Volume(solid_) > 0.0)) problems_.push_back({405, "All faces look inwards."});
    return problems_;
  }

 private:
  void AddRing(uint32_t f, const std::vector<uint32_t>& ring) {
    const size_t n = ring.size();
    for (size_t i = 0; i < n; ++i) {
      const uint32_t a = ring[i], b = ring[(i + 1) % n];
      ShellEdge& edge = edges_[std::minmax(a, b)];
      (a < b ? edge.along : edge.against).push_back(f);
    }
  }

  void CheckEdges() {
    for (const auto& [ends, edge] : edges_) {
      const std::string name = "Edge " + std::to_string(ends.first) + " to " + std::to_string(ends.second);
      const size_t n = edge.along.size() + edge.against.size();
      if (n == 1) {
        problems_.push_back({302, name + " has a face on one side only."});
      } else if (n > 2) {
        problems_.push_back({304, name + " has " + std::to_string(n) + " faces."});
      } else if (edge.along.size() != 1) {
        const std::vector<uint32_t>& faces = edge.along.empty() ? edge.against : edge.along;
        problems_.push_back({307, name + " runs the same way around faces " + std::to_string(faces[0]) + " and " + std::to_string(faces[1]) + "."});
      }
    }
  }

  // Around each vertex triangles must follow each other in one turn. Not faces: the ring of a face and a hole can touch in a vertex, where the face
  // then has two corners.
  void CheckFans() {
    struct Fan {
      std::map<uint32_t, uint32_t> after;  // the other ends of edges at the vertex, around it
      size_t triangles = 0;
    };
    std::vector<Fan> fans(solid_.vertex.size());
    for (const std::array<uint32_t, 3>& t : triangles_.triangle) {
      for (size_t k = 0; k < 3; ++k) {
        fans[t[k]].after[t[(k + 1) % 3]] = t[(k + 2) % 3];
        ++fans[t[k]].triangles;
      }
    }
    for (size_t v = 0; v < fans.size(); ++v) {
      const Fan& fan = fans[v];
      if (fan.triangles == 0) {
        problems_.push_back({309, "Vertex " + std::to_string(v) + " belongs to no face."});
        continue;
      }
      size_t turned = 0;
      for (auto at = fan.after.begin(); at != fan.after.end() && turned <= fan.triangles; at = fan.after.find(at->second)) {
        ++turned;
        if (at->second == fan.after.begin()->first) break;
      }
      if (turned != fan.triangles) problems_.push_back({303, "At vertex " + std::to_string(v) + " parts of the shell touch in a point."});
    }
  }

  void CheckComponents() {
    std::vector<uint32_t> group(solid_.face.size());
    for (uint32_t f = 0; f < group.size(); ++f) group[f] = f;
    const auto of = [&](uint32_t f) {
      while (group[f] != f) f = group[f];
      return f;
    };
    for (const auto& [ends, edge] : edges_) {
      std::vector<uint32_t> faces = edge.along;
      faces.insert(faces.end(), edge.against.begin(), edge.against.end());
      for (const uint32_t f : faces) {
        const uint32_t one = of(f), other = of(faces.front());
        group[std::max(one, other)] = std::min(one, other);
      }
    }
    std::set<uint32_t> components;
    for (uint32_t f = 0; f < group.size(); ++f) components.insert(of(f));
    if (components.size() > 1) problems_.push_back({305, "The shell has " + std::to_string(components.size()) + " separate components."});
  }

  const Solid& solid_;
  const SolidTriangles& triangles_;
  std::map<std::pair<uint32_t, uint32_t>, ShellEdge> edges_;
  std::vector<SolidProblem> problems_;
};

}  // namespace

std::vector<SolidProblem> CheckShell(const Solid& solid, const SolidTriangles& triangles) {
  return ShellChecker(solid, triangles).Run();
}

}  // namespace skyquilt::buildings
