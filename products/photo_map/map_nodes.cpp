#include "products/photo_map/map_nodes.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/cancel.h"
#include "core/base/order_statistics.h"
#include "core/base/progress.h"
#include "products/photo_map/overlap_gains.h"
#include "products/photo_map/photo_choice.h"
#include "products/photo_map/picture_colors.h"
#include "products/photo_map/seam_labels.h"

namespace skyquilt::products {
namespace {

constexpr int kTileNodes = 96;     // whose photos are chosen together
constexpr int kOverlapNodes = 16;  // of tiles, in which seams of neighbours come to agree
constexpr int kCandidates = kMostSeen;
constexpr double kRimShare = 0.08;  // of the shorter side of a photo, where it gives way to others
constexpr double kRimCost = 0.02;
constexpr float kSmoothness = 2.0F;  // of seams, against the cost of views
constexpr float kMovedCost = 2.0F;   // of a photo that shows something else than the others do: more than any view costs
constexpr float kBesideMovedCost = 0.5F;
constexpr float kLeastDeviation = 0.035F;  // of display values that agree
constexpr float kOutlierFactor = 3.0F;
constexpr size_t kLightPlaces = 60000;  // at which light is measured
constexpr size_t kLightViews = 6;       // of each of them
constexpr size_t kComparedViews = 4;
constexpr float kDarkestCompared = 0.004F;  // linear light that is compared: neither noise nor clipped
constexpr float kBrightestCompared = 0.8F;
constexpr double kFlattestTangent2 = kMostOblique;

using Colors = std::array<float, 3>;

struct NodeView {
  double cost = 0.0;
  int32_t photo = -1;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  // of the full photo
};

// Finds the photos that see a place.
class ViewFinder {
 public:
  ViewFinder(const PhotoMapInput& input) : input_(input), eyes_map_(EyesOnMap(input.survey, input.projection)) {
    eyes_enu_.reserve(input.survey.photos.size());
    for (const survey::Photo& photo : input.survey.photos) eyes_enu_.push_back(photo.cam_from_enu.OriginInSource());
  }

  // Photos that may see places within radius_m of the centre.
  std::vector<int32_t> Around(const Eigen::Vector3d& centre_enu, double radius_m) const {
    std::vector<int32_t> photos;
    for (size_t i = 0; i < eyes_enu_.size(); ++i) {
      if (input_.usable[i] == 0) continue;
      const Eigen::Vector3d to_eye = eyes_enu_[i] - centre_enu;
      const double reach_m = std::sqrt(kFlattestTangent2) * (std::max(to_eye.z(), 0.0) + radius_m) + radius_m;
      if (to_eye.head<2>().squaredNorm() <= reach_m * reach_m) photos.push_back(static_cast<int32_t>(i));
    }
    return photos;
  }

  // Photos that see the place, best first, `most` at most. Where none does, those with it in their frame: cells around it may be seen. place_map: the
  // same place on the map. Returns the number of photos with it in their frame, kMostSeen at most.
  int Find(const Eigen::Vector3d& place_enu, const Eigen::Vector3d& place_map, std::span<const int32_t> photos, size_t most,
           std::vector<NodeView>* views) const {
    std::vector<NodeView> ranked;
    for (const int32_t photo : photos) {
      const double cost = ViewCost(place_enu, eyes_enu_[static_cast<size_t>(photo)], input_.flown_height_m);
      if (std::isfinite(cost)) ranked.push_back({cost, photo, {}});
    }
    std::sort(ranked.begin(), ranked.end(),
              [](const NodeView& a, const NodeView& b) { return a.cost < b.cost || (a.cost == b.cost && a.photo < b.photo); });
    views->clear();
    std::vector<NodeView> hidden;
    const double slack_m = SlackAt(place_map);
    int in_frame = 0;
    for (NodeView& view : ranked) {
      if (views->size() == most && in_frame >= kMostSeen) break;
      const survey::Photo& photo = input_.survey.photos[static_cast<size_t>(view.photo)];
      const camera::Camera& camera = input_.survey.cameras[static_cast<size_t>(photo.camera)];
      const std::optional<Eigen::Vector2d> pixel = PixelIn(camera, photo.cam_from_enu, place_enu);
      if (!pixel) continue;
      in_frame = std::min(in_frame + 1, kMostSeen);
      if (views->size() == most) continue;
      const double width = camera.width, height = camera.height;
      const double inside = std::min({pixel->x(), pixel->y(), width - pixel->x(), height - pixel->y()}) / (kRimShare * std::min(width, height));
      if (inside < 1.0) view.cost += kRimCost * (1.0 / std::max(inside, 1e-3) - 1.0);
      view.pixel = *pixel;
      const bool visible = input_.surface.IsVisible(place_map, eyes_map_[static_cast<size_t>(view.photo)], slack_m);
      (visible ? *views : hidden).push_back(view);
    }
    if (views->empty()) {
      hidden.resize(std::min(hidden.size(), most));
      *views = std::move(hidden);
    }
    return in_frame;
  }

