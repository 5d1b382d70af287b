#include "surface/mesh/edge_collapse.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/errors.h"
#include "surface/mesh/vectors.h"

namespace skyquilt::surface {
namespace {

constexpr uint32_t kNoCorner = std::numeric_limits<uint32_t>::max();
constexpr double kLengthOrder = 1e-3;       // where the error is the same, short steps come first: they make better triangles
constexpr double kLeastTurnCosine = 0.5;    // between the normals of a triangle before and after a step
constexpr double kLeastTotalCosine = 0.71;  // and since the first mesh
constexpr double kLeastFlatness = 0.02;     // height over longest edge of new triangles
constexpr int kMaxValence = 24;             // triangles at a vertex

// Twice the area over the square of the longest edge: height over longest edge.
double Flatness(double double_area, const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  return double_area / std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
}

// Ericson 2005, Real-Time Collision Detection, section 5.1.5.
double SquaredDistance(const Eigen::Vector3d& x, const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const Eigen::Vector3d ab = b - a, ac = c - a, ax = x - a, bx = x - b, cx = x - c;
  const double d1 = ab.dot(ax), d2 = ac.dot(ax);
  if (d1 <= 0.0 && d2 <= 0.0) return ax.squaredNorm();
  const double d3 = ab.dot(bx), d4 = ac.dot(bx);
  if (d3 >= 0.0 && d4 <= d3) return bx.squaredNorm();
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return (ax - d1 / (d1 - d3) * ab).squaredNorm();
  const double d5 = ab.dot(cx), d6 = ac.dot(cx);
  if (d6 >= 0.0 && d5 <= d6) return cx.squaredNorm();
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return (ax - d2 / (d2 - d6) * ac).squaredNorm();
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) return (bx - (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b)).squaredNorm();
  const double sum = va + vb + vc;
  return (ax - vb / sum * ab - vc / sum * ac).squaredNorm();
}

}  // namespace

template <typename Visitor>
void EdgeCollapse::ForEachCorner(uint32_t vertex, const Visitor& visit) {
  for (uint32_t* link = &first_corner_[vertex]; *link != kNoCorner;) {
    if (alive_[*link / 3] == 0) {
      *link = next_corner_[*link];
    } else {
      visit(*link);
      link = &next_corner_[*link];
    }
  }
}

EdgeCollapse::EdgeCollapse(const Mesh& mesh)
    : mesh_(mesh),
      triangle_(mesh.triangle),
      alive_(mesh.triangle.size(), 1),
      first_normal_(mesh.triangle.size()),
      first_corner_(mesh.position.size(), kNoCorner),
      next_corner_(3 * mesh.triangle.size(), kNoCorner),
      quadric_(mesh.position.size()),
      locked_(mesh.position.size(), 0),
      version_(mesh.position.size(), 0),
      mark_(mesh.position.size(), 0) {
  SKYQUILT_CHECK(mesh.triangle.size() < kNoCorner / 3, std::to_string(mesh.triangle.size()) + " triangles do not fit in 32-bit indices");
  Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::max()), high = -low;
  for (const Eigen::Vector3d& x : mesh.position) {
    if (!x.allFinite()) continue;
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  const Eigen::Vector3d middle = low.x() <= high.x() ? Eigen::Vector3d(0.5 * (low + high)) : Eigen::Vector3d(Eigen::Vector3d::Zero());
  position_.reserve(mesh.position.size());
  for (const Eigen::Vector3d& x : mesh.position) position_.push_back(x - middle);
  for (uint32_t t = 0; t < triangle_.size(); ++t) {
    const auto [a, b, c] = triangle_[t];
    for (uint32_t k = 3; k-- > 0;) {
      const uint32_t v = triangle_[t][k];
      next_corner_[3 * t + k] = first_corner_[v];
      first_corner_[v] = 3 * t + k;
    }
    const Eigen::Vector3d normal = DoubleAreaNormal(At(a), At(b), At(c));
    const double double_area = normal.norm();
    first_normal_[t].setZero();  // a triangle without area has no plane
    if (double_area == 0.0) continue;
    first_normal_[t] = (normal / double_area).cast<float>();
    for (const uint32_t v : {a, b, c}) quadric_[v].AddPlane(normal / double_area, At(v), 0.5 * double_area);
  }
  for (uint32_t v = 0; v < locked_.size(); ++v) locked_[v] = IsLocked(v) ? 1 : 0;
}

