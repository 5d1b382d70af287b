#include "products/photo_map/map_nodes.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/cancel.h"
#include "core/base/order_statistics.h"
#include "core/base/progress.h"
#include "core/survey/picture_colors.h"
#include "products/photo_map/node_views.h"
#include "products/photo_map/photo_choice.h"
#include "products/photo_map/seam_labels.h"

namespace skyquilt::products {
namespace {

constexpr int kTileNodes = 96;     // whose photos are chosen together
constexpr int kOverlapNodes = 16;  // of tiles, in which seams of neighbours come to agree
constexpr int kCandidates = kMostSeen;
constexpr float kSmoothness = 2.0F;  // of seams, against the cost of views
constexpr float kMovedCost = 2.0F;   // of a photo that shows something else than the others do: more than any view costs
constexpr float kBesideMovedCost = 0.5F;
constexpr float kLeastDeviation = 0.035F;  // of display values that agree
constexpr float kOutlierFactor = 3.0F;

// Views of a node with the colours of what they show.
struct NodeCandidate {
  NodeView view;
  Colors color{};
  float cost = 0.0F;
  bool moved = false;
};

// Marks the candidates that are far from what the others and the field show.
void MarkMoved(std::vector<NodeCandidate>& candidates, const std::optional<Colors>& field) {
  if (candidates.size() + (field ? 1 : 0) < 3) return;
  Colors middle{};
  for (size_t k = 0; k < 3; ++k) {
    std::vector<double> values;
    for (const NodeCandidate& candidate : candidates) values.push_back(static_cast<double>(candidate.color[k]));
    if (field) values.push_back(static_cast<double>((*field)[k]));
    middle[k] = static_cast<float>(base::Median(values));
  }
  const auto distance = [](const Colors& a, const Colors& b) {
    return std::max({std::abs(a[0] - b[0]), std::abs(a[1] - b[1]), std::abs(a[2] - b[2])});
  };
  std::vector<double> distances;
  for (const NodeCandidate& candidate : candidates) distances.push_back(static_cast<double>(distance(candidate.color, middle)));
  const float deviation = std::max(kLeastDeviation, static_cast<float>(base::kMadToSigma * base::Median(distances)));
  for (NodeCandidate& candidate : candidates) {
    candidate.moved = distance(candidate.color, middle) > kOutlierFactor * deviation &&
                      (!field || distance(candidate.color, *field) > kOutlierFactor * kLeastDeviation);
  }
}

// Nodes of one tile and around it.
class TileOfNodes {
 public:
  TileOfNodes(const PhotoMapInput& input, const MapNodes& nodes, int tile_column, int tile_row)
      : input_(input),
        core_column_(tile_column * kTileNodes),
        core_row_(tile_row * kTileNodes),
        column_(std::max(core_column_ - kOverlapNodes, 0)),
        row_(std::max(core_row_ - kOverlapNodes, 0)),
        columns_(std::min(core_column_ + kTileNodes + kOverlapNodes, nodes.columns) - column_),
        rows_(std::min(core_row_ + kTileNodes + kOverlapNodes, nodes.rows) - row_),
        candidates_(static_cast<size_t>(columns_) * static_cast<size_t>(rows_)),
        seen_(candidates_.size(), 0) {}

  void FindCandidates(const ViewFinder& finder, const PhotoLight& light, survey::PhotoPictures& small) {
    const CellPlaces places(input_.grid, input_.projection, kNodeCells * column_, kNodeCells * row_, kNodeCells * columns_, kNodeCells * rows_);
    const Eigen::Vector2d centre_cell(kNodeCells * (column_ + 0.5 * columns_), kNodeCells * (row_ + 0.5 * rows_));
    const double radius_m = 0.5 * kNodeCells * input_.grid.resolution_m * std::hypot(columns_, rows_);
    const std::vector<int32_t> around = finder.Around(places.At(centre_cell.x(), centre_cell.y(), MiddleHeight()), radius_m);
    std::vector<std::shared_ptr<const survey::PhotoPicture>> held(input_.survey.photos.size());
    std::vector<NodeView> views;
    for (int y = 0; y < rows_; ++y) {
      for (int x = 0; x < columns_; ++x) {
        const Eigen::Vector2d cell = NodeCell(column_ + x, row_ + y);
        const Eigen::Vector2d position = input_.grid.CellCentre(cell.x(), cell.y());
        const double height_m = input_.surface.HeightAt(position);
        if (!std::isfinite(height_m)) continue;
        const Eigen::Vector3d place_map(position.x(), position.y(), height_m);
        seen_[Index(x, y)] = static_cast<uint8_t>(finder.Find(places.At(cell.x(), cell.y(), height_m), place_map, around, kCandidates, &views));
        std::vector<NodeCandidate>& candidates = candidates_[Index(x, y)];
        for (const NodeView& view : views) {
          const auto photo = static_cast<size_t>(view.photo);
          const std::optional<Colors> color = SmallColor(input_, small, view, &held[photo]);
          if (!color) continue;
          const std::array<float, 3> factors = light.At(photo, static_cast<size_t>(input_.survey.photos[photo].camera), Radius2Of(input_, view));
          candidates.push_back({view, survey::InLight(*color, factors), static_cast<float>(view.cost), false});
        }
        MarkMoved(candidates, FieldColor(input_, position));
      }
    }
    RaiseCosts();
  }

