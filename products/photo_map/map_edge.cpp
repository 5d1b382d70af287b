#include "products/photo_map/map_edge.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <unordered_map>
#include <utility>

#include "core/base/errors.h"
#include "core/gis/vector_layers.h"

namespace skyquilt::products {
namespace {

using Ring = std::vector<Eigen::Vector2d>;

constexpr double kLeastPart = 0.01;  // of the area of the largest part
constexpr double kNotch = 0.01;      // notches up to twice this wide, of the square root of that area, are filled
constexpr int kLeastNotch = 2;       // cells
constexpr int kBlur = 2;             // cells on each side: 5 x 5, twice, so that diagonal edges have no stairs
constexpr double kSimplify = 0.25;   // cells
constexpr double kNoneNear = 1e18;   // squared distance where there is nothing

// A raster with room around it, in cells; rows go south.
struct Cells {
  int width = 0, height = 0;
  std::vector<uint8_t> inside;

  size_t At(int x, int y) const { return static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x); }
};

// Squared distances of the cells of one line to the nearest of the cells in it whose own squared distance is given (Felzenszwalb and Huttenlocher
// 2012: the lower envelope of parabolas).
void AlongLine(const std::vector<double>& given, std::vector<int>* roots, std::vector<double>* begins, std::vector<double>* found) {
  const int n = static_cast<int>(given.size());
  const auto value = [&](int i) { return given[static_cast<size_t>(i)] + double{1} * i * i; };
  roots->clear();
  begins->clear();
  for (int i = 0; i < n; ++i) {
    if (given[static_cast<size_t>(i)] >= kNoneNear) continue;
    double begin = -std::numeric_limits<double>::infinity();
    while (!roots->empty()) {
      const int before = roots->back();
      begin = (value(i) - value(before)) / (2.0 * (i - before));
      if (begin > begins->back()) break;
      roots->pop_back();
      begins->pop_back();
      begin = -std::numeric_limits<double>::infinity();
    }
    roots->push_back(i);
    begins->push_back(begin);
  }
  size_t k = 0;
  for (int i = 0; i < n; ++i) {
    if (roots->empty()) {
      (*found)[static_cast<size_t>(i)] = kNoneNear;
      continue;
    }
    while (k + 1 < roots->size() && (*begins)[k + 1] < i) ++k;
    const double away = i - (*roots)[k];
    (*found)[static_cast<size_t>(i)] = away * away + given[static_cast<size_t>((*roots)[k])];
  }
}

// Squared distance in cells from each cell's centre to the nearest centre of a cell that is inside, or outside.
std::vector<double> SquaredDistances(const Cells& cells, bool to_inside) {
  std::vector<double> squared(cells.inside.size());
  std::vector<int> roots;
  std::vector<double> begins, line(static_cast<size_t>(cells.height)), found(line.size());
  for (int x = 0; x < cells.width; ++x) {
    for (int y = 0; y < cells.height; ++y) line[static_cast<size_t>(y)] = (cells.inside[cells.At(x, y)] != 0) == to_inside ? 0.0 : kNoneNear;
    AlongLine(line, &roots, &begins, &found);
    for (int y = 0; y < cells.height; ++y) squared[cells.At(x, y)] = found[static_cast<size_t>(y)];
  }
  line.resize(static_cast<size_t>(cells.width));
  found.resize(line.size());
  for (int y = 0; y < cells.height; ++y) {
    const auto row = squared.begin() + static_cast<std::ptrdiff_t>(cells.At(0, y));
    std::copy(row, row + cells.width, line.begin());
    AlongLine(line, &roots, &begins, &found);
    std::copy(found.begin(), found.end(), row);
  }
  return squared;
}

struct Parts {
  std::vector<int> part;      // of each cell; -1: none
  std::vector<size_t> cells;  // of each part
};

// Parts that are connected by edges, of the cells that are inside or of the others. Part 0 of the others is what lies around everything, because
// the corner is scanned first.
Parts PartsOf(const Cells& cells, bool of_inside) {
  Parts parts;
  parts.part.assign(cells.inside.size(), -1);
  std::vector<std::pair<int, int>> open;
  const auto visit = [&](int x, int y, int part) {
    if (x < 0 || y < 0 || x >= cells.width || y >= cells.height) return;
    const size_t at = cells.At(x, y);
    if ((cells.inside[at] != 0) != of_inside || parts.part[at] >= 0) return;
    parts.part[at] = part;
    ++parts.cells.back();
    open.emplace_back(x, y);
  };
  for (int y = 0; y < cells.height; ++y) {
    for (int x = 0; x < cells.width; ++x) {
      const size_t at = cells.At(x, y);
      if ((cells.inside[at] != 0) != of_inside || parts.part[at] >= 0) continue;
      const int part = static_cast<int>(parts.cells.size());
      parts.cells.push_back(0);
      visit(x, y, part);
      while (!open.empty()) {
        const auto [u, v] = open.back();
        open.pop_back();
        visit(u - 1, v, part);
        visit(u + 1, v, part);
        visit(u, v - 1, part);
        visit(u, v + 1, part);
      }
    }
  }
  return parts;
}

size_t Largest(const Parts& parts) {
  return parts.cells.empty() ? 0 : *std::max_element(parts.cells.begin(), parts.cells.end());
}

// Takes small parts away. Returns the cells of the largest one.
size_t DropSpecks(Cells* cells) {
  const Parts parts = PartsOf(*cells, true);
  const size_t largest = Largest(parts);
  for (size_t i = 0; i < cells->inside.size(); ++i) {
    if (parts.part[i] >= 0 && static_cast<double>(parts.cells[static_cast<size_t>(parts.part[i])]) < kLeastPart * static_cast<double>(largest))
      cells->inside[i] = 0;
  }
  return largest;
}

// Closes the mask by a disc: what lies within the radius of it, less what lies within the radius of the rest.
void FillNotches(int radius, Cells* cells) {
  const double squared = double{1} * radius * radius;
  const std::vector<double> to_inside = SquaredDistances(*cells, true);
  for (size_t i = 0; i < to_inside.size(); ++i) cells->inside[i] = to_inside[i] <= squared ? 1 : 0;
  const std::vector<double> to_outside = SquaredDistances(*cells, false);
  for (size_t i = 0; i < to_outside.size(); ++i) cells->inside[i] = to_outside[i] > squared ? 1 : 0;
}

void FillHoles(Cells* cells) {
  const double least = kLeastPart * static_cast<double>(Largest(PartsOf(*cells, true)));
  const Parts others = PartsOf(*cells, false);
  for (size_t i = 0; i < cells->inside.size(); ++i) {
    if (others.part[i] > 0 && static_cast<double>(others.cells[static_cast<size_t>(others.part[i])]) < least) cells->inside[i] = 1;
  }
}

// Means of 2 * kBlur + 1 values along a line, in place; beyond its ends its last values go on.
void BlurLine(std::vector<double>* line) {
  const int n = static_cast<int>(line->size());
  const std::vector<double> before = *line;
  for (int i = 0; i < n; ++i) {
    double sum = 0.0;
    for (int k = -kBlur; k <= kBlur; ++k) sum += before[static_cast<size_t>(std::clamp(i + k, 0, n - 1))];
    (*line)[static_cast<size_t>(i)] = sum / (2 * kBlur + 1);
  }
}

// Distance in cells to the border of the mask, which runs half-way between centres inside and outside; negative outside. Blurred: straight edges stay
// where they are, because distances are linear across them.
std::vector<double> DepthInside(const Cells& cells) {
  std::vector<double> depth = SquaredDistances(cells, false);
  {
    const std::vector<double> outside = SquaredDistances(cells, true);
    for (size_t i = 0; i < depth.size(); ++i) depth[i] = cells.inside[i] != 0 ? std::sqrt(depth[i]) - 0.5 : 0.5 - std::sqrt(outside[i]);
  }
  std::vector<double> line;
  for (int pass = 0; pass < 2; ++pass) {
    for (int y = 0; y < cells.height; ++y) {
      const auto row = depth.begin() + static_cast<std::ptrdiff_t>(cells.At(0, y));
      line.assign(row, row + cells.width);
      BlurLine(&line);
      std::copy(line.begin(), line.end(), row);
    }
    line.resize(static_cast<size_t>(cells.height));
    for (int x = 0; x < cells.width; ++x) {
      for (int y = 0; y < cells.height; ++y) line[static_cast<size_t>(y)] = depth[cells.At(x, y)];
      BlurLine(&line);
      for (int y = 0; y < cells.height; ++y) depth[cells.At(x, y)] = line[static_cast<size_t>(y)];
    }
  }
  return depth;
}

// Marching squares: rings along which a field of cell centres is `level`, linear between centres, higher values on the left when north is up. In
// cells.
std::vector<Ring> RingsAt(const Cells& cells, const std::vector<double>& field, double level) {
  // Never just on the level, so that no two points of rings coincide.
  const auto above = [&](int x, int y) {
    const double value = field[cells.At(x, y)] - level;
    return value > 0.0 ? std::max(value, 1e-6) : std::min(value, -1e-6);
  };
  struct Step {
    int64_t to = 0;
    Eigen::Vector2d from_at;
  };
  std::unordered_map<int64_t, Step> steps;  // by the edge between two centres where a segment begins
  std::vector<int64_t> begins;              // in scanning order, so that rings have an order
  for (int y = 0; y + 1 < cells.height; ++y) {
    for (int x = 0; x + 1 < cells.width; ++x) {
      // Corners clockwise from the north-west; edge i goes from corner i to the next.
      const std::array<Eigen::Vector2i, 4> corner = {{{x, y}, {x + 1, y}, {x + 1, y + 1}, {x, y + 1}}};
      const auto id = [&](int px, int py, bool down) { return 2 * static_cast<int64_t>(cells.At(px, py)) + (down ? 1 : 0); };
      const std::array<int64_t, 4> edge = {id(x, y, false), id(x + 1, y, true), id(x, y + 1, false), id(x, y, true)};
      std::array<double, 4> value{};
      int inside = 0;
      for (size_t i = 0; i < 4; ++i) {
        value[i] = above(corner[i].x(), corner[i].y());
        inside += value[i] > 0.0 ? 1 : 0;
      }
      if (inside == 0 || inside == 4) continue;
      const auto goes_out = [&](size_t i) { return value[i] > 0.0 && value[(i + 1) % 4] < 0.0; };
      // Where opposite corners are inside, the mean decides whether they are connected.
      const bool joined = value[0] + value[1] + value[2] + value[3] > 0.0;
      for (size_t i = 0; i < 4; ++i) {
        const size_t next = (i + 1) % 4;
        if (!(value[i] < 0.0 && value[next] > 0.0)) continue;
        size_t end = next;
        while (!goes_out(end)) end = (end + 1) % 4;
        if (joined && goes_out((i + 3) % 4)) end = (i + 3) % 4;
        const double share = value[i] / (value[i] - value[next]);
        const Eigen::Vector2d a = corner[i].cast<double>(), b = corner[next].cast<double>();
        steps[edge[i]] = {edge[end], a + share * (b - a)};
        begins.push_back(edge[i]);
      }
    }
  }
  std::vector<Ring> rings;
  for (const int64_t begin : begins) {
    Ring ring;
    int64_t at = begin;
    for (auto step = steps.find(at); step != steps.end(); step = steps.find(at)) {
      ring.push_back(step->second.from_at);
      at = step->second.to;
      steps.erase(step);
    }
    if (ring.size() >= 3) rings.push_back(std::move(ring));
  }
  return rings;
}

double Cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

// Positive when counter-clockwise, for y to the north.
double RingArea(const Ring& ring) {
  double twice = 0.0;
  for (size_t i = 0; i < ring.size(); ++i) twice += Cross(ring[i] - ring[0], ring[(i + 1) % ring.size()] - ring[0]);
  return 0.5 * twice;
}

double FromSegment(const Eigen::Vector2d& p, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const double squared = (b - a).squaredNorm();
  const double share = squared > 0.0 ? std::clamp((p - a).dot(b - a) / squared, 0.0, 1.0) : 0.0;
  return (p - a - share * (b - a)).norm();
}

// Douglas and Peucker 1973, from the point farthest from the first, and the one farthest from that.
Ring FewerPoints(const Ring& ring, double tolerance) {
  const size_t n = ring.size();
  const auto farthest = [&](size_t from) {
    const auto nearer = [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
      return (a - ring[from]).squaredNorm() < (b - ring[from]).squaredNorm();
    };
    return static_cast<size_t>(std::max_element(ring.begin(), ring.end(), nearer) - ring.begin());
  };
  const size_t one = farthest(0), other = farthest(one);
  const size_t first = std::min(one, other), second = std::max(one, other);
  std::vector<bool> keep(n, false);
  keep[first] = keep[second] = true;
  std::vector<std::pair<size_t, size_t>> open = {{first, second}, {second, first + n}};
  while (!open.empty()) {
    const auto [from, to] = open.back();
    open.pop_back();
    double most = tolerance;
    size_t at = from;
    for (size_t i = from + 1; i < to; ++i) {
      const double away = FromSegment(ring[i % n], ring[from % n], ring[to % n]);
      if (away > most) {
        most = away;
        at = i;
      }
    }
    if (at == from) continue;
    keep[at % n] = true;
    open.emplace_back(from, at);
    open.emplace_back(at, to);
  }
  Ring fewer;
  for (size_t i = 0; i < n; ++i) {
    if (keep[i]) fewer.push_back(ring[i]);
  }
  return fewer;
}

// Whether any two edges of the rings meet that do not follow each other.
bool Crossing(const std::vector<Ring>& rings) {
  struct Side {
    Eigen::Vector2d a, b;
    double West() const { return std::min(a.x(), b.x()); }
    double East() const { return std::max(a.x(), b.x()); }
  };
  std::vector<Side> sides;
  for (const Ring& ring : rings) {
    if (ring.size() < 3) return true;
    for (size_t i = 0; i < ring.size(); ++i) sides.push_back({ring[i], ring[(i + 1) % ring.size()]});
  }
  std::sort(sides.begin(), sides.end(), [](const Side& e, const Side& f) { return e.West() < f.West(); });
  for (size_t i = 0; i < sides.size(); ++i) {
    const Side& e = sides[i];
    for (size_t j = i + 1; j < sides.size() && sides[j].West() <= e.East(); ++j) {
      const Side& f = sides[j];
      if (e.a == f.b || e.b == f.a) continue;
      const bool across_e = Cross(e.b - e.a, f.a - e.a) * Cross(e.b - e.a, f.b - e.a) <= 0.0;
      const bool across_f = Cross(f.b - f.a, e.a - f.a) * Cross(f.b - f.a, e.b - f.a) <= 0.0;
      if (across_e && across_f) return true;
    }
  }
  return false;
}

std::vector<Ring> Simplified(const std::vector<Ring>& rings, double tolerance) {
  // Edges of narrow places can cross; smaller tolerances are tried until they do not.
  constexpr int kTries = 6;
  for (int i = 0; i < kTries; ++i, tolerance *= 0.5) {
    std::vector<Ring> fewer;
    for (const Ring& ring : rings) fewer.push_back(FewerPoints(ring, tolerance));
    if (!Crossing(fewer)) return fewer;
  }
  return rings;
}

bool RingHolds(const Ring& ring, const Eigen::Vector2d& p) {
  bool inside = false;
  for (size_t i = 0; i < ring.size(); ++i) {
    const Eigen::Vector2d &a = ring[i], &b = ring[(i + 1) % ring.size()];
    if ((a.y() > p.y()) != (b.y() > p.y()) && p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x())) inside = !inside;
  }
  return inside;
}

}  // namespace