 private:
  const PhotoMapInput& input_;
  double SlackAt(const Eigen::Vector3d& place_map) const {
    const gis::MapGrid& grid = input_.surface.grid();
    const Eigen::Vector2d cell = grid.CellOf(place_map.head<2>());
    const int column = std::clamp(static_cast<int>(std::lround(cell.x())), 0, grid.width - 1);
    const int row = std::clamp(static_cast<int>(std::lround(cell.y())), 0, grid.height - 1);
    return static_cast<double>(input_.slack_m[grid.Index(column, row)]);
  }

  std::vector<Eigen::Vector3d> eyes_enu_, eyes_map_;
};

// Colour of a photo at a pixel of the full photo, as its small picture shows it; nothing where it is masked or cannot be read.
std::optional<Colors> SmallColor(const PhotoMapInput& input, PhotoPictures& small, const NodeView& view, std::shared_ptr<const PhotoPicture>* held) {
  if (!*held) *held = small.Of(static_cast<size_t>(view.photo));
  if (!*held) return std::nullopt;
  const PhotoPicture& picture = **held;
  const camera::Camera& camera = input.survey.cameras[static_cast<size_t>(input.survey.photos[static_cast<size_t>(view.photo)].camera)];
  const Eigen::Vector2d pixel(view.pixel.x() * picture.rgb.width / camera.width, view.pixel.y() * picture.rgb.height / camera.height);
  if (IsMasked(picture, pixel)) return std::nullopt;
  return LinearAt(picture, pixel);
}

float Radius2Of(const PhotoMapInput& input, const NodeView& view) {
  return Radius2(input.survey.cameras[static_cast<size_t>(input.survey.photos[static_cast<size_t>(view.photo)].camera)], view.pixel);
}

// Mean display values of the field around a place; nothing where the field has no surface.
std::optional<Colors> FieldColor(const PhotoMapInput& input, const Eigen::Vector2d& easting_northing) {
  if (input.field_rgba.empty()) return std::nullopt;
  const gis::MapGrid& grid = input.surface.grid();
  const Eigen::Vector2d cell = grid.CellOf(easting_northing);
  const int column = static_cast<int>(std::floor(cell.x())), row = static_cast<int>(std::floor(cell.y()));
  Colors sum{};
  int n = 0;
  for (int y = row; y <= row + 1; ++y) {
    for (int x = column; x <= column + 1; ++x) {
      if (x < 0 || y < 0 || x >= grid.width || y >= grid.height) continue;
      const uint8_t* rgba = input.field_rgba.data() + 4 * grid.Index(x, y);
      if (rgba[3] == 0) return std::nullopt;
      for (size_t k = 0; k < 3; ++k) sum[k] += static_cast<float>(rgba[k]) / 255.0F;
      ++n;
    }
  }
  if (n == 0) return std::nullopt;
  for (float& value : sum) value /= static_cast<float>(n);
  return sum;
}

// Linear light that can be compared; NaN otherwise.
Colors Comparable(const Colors& display) {
  Colors light{};
  for (size_t k = 0; k < 3; ++k) {
    const float value = QuickLight(display[k]);
    light[k] = value > kDarkestCompared && value < kBrightestCompared ? value : std::numeric_limits<float>::quiet_NaN();
  }
  return light;
}

Eigen::Vector2d NodeCell(int column, int row) {
  return {kNodeCells * column + 0.5 * (kNodeCells - 1), kNodeCells * row + 0.5 * (kNodeCells - 1)};
}

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