// Whether its triangles are anything else than one closed fan.
bool EdgeCollapse::IsLocked(uint32_t vertex) {
  corners_.clear();
  bool degenerate = false;
  ForEachCorner(vertex, [&](uint32_t corner) {
    corners_.push_back(corner);
    const auto [a, b, c] = triangle_[corner / 3];
    degenerate = degenerate || a == b || b == c || c == a;
  });
  if (degenerate || corners_.size() < 3) return true;
  size_t steps = 0, at = 0;
  do {
    const uint32_t triangle = corners_[at] / 3;
    const uint32_t last = triangle_[triangle][(corners_[at] % 3 + 2) % 3];
    for (at = 0; at < corners_.size() && Next(corners_[at]) != last;) ++at;
    ++steps;
  } while (at != 0 && at < corners_.size() && steps <= corners_.size());
  return at != 0 || steps != corners_.size();
}

// For a vertex that is not locked.
void EdgeCollapse::GatherRing(uint32_t vertex) {
  corners_.clear();
  ring_.clear();
  ForEachCorner(vertex, [&](uint32_t corner) {
    corners_.push_back(corner);
    ring_.push_back(Next(corner));
  });
}

EdgeCollapse::Step EdgeCollapse::StepTo(uint32_t from, uint32_t to) const {
  const double error2 = quadric_[from].MeanSquare(At(to));
  return {error2 + kLengthOrder * (At(to) - At(from)).squaredNorm(), error2, to};
}

void EdgeCollapse::Enqueue(uint32_t vertex) {
  ++version_[vertex];
  if (locked_[vertex] != 0) return;
  double best = std::numeric_limits<double>::infinity();
  ForEachCorner(vertex, [&](uint32_t corner) {
    const Step step = StepTo(vertex, Next(corner));
    if (step.error2 <= max_error2_) best = std::min(best, step.order);
  });
  if (std::isfinite(best)) queue_.push({best, vertex, version_[vertex]});
}

// Needs the ring of `from`. The step must leave a surface: the vertices next to both ends are the two opposite to the edge (link condition, Dey et
// al. 1999), no triangle is doubled, and locked vertices get no edges between them.
bool EdgeCollapse::KeepsTopology(uint32_t from, uint32_t to) {
  search_ += 2;
  const uint32_t in_ring = search_, in_both = search_ + 1;
  for (const uint32_t v : ring_) mark_[v] = in_ring;
  uint32_t opposite[2] = {from, from};
  size_t n_opposite = 0;
  for (const uint32_t corner : corners_) {
    const Triangle& t = triangle_[corner / 3];
    const uint32_t b = t[(corner % 3 + 1) % 3], c = t[(corner % 3 + 2) % 3];
    if (b != to && c != to) continue;
    if (n_opposite == 2) return false;
    opposite[n_opposite++] = b == to ? c : b;
  }
  if (n_opposite != 2) return false;
  size_t valence = 0, n_both = 0;
  bool doubled = false;
  ForEachCorner(to, [&](uint32_t corner) {
    ++valence;
    const Triangle& t = triangle_[corner / 3];
    const uint32_t b = t[(corner % 3 + 1) % 3], c = t[(corner % 3 + 2) % 3];
    for (const uint32_t v : {b, c}) {
      if (mark_[v] != in_ring) continue;
      mark_[v] = in_both;
      ++n_both;
    }
    doubled = doubled || (mark_[b] == in_both && mark_[c] == in_both && b != from && c != from);
  });
  if (n_both != 2 || (doubled && ring_.size() == 3)) return false;
  if (valence + ring_.size() > kMaxValence + 4 && ring_.size() > 4) return false;
  if (locked_[to] == 0) return true;
  return std::all_of(ring_.begin(), ring_.end(), [&](uint32_t v) { return v == to || v == opposite[0] || v == opposite[1] || locked_[v] == 0; });
}