std::vector<std::vector<Eigen::Vector2d>> CutlineOf(const SeenLattice& seen, int least, double crop_m) {
  const gis::MapGrid& grid = seen.grid;
  SKYQUILT_CHECK(
      seen.photos.size() == grid.size() && least > 0 && crop_m >= 0.0 && std::isfinite(crop_m) && (grid.size() == 0 || grid.resolution_m > 0.0),
      std::to_string(seen.photos.size()) + ", " + std::to_string(least) + ", " + std::to_string(crop_m));
  const auto enough = [&](uint8_t photos) { return int{photos} >= least; };
  const auto count = std::count_if(seen.photos.begin(), seen.photos.end(), enough);
  if (count == 0) return {};
  // Room for the disc that closes the mask (no part is larger than all) and for blurring.
  const int room = std::max(kLeastNotch, static_cast<int>(std::ceil(kNotch * std::sqrt(static_cast<double>(count))))) + 2 * kBlur + 2;
  Cells cells{.width = grid.width + 2 * room, .height = grid.height + 2 * room, .inside = {}};
  cells.inside.assign(static_cast<size_t>(cells.width) * static_cast<size_t>(cells.height), 0);
  for (int row = 0; row < grid.height; ++row) {
    for (int column = 0; column < grid.width; ++column)
      cells.inside[cells.At(column + room, row + room)] = enough(seen.photos[grid.Index(column, row)]) ? 1 : 0;
  }
  const size_t largest = DropSpecks(&cells);
  FillNotches(std::max(kLeastNotch, static_cast<int>(std::lround(kNotch * std::sqrt(static_cast<double>(largest))))), &cells);
  FillHoles(&cells);
  std::vector<Ring> rings = RingsAt(cells, DepthInside(cells), crop_m / grid.resolution_m);
  double most = 0.0;
  for (Ring& ring : rings) {
    for (Eigen::Vector2d& p : ring) p = grid.CellCentre(p.x() - room, p.y() - room);
    most = std::max(most, RingArea(ring));
  }
  std::erase_if(rings, [&](const Ring& ring) { return !(std::abs(RingArea(ring)) >= kLeastPart * most); });
  return Simplified(rings, kSimplify * grid.resolution_m);
}