  // Only nodes of the core are written.
  void Choose(MapNodes* nodes) const {
    LabelLattice lattice;
    lattice.columns = columns_;
    lattice.rows = rows_;
    lattice.candidates = kCandidates;
    const size_t places = candidates_.size() * kCandidates;
    lattice.label.assign(places, -1);
    lattice.cost.assign(places, 0.0F);
    lattice.rgb.assign(3 * places, 0.0F);
    for (size_t node = 0; node < candidates_.size(); ++node) {
      for (size_t k = 0; k < candidates_[node].size(); ++k) {
        const NodeCandidate& candidate = candidates_[node][k];
        const size_t place = node * kCandidates + k;
        lattice.label[place] = candidate.view.photo;
        lattice.cost[place] = candidate.cost;
        std::copy(candidate.color.begin(), candidate.color.end(), lattice.rgb.begin() + static_cast<std::ptrdiff_t>(3 * place));
      }
    }
    const std::vector<int8_t> chosen = ChooseLabels(lattice, kSmoothness);
    for (int y = std::max(core_row_ - row_, 0); y < std::min(core_row_ - row_ + kTileNodes, rows_); ++y) {
      for (int x = core_column_ - column_; x < std::min(core_column_ - column_ + kTileNodes, columns_); ++x) {
        const std::vector<NodeCandidate>& candidates = candidates_[Index(x, y)];
        const size_t node = nodes->Index(column_ + x, row_ + y);
        nodes->seen[node] = seen_[Index(x, y)];
        const int8_t best = chosen[Index(x, y)];
        if (best < 0) continue;
        std::vector<std::pair<float, int32_t>> others;
        for (size_t k = 0; k < candidates.size(); ++k) {
          if (k != static_cast<size_t>(best)) others.emplace_back(candidates[k].cost, candidates[k].view.photo);
        }
        std::sort(others.begin(), others.end());
        nodes->photos[node][0] = candidates[static_cast<size_t>(best)].view.photo;
        for (size_t k = 0; k < std::min(others.size(), kKeptChoices - 1); ++k) nodes->photos[node][k + 1] = others[k].second;
      }
    }
  }

 private:
  size_t Index(int x, int y) const { return static_cast<size_t>(y) * static_cast<size_t>(columns_) + static_cast<size_t>(x); }

  double MiddleHeight() const {
    std::vector<double> heights;
    for (int y = 0; y < rows_; y += 8) {
      for (int x = 0; x < columns_; x += 8) {
        const Eigen::Vector2d cell = NodeCell(column_ + x, row_ + y);
        const double height_m = input_.surface.HeightAt(input_.grid.CellCentre(cell.x(), cell.y()));
        if (std::isfinite(height_m)) heights.push_back(height_m);
      }
    }
    return heights.empty() ? 0.0 : base::Median(heights);
  }

  // What moved reaches into the nodes beside it, where it is too small to be seen.
  void RaiseCosts() {
    for (int y = 0; y < rows_; ++y) {
      for (int x = 0; x < columns_; ++x) {
        for (NodeCandidate& candidate : candidates_[Index(x, y)]) {
          if (candidate.moved) {
            candidate.cost += kMovedCost;
          } else if (MovedBeside(x, y, candidate.view.photo)) {
            candidate.cost += kBesideMovedCost;
          }
        }
      }
    }
  }