// Needs the ring of `from`.
bool EdgeCollapse::KeepsShape(uint32_t from, uint32_t to) const {
  double distance2 = std::numeric_limits<double>::infinity();
  for (const uint32_t corner : corners_) {
    const Triangle& t = triangle_[corner / 3];
    const uint32_t b = t[(corner % 3 + 1) % 3], c = t[(corner % 3 + 2) % 3];
    if (b == to || c == to) continue;
    if (!MayMove(corner, to)) return false;
    distance2 = std::min(distance2, SquaredDistance(At(from), At(to), At(b), At(c)));
  }
  return distance2 <= max_error2_;
}

// Whether the triangle stays well-shaped and does not turn over when its corner moves to another vertex.
bool EdgeCollapse::MayMove(uint32_t corner, uint32_t to) const {
  const Triangle& t = triangle_[corner / 3];
  const Eigen::Vector3d &a = At(t[corner % 3]), &b = At(t[(corner % 3 + 1) % 3]), &c = At(t[(corner % 3 + 2) % 3]);
  const Eigen::Vector3d before = DoubleAreaNormal(a, b, c), after = DoubleAreaNormal(At(to), b, c);
  const double before_norm = before.norm(), after_norm = after.norm();
  if (!(after_norm > 0.0)) return false;
  if (before.dot(after) < kLeastTurnCosine * before_norm * after_norm) return false;
  const Eigen::Vector3d first = first_normal_[corner / 3].cast<double>();
  if (first.dot(after) < kLeastTotalCosine * after_norm && first.squaredNorm() > 0.0) return false;
  const double flatness = Flatness(after_norm, At(to), b, c);
  return flatness >= kLeastFlatness || (before_norm > 0.0 && flatness >= Flatness(before_norm, a, b, c));
}

// Needs the ring of `from`.
void EdgeCollapse::Collapse(uint32_t from, uint32_t to) {
  for (const uint32_t corner : corners_) {
    const Triangle& t = triangle_[corner / 3];
    if (t[0] == to || t[1] == to || t[2] == to) {
      alive_[corner / 3] = 0;
      continue;
    }
    triangle_[corner / 3][corner % 3] = to;
    next_corner_[corner] = first_corner_[to];
    first_corner_[to] = corner;
  }
  first_corner_[from] = kNoCorner;
  locked_[from] = 1;
  quadric_[to].Add(quadric_[from]);
  ++version_[from];
  // The neighbours' edges have changed, and with them what keeps their topology and shape.
  Enqueue(to);
  for (const uint32_t v : ring_) {
    if (v != to) Enqueue(v);
  }
}

double EdgeCollapse::Run(double max_error_m) {
  max_error2_ = max_error_m * max_error_m;
  double worst2 = 0.0;
  for (uint32_t v = 0; v < position_.size(); ++v) Enqueue(v);
  std::vector<Step> steps;
  while (!queue_.empty()) {
    const Entry entry = queue_.top();
    queue_.pop();
    if (entry.version != version_[entry.vertex]) continue;
    GatherRing(entry.vertex);
    steps.clear();
    for (const uint32_t v : ring_) {
      const Step step = StepTo(entry.vertex, v);
      // What closes a hole stays apart from what was seen.
      if (step.error2 <= max_error2_ && mesh_.filled[v] == mesh_.filled[entry.vertex]) steps.push_back(step);
    }
    std::sort(steps.begin(), steps.end(), [](const Step& a, const Step& b) { return a.order != b.order ? a.order < b.order : a.to < b.to; });
    for (const Step& step : steps) {
      // Steps before the entry's order were tried when it was made.
      if (step.order < entry.order || !KeepsShape(entry.vertex, step.to) || !KeepsTopology(entry.vertex, step.to)) continue;
      if (step.order > entry.order && !queue_.empty() && step.order > queue_.top().order) {
        queue_.push({step.order, entry.vertex, entry.version});
      } else {
        worst2 = std::max(worst2, step.error2);
        Collapse(entry.vertex, step.to);
      }
      break;
    }
  }
  return std::sqrt(worst2);
}

std::vector<Triangle> EdgeCollapse::Triangles() const {
  std::vector<Triangle> left;
  left.reserve(static_cast<size_t>(std::count(alive_.begin(), alive_.end(), 1)));
  for (size_t t = 0; t < triangle_.size(); ++t) {
    if (alive_[t] != 0) left.push_back(triangle_[t]);
  }
  return left;
}

}  // namespace skyquilt::surface