void WriteCutline(const std::vector<std::vector<Eigen::Vector2d>>& rings, const gis::MapGrid& grid, const std::filesystem::path& gpkg) {
  struct Part {
    const Ring* outer = nullptr;
    std::vector<const Ring*> holes;
    double area_m2 = 0.0;
  };
  std::vector<Part> parts;
  for (const Ring& ring : rings) {
    if (const double area = RingArea(ring); area > 0.0) parts.push_back({.outer = &ring, .holes = {}, .area_m2 = area});
  }
  // The smallest part around a hole is its own.
  std::stable_sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) { return a.area_m2 > b.area_m2; });
  for (const Ring& ring : rings) {
    if (RingArea(ring) > 0.0) continue;
    const auto around = std::find_if(parts.rbegin(), parts.rend(), [&](const Part& part) { return RingHolds(*part.outer, ring.front()); });
    SKYQUILT_CHECK(around != parts.rend(), "a hole outside all parts");
    around->holes.push_back(&ring);
  }
  gis::VectorLayer layer;
  layer.name = "cutline";
  layer.description = "Where the maps from photos end: the ground that at least two photos see, less what was cropped. area_m2: square metres.";
  layer.fields = {{.name = "area_m2", .type = gis::FieldType::kReal}};
  for (const Part& part : parts) {
    gis::LayerPolygon polygon;
    double area = part.area_m2;
    const auto add = [&polygon](const Ring& ring) {
      std::vector<Eigen::Vector3d>& points = polygon.emplace_back();
      for (const Eigen::Vector2d& p : ring) points.emplace_back(p.x(), p.y(), 0.0);
    };
    add(*part.outer);
    for (const Ring* hole : part.holes) {
      add(*hole);
      area += RingArea(*hole);
    }
    layer.features.push_back({.polygons = {std::move(polygon)}, .values = {area}});
  }
  gis::WriteVectorLayers({&layer, 1}, grid.georeferenced, grid.zone, gpkg);
}

}  // namespace skyquilt::products