  void FindCandidates(const ViewFinder& finder, const PhotoLight& light, PhotoPictures& small) {
    const CellPlaces places(input_.grid, input_.projection, kNodeCells * column_, kNodeCells * row_, kNodeCells * columns_, kNodeCells * rows_);
    const Eigen::Vector2d centre_cell(kNodeCells * (column_ + 0.5 * columns_), kNodeCells * (row_ + 0.5 * rows_));
    const double radius_m = 0.5 * kNodeCells * input_.grid.resolution_m * std::hypot(columns_, rows_);
    const std::vector<int32_t> around = finder.Around(places.At(centre_cell.x(), centre_cell.y(), MiddleHeight()), radius_m);
    std::vector<std::shared_ptr<const PhotoPicture>> held(input_.survey.photos.size());
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
          candidates.push_back({view, InLight(*color, factors), static_cast<float>(view.cost), false});
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

MapNodes EmptyNodes(const gis::MapGrid& grid) {
  MapNodes nodes;
  nodes.columns = (grid.width + kNodeCells - 1) / kNodeCells;
  nodes.rows = (grid.height + kNodeCells - 1) / kNodeCells;
  std::array<int32_t, kKeptChoices> none{};
  none.fill(-1);
  nodes.photos.assign(nodes.Index(0, nodes.rows), none);
  nodes.seen.assign(nodes.photos.size(), 0);
  return nodes;
}

// Places at which light is measured: nodes in a regular pattern, in rows.
struct LightPlaces {
  std::vector<Eigen::Vector3d> enu, map;
};

LightPlaces PlacesForLight(const PhotoMapInput& input) {
  const MapNodes nodes = EmptyNodes(input.grid);
  const int step = std::max(1, static_cast<int>(std::ceil(std::sqrt(static_cast<double>(nodes.photos.size()) / kLightPlaces))));
  LightPlaces places;
  for (int row = 0; row < nodes.rows; row += step) {
    for (int column = 0; column < nodes.columns; column += step) {
      const Eigen::Vector2d cell = NodeCell(column, row);
      const Eigen::Vector2d position = input.grid.CellCentre(cell.x(), cell.y());
      const double height_m = input.surface.HeightAt(position);
      if (!std::isfinite(height_m)) continue;
      const gis::MapProjection::VerticalLine line = input.projection.VerticalLineAt(position);
      places.enu.emplace_back(line.start_enu + (input.projection.start_height_m() - height_m) * line.down_enu);
      places.map.emplace_back(position.x(), position.y(), height_m);
    }
  }
  return places;
}

}  // namespace

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

PhotoLight MeasureLight(const PhotoMapInput& input, PhotoPictures& small, base::ThreadPool& threads) {
  const ViewFinder finder(input);
  const LightPlaces places = PlacesForLight(input);
  const size_t photos = input.survey.photos.size();
  constexpr size_t kPerTask = 512;
  const size_t tasks = (places.enu.size() + kPerTask - 1) / kPerTask;
  std::vector<std::vector<LightSample>> samples(tasks);
  std::vector<std::vector<OverlapRatio>> ratios(tasks);
  std::vector<int32_t> all;
  for (size_t i = 0; i < photos; ++i) {
    if (input.usable[i] != 0) all.push_back(static_cast<int32_t>(i));
  }
  base::Progress progress("light of the photos", static_cast<double>(tasks), "parts");
  threads.ParallelFor(static_cast<int64_t>(tasks), [&](int64_t task_index, int /*thread*/) {
    base::ThrowIfCancelled();
    const auto task = static_cast<size_t>(task_index);
    std::vector<NodeView> views;
    for (size_t i = task * kPerTask; i < std::min((task + 1) * kPerTask, places.enu.size()); ++i) {
      finder.Find(places.enu[i], places.map[i], all, kLightViews, &views);
      const std::optional<Colors> field = FieldColor(input, places.map[i].head<2>());
      const Colors wanted = field ? Comparable(*field) : Colors{};
      std::vector<std::pair<int32_t, Colors>> shown;
      for (const NodeView& view : views) {
        std::shared_ptr<const PhotoPicture> held;
        const std::optional<Colors> color = SmallColor(input, small, view, &held);
        if (!color) continue;
        const Colors light = Comparable(*color);
        shown.emplace_back(view.photo, light);
        if (!field) continue;
        LightSample sample{view.photo, Radius2Of(input, view), {}};
        for (size_t k = 0; k < 3; ++k) sample.log_ratio[k] = std::log(wanted[k] / light[k]);
        samples[task].push_back(sample);
      }
      if (!input.field_rgba.empty()) continue;
      for (size_t a = 0; a < std::min(shown.size(), kComparedViews); ++a) {
        for (size_t b = a + 1; b < std::min(shown.size(), kComparedViews); ++b) {
          OverlapRatio ratio{shown[a].first, shown[b].first, {}};
          for (size_t k = 0; k < 3; ++k) ratio.log_ratio[k] = std::log(shown[a].second[k] / shown[b].second[k]);
          ratios[task].push_back(ratio);
        }
      }
    }
    progress.Advance();
  });
  progress.Finish();
  if (input.field_rgba.empty()) {
    std::vector<OverlapRatio> joined;
    for (const auto& part : ratios) joined.insert(joined.end(), part.begin(), part.end());
    PhotoLight light = PhotoLight::None(photos, input.survey.cameras.size());
    const std::vector<std::array<float, 3>> log_gains = GainsOfOverlaps(photos, joined);
    for (size_t i = 0; i < photos; ++i) {
      for (size_t k = 0; k < 3; ++k) light.gain[i][k] = std::exp(log_gains[i][k]);
    }
    return light;
  }
  std::vector<LightSample> joined;
  for (const auto& part : samples) joined.insert(joined.end(), part.begin(), part.end());
  std::vector<int> camera_of_photo;
  for (const survey::Photo& photo : input.survey.photos) camera_of_photo.push_back(photo.camera);
  return FitLight(joined, camera_of_photo, input.survey.cameras.size());
}

MapNodes ChoosePhotosOfNodes(const PhotoMapInput& input, const PhotoLight& light, PhotoPictures& small, base::ThreadPool& threads) {
  MapNodes nodes = EmptyNodes(input.grid);
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