  bool MovedBeside(int x, int y, int32_t photo) const {
    for (int v = std::max(y - 1, 0); v <= std::min(y + 1, rows_ - 1); ++v) {
      for (int u = std::max(x - 1, 0); u <= std::min(x + 1, columns_ - 1); ++u) {
        for (const NodeCandidate& candidate : candidates_[Index(u, v)]) {
          if (candidate.view.photo == photo && candidate.moved) return true;
        }
      }
    }
    return false;
  }

  const PhotoMapInput& input_;
  int core_column_, core_row_;
  int column_, row_, columns_, rows_;
  std::vector<std::vector<NodeCandidate>> candidates_;
  std::vector<uint8_t> seen_;  // per node, as MapNodes::seen
};

}  // namespace

MapNodes MapNodes::Of(const gis::MapGrid& grid) {
  MapNodes nodes;
  nodes.columns = (grid.width + kNodeCells - 1) / kNodeCells;
  nodes.rows = (grid.height + kNodeCells - 1) / kNodeCells;
  std::array<int32_t, kKeptChoices> none{};
  none.fill(-1);
  nodes.photos.assign(nodes.Index(0, nodes.rows), none);
  nodes.seen.assign(nodes.photos.size(), 0);
  return nodes;
}

Eigen::Vector2d NodeCell(int column, int row) {
  return {kNodeCells * column + 0.5 * (kNodeCells - 1), kNodeCells * row + 0.5 * (kNodeCells - 1)};
}

gis::MapGrid MapNodes::GridOf(const gis::MapGrid& map) const {
  gis::MapGrid grid = map;
  grid.resolution_m = kNodeCells * map.resolution_m;
  grid.width = columns;
  grid.height = rows;
  return grid;
}

CellPlaces::CellPlaces(const gis::MapGrid& grid, const gis::MapProjection& projection, int column, int row, int columns, int rows)
    : column_(column), row_(row), width_(std::max(columns, 1)), height_(std::max(rows, 1)), start_height_m_(projection.start_height_m()) {
  for (size_t i = 0; i < 4; ++i) {
    corners_[i] = projection.VerticalLineAt(grid.CellCentre(column_ + (i % 2 == 0 ? 0.0 : width_), row_ + (i < 2 ? 0.0 : height_)));
  }
}

Eigen::Vector3d CellPlaces::At(double column, double row, double height_m) const {
  const double u = (column - column_) / width_, v = (row - row_) / height_;
  const std::array<double, 4> weights = {(1.0 - u) * (1.0 - v), u * (1.0 - v), (1.0 - u) * v, u * v};
  Eigen::Vector3d start = Eigen::Vector3d::Zero(), down = Eigen::Vector3d::Zero();
  for (size_t i = 0; i < 4; ++i) {
    start += weights[i] * corners_[i].start_enu;
    down += weights[i] * corners_[i].down_enu;
  }
  return start + (start_height_m_ - height_m) * down;
}

std::vector<Eigen::Vector3d> EyesOnMap(const survey::Survey& survey, const gis::MapProjection& projection) {
  std::vector<Eigen::Vector3d> eyes;
  eyes.reserve(survey.photos.size());
  for (const survey::Photo& photo : survey.photos) eyes.push_back(projection.MapFromEnu(photo.cam_from_enu.OriginInSource()));
  return eyes;
}

MapNodes ChoosePhotosOfNodes(const PhotoMapInput& input, const PhotoLight& light, survey::PhotoPictures& small, base::ThreadPool& threads) {
  MapNodes nodes = MapNodes::Of(input.grid);
  const ViewFinder finder(input);
  const int tile_columns = (nodes.columns + kTileNodes - 1) / kTileNodes, tile_rows = (nodes.rows + kTileNodes - 1) / kTileNodes;
  base::Progress progress("seams", static_cast<double>(tile_columns) * tile_rows, "tiles");
  threads.ParallelFor(static_cast<int64_t>(tile_columns) * tile_rows, [&](int64_t task, int /*thread*/) {
    base::ThrowIfCancelled();
    TileOfNodes tile(input, nodes, static_cast<int>(task) % tile_columns, static_cast<int>(task) / tile_columns);
    tile.FindCandidates(finder, light, small);
    tile.Choose(&nodes);
    progress.Advance();
  });
  progress.Finish();
  return nodes;
}

}  // namespace skyquilt::products
