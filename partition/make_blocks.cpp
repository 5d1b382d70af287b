#include "partition/make_blocks.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/order_statistics.h"
#include "partition/altitude.h"
#include "partition/auto_grid.h"
#include "partition/block_grid.h"
#include "partition/capacity.h"
#include "partition/seen_gsd.h"
#include "partition/survey_area.h"
#include "partition/vertical_range.h"
#include "partition/visibility.h"

namespace skyquilt::partition {
namespace {

// A block gets headroom when at least this share of its ground has no sparse points.
constexpr double kGap = 0.3;

// Read by all steps below, complete before the first.
struct Inputs {
  const survey::Survey& survey;
  const PartitionOptions& options;
  int image_width;
  std::vector<Eigen::Vector3d> points;
  SurveyArea area;
  std::vector<PhotoAltitude> altitudes;  // of the training photos
  std::vector<SeenPoint> seen;
  // Of a grid that goes on from an earlier one: its margin, and what its first row and column are called.
  std::optional<double> margin_m = {};
  int first_row = 0, first_column = 0;
};

double MarginOf(const Inputs& in, const BlockGrid& grid) {
  if (in.margin_m) return *in.margin_m;
  const double side = (grid.Max(0, 0) - grid.Min(0, 0)).minCoeff();
  return std::min(std::max(kMarginFraction * side, kMinMargin_m), 0.25 * side);
}

// The lowest height whose pixels the block may have: of the flight above it, or of its lowest photos.
double LowestAltitude(const Inputs& in, double flown_agl_m) {
  constexpr double kLowest = 0.05;
  std::vector<double> agl_m;
  for (const PhotoAltitude& photo : in.altitudes) agl_m.push_back(photo.agl_m);
  return std::min(flown_agl_m, base::Quantile(std::move(agl_m), kLowest));
}

// Of a block whose photos were taken from this height, by the points in it; by the height where they are too few (NaN).
double FlownGsd(const Inputs& in, double flown_agl_m, double seen_gsd_m) {
  return std::isfinite(seen_gsd_m) ? seen_gsd_m : SurveyGsd(in.survey, flown_agl_m, in.image_width);
}

double VoxelsOf(const Inputs& in, const BlockGrid& grid, int index, double voxel_m) {
  const Eigen::Vector2d margin = Eigen::Vector2d::Constant(MarginOf(in, grid));
  return SurfaceVoxels(in.area, in.points, grid.Min(index) - margin, grid.Max(index) + margin, voxel_m);
}

void CheckAltitudeCount(const PartitionOptions& options, int rows, int columns) {
  const size_t n_blocks = static_cast<size_t>(rows) * static_cast<size_t>(columns);
  if (options.altitudes.empty() || options.altitudes.size() == n_blocks) return;
  throw base::UsageError("partition.altitudes has " + std::to_string(options.altitudes.size()) + " altitude(s) but partition.blocks = \"" +
                         options.blocks + "\" gives " + std::to_string(n_blocks) + " block(s) (" + std::to_string(rows) + " row(s) x " +
                         std::to_string(columns) + " column(s)); give one per block in row-major order from the south-west");
}

// Fills in everything that does not depend on the photos that see the block. seen_gsd_m: as in FlownGsd.
Block MakeBlock(const Inputs& in, const BlockGrid& grid, int index, double seen_gsd_m) {
  Block block;
  block.id = index;
  block.name = fmt::format("r{}c{}", in.first_row + index / grid.columns(), in.first_column + index % grid.columns());
  block.margin_m = MarginOf(in, grid);
  block.flown_agl_m = BlockAltitude(in.altitudes, grid.Min(index), grid.Max(index));
  block.altitude_agl_m = block.flown_agl_m;
  block.gsd_m = FlownGsd(in, block.flown_agl_m, seen_gsd_m);
  if (!in.options.altitudes.empty()) {
    block.altitude_agl_m = in.options.altitudes[static_cast<size_t>(index)];
    // Voxels far finer than the photos' pixels cannot be told apart by them.
    const double sharpest_m = std::min(block.gsd_m, SurveyGsd(in.survey, LowestAltitude(in, block.flown_agl_m), in.image_width));
    block.gsd_m = std::max(SurveyGsd(in.survey, block.altitude_agl_m, in.image_width), sharpest_m);
  }
  block.finest_voxel_m = in.options.voxel_per_gsd * block.gsd_m;
  block.min_enu.head<2>() = grid.Min(index);
  block.max_enu.head<2>() = grid.Max(index);
  const Eigen::Vector2d margin = Eigen::Vector2d::Constant(block.margin_m);
  const auto range = VerticalRange(in.points, grid.Min(index) - margin, grid.Max(index) + margin, block.gsd_m);
  const double half_height_m = 40.0 * block.gsd_m;  // for a block without points
  block.min_enu.z() = range ? range->first : in.area.ground_m - half_height_m;
  block.max_enu.z() = range ? range->second : in.area.ground_m + half_height_m;
  // Where there are no points, trees or roofs may be far higher than the points elsewhere.
  if (ShareWithoutSparsePoints(in.points, grid.Min(index), grid.Max(index)) >= kGap) {
    block.max_enu.z() += in.options.headroom * block.altitude_agl_m;
  }
  const bool has_points =
      std::any_of(in.points.begin(), in.points.end(), [&](const Eigen::Vector3d& x) { return grid.CellOf(x.x(), x.y()) == index; });
  if (!range || !has_points) {
    block.empty = true;
    block.empty_reason = "no sparse point is inside it";
  }
  return block;
}

void AddViews(Block& block, BoxVisibility views, double surface_voxels, const PartitionOptions& options) {
  if (!block.empty && views.photos.size() < 2) {
    block.empty = true;
    block.empty_reason = views.photos.empty() ? "no training photo sees it" : "only one training photo sees it";
  }
  if (block.empty) return;
  block.photos = std::move(views.photos);
  block.expected_pixels = views.training_pixels;
  block.log2_table_size = Log2TableSize(surface_voxels, options);
  block.cost = std::sqrt(views.training_pixels * surface_voxels);
}

// All blocks get the lowest ground and the highest roof of any block.
void UseCommonHeights(std::vector<Block>& blocks) {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const Block& block : blocks) {
    if (block.empty) continue;
    low = std::min(low, block.min_enu.z());
    high = std::max(high, block.max_enu.z());
  }
  for (Block& block : blocks) {
    if (block.empty) continue;
    block.min_enu.z() = low;
    block.max_enu.z() = high;
  }
}

void ScaleCosts(std::vector<Block>& blocks) {
  double sum = 0.0;
  for (const Block& block : blocks) sum += block.cost;
  for (Block& block : blocks) block.cost = sum > 0.0 ? block.cost / sum : 0.0;
}

std::vector<Block> BlocksOf(const Inputs& in, const BlockGrid& grid) {
  const std::vector<double> seen_gsds = SeenGsds(in.seen, grid);
  std::vector<Block> blocks;
  blocks.reserve(seen_gsds.size());
  for (size_t i = 0; i < seen_gsds.size(); ++i) blocks.push_back(MakeBlock(in, grid, static_cast<int>(i), seen_gsds[i]));
  if (in.options.heights == "survey") UseCommonHeights(blocks);
  std::vector<Box> boxes;
  for (const Block& block : blocks) boxes.push_back({block.TrainMin(), block.TrainMax()});
  std::vector<BoxVisibility> views = FindVisibility(in.survey, boxes, in.image_width);
  for (size_t i = 0; i < blocks.size(); ++i) {
    AddViews(blocks[i], std::move(views[i]), VoxelsOf(in, grid, blocks[i].id, blocks[i].finest_voxel_m), in.options);
  }
  ScaleCosts(blocks);
  return blocks;
}

// Surface voxels that the largest table holds.
double MostVoxels(const PartitionOptions& options) {
  return std::exp2(options.max_log2_table_size) * options.max_voxels_per_entry;
}

// Whether no block has more surface than the largest table holds.
bool FitsTables(const Inputs& in, const BlockGrid& grid) {
  const double most_voxels = MostVoxels(in.options);
  const std::vector<double> seen_gsds = SeenGsds(in.seen, grid);
  for (size_t i = 0; i < seen_gsds.size(); ++i) {
    const int index = static_cast<int>(i);
    const double gsd_m = FlownGsd(in, BlockAltitude(in.altitudes, grid.Min(index), grid.Max(index)), seen_gsds[i]);
    // A factor of sqrt(2) too much is accepted, as Log2TableSize rounds to the nearest power of two.
    if (VoxelsOf(in, grid, index, in.options.voxel_per_gsd * gsd_m) > most_voxels * std::sqrt(2.0)) return false;
  }
  return true;
}

int BlocksWithPoints(const Inputs& in, const BlockGrid& grid) {
  std::vector<char> has_points(static_cast<size_t>(grid.rows()) * static_cast<size_t>(grid.columns()), 0);
  for (const Eigen::Vector3d& x : in.points) {
    if (const int cell = grid.CellOf(x.x(), x.y()); cell >= 0) has_points[static_cast<size_t>(cell)] = 1;
  }
  return static_cast<int>(std::count(has_points.begin(), has_points.end(), 1));
}

double LeastShare(const std::vector<Block>& blocks) {
  double least = 1.0;
  for (const Block& block : blocks) {
    if (!block.empty) least = std::min(least, block.cost);
  }
  return least;
}

AutoGrid MakeGrid(const Inputs& in, const BlockRequest& request, double block_steps) {
  const Eigen::Vector2d low = in.area.min_enu, high = in.area.max_enu;
  if (request.kind == BlockRequestKind::kCount) return {SplitByCount(low, high, request.rows, request.columns), "as asked for"};
  if (request.kind == BlockRequestKind::kSize) return {SplitBySize(low, high, request.size_m), "of the size asked for"};
  AutoGridInput input{.min_enu = low, .max_enu = high};
  input.fits = [&in](const BlockGrid& grid) { return FitsTables(in, grid); };
  input.n_blocks = [&in](const BlockGrid& grid) { return BlocksWithPoints(in, grid); };
  // Heights that were given one per block do not fit grids of other sizes.
  input.least_share = [&in](const BlockGrid& grid) { return in.options.altitudes.empty() ? LeastShare(BlocksOf(in, grid)) : 1.0; };
  input.training_pixels = TrainingPixels(in.survey, in.image_width);
  input.pixels_per_block = kViewsOfVoxel * in.options.voxel_per_gsd * in.options.voxel_per_gsd * MostVoxels(in.options);
  input.block_steps = block_steps;
  return ChooseGrid(input);
}

// The exact bytes of the numbers, so that any change of the survey that could move a block changes the hash.
void Append(std::string& bytes, const double* values, Eigen::Index count) {
  bytes.append(reinterpret_cast<const char*>(values), static_cast<size_t>(count) * sizeof(double));
}

std::string ConfigHash(const Inputs& in, const BlockGrid& grid) {
  PartitionOptions options = in.options;
  config::Sections sections;
  sections.Add("partition", options, "");
  const survey::Survey& survey = in.survey;
  std::string bytes = config::Hash(config::Flatten(sections)) + " " + std::to_string(in.image_width) + " " + std::to_string(grid.rows()) + "x" +
                      std::to_string(grid.columns()) + " ";
  const double origin[3] = {survey.origin.latitude_deg, survey.origin.longitude_deg, survey.origin.height_m};
  Append(bytes, origin, 3);
  for (const camera::Camera& camera : survey.cameras) {
    bytes += camera::ModelName(camera.model) + std::to_string(camera.width) + "x" + std::to_string(camera.height);
    Append(bytes, camera.params.data(), static_cast<Eigen::Index>(camera.params.size()));
  }
  for (const survey::Photo& photo : survey.photos) {
    bytes += photo.name + (photo.is_test ? " test " : " train ") + std::to_string(photo.camera);
    Append(bytes, photo.cam_from_enu.rotation.coeffs().data(), 4);
    Append(bytes, photo.cam_from_enu.translation.data(), 3);
  }
  for (const survey::SparsePoint& point : survey.points) Append(bytes, point.x_in_enu.data(), 3);
  for (const SeenPoint& point : in.seen) Append(bytes, &point.gsd_m, 1);
  return base::HashHex(bytes);
}

void RequireWidth(int image_width) {
  if (image_width >= 0) return;
  throw base::UsageError("image width = " + std::to_string(image_width) + " is not allowed: it must be positive, or 0 for full size");
}

Inputs InputsOf(const survey::Survey& survey, const PartitionOptions& options, int image_width) {
  Inputs in{survey, options, image_width, ReliablePoints(survey), {}, {}, {}};
  in.area = FindSurveyArea(survey, in.points, options.area, options.min_views);
  in.altitudes = TrainingAltitudes(survey, 0.5 * (in.area.min_enu + in.area.max_enu), in.area.ground_m);
  in.seen = SeenPoints(survey, image_width);
  return in;
}

BlockSet SetOf(const Inputs& in, const BlockGrid& grid, std::vector<Block> blocks) {
  const survey::Survey& survey = in.survey;
  BlockSet set;
  set.origin = survey.origin;
  set.georeferenced = survey.georeferenced;
  set.accuracy = survey.fit.accuracy;
  set.height_reference = survey.height_reference;
  set.rows = grid.rows();
  set.columns = grid.columns();
  set.image_width = in.image_width;
  set.config_hash = ConfigHash(in, grid);
  set.blocks = std::move(blocks);
  set.area_is_that_of_points = in.area.by_points && in.options.area == "covered";
  if (std::all_of(set.blocks.begin(), set.blocks.end(), [](const Block& block) { return block.empty; })) {
    throw base::InputError(survey.photo_root.empty() ? "survey" : survey.photo_root,
                           "every block is empty (" + set.blocks.front().name + ": " + set.blocks.front().empty_reason + ")",
                           "Check the poses and the sparse points of the survey, or hold out fewer photos");
  }
  return set;
}

BlockGrid GridOf(const BlockSet& set) {
  BlockGrid grid;
  const auto columns = static_cast<size_t>(set.columns), rows = static_cast<size_t>(set.rows);
  for (size_t c = 0; c < columns; ++c) grid.x_edges.push_back(set.blocks[c].min_enu.x());
  grid.x_edges.push_back(set.blocks[columns - 1].max_enu.x());
  for (size_t r = 0; r < rows; ++r) grid.y_edges.push_back(set.blocks[r * columns].min_enu.y());
  grid.y_edges.push_back(set.blocks[(rows - 1) * columns].max_enu.y());
  return grid;
}

// Cells of about the size of those there are, as far as `low` and `high`. A strip that is narrower than the margin or a quarter of a cell would cost
// as much training as a whole block for the rim of the survey: it is left to the margin and the context. Returns how many cells are before the first
// one now.
int Extend(double low, double high, double margin_m, std::vector<double>& edges) {
  constexpr double kStrip = 0.25;
  const double cell = (edges.back() - edges.front()) / static_cast<double>(edges.size() - 1), least = std::max(margin_m, kStrip * cell);
  const auto cells = [&](double more) { return more > least ? std::max(1, static_cast<int>(std::lround(std::min(more / cell, 1e6)))) : 0; };
  const double first = edges.front(), last = edges.back();
  const int before = cells(first - low), after = cells(high - last);
  std::vector<double> all;
  for (int i = 0; i < before; ++i) all.push_back(low + (first - low) * i / before);
  all.insert(all.end(), edges.begin(), edges.end());
  for (int i = 1; i <= after; ++i) all.push_back(i == after ? high : last + (high - last) * i / after);
  edges = std::move(all);
  return before;
}

// Blocks that other photos see now are new ones in the same place. The others stay what they were.
void KeepUnchanged(const Inputs& in, const BlockSet& earlier, int rows_before, int columns_before, int columns, std::vector<Block>& blocks) {
  std::vector<Box> boxes;
  for (const Block& block : earlier.blocks) boxes.push_back({block.TrainMin(), block.TrainMax()});
  const std::vector<BoxVisibility> views = FindVisibility(in.survey, boxes, in.image_width);
  for (size_t i = 0; i < boxes.size(); ++i) {
    const int row = rows_before + static_cast<int>(i) / earlier.columns, column = columns_before + static_cast<int>(i) % earlier.columns;
    Block& block = blocks[static_cast<size_t>(row) * static_cast<size_t>(columns) + static_cast<size_t>(column)];
    const Block& before = earlier.blocks[i];
    const bool same = before.empty ? block.empty : views[i].photos == before.photos;
    if (!same) {
      block.name = before.name;
      continue;
    }
    const double cost = block.cost;
    const int id = block.id;
    block = before;
    block.id = id;
    if (!block.empty && cost > 0.0) block.cost = cost;
  }
}

}  // namespace

BlockSet MakeBlocks(const survey::Survey& survey, const PartitionOptions& options, int image_width, double block_steps) {
  options.Check();
  RequireWidth(image_width);
  const BlockRequest request = ParseBlockRequest(options.blocks);
  if (request.kind == BlockRequestKind::kCount) CheckAltitudeCount(options, request.rows, request.columns);

  const Inputs in = InputsOf(survey, options, image_width);
  AutoGrid chosen = MakeGrid(in, request, block_steps);
  CheckAltitudeCount(options, chosen.grid.rows(), chosen.grid.columns());
  BlockSet set = SetOf(in, chosen.grid, BlocksOf(in, chosen.grid));
  set.number_reason = std::move(chosen.reason);
  return set;
}

BlockSet ExtendBlocks(const survey::Survey& survey, const BlockSet& earlier, const PartitionOptions& options) {
  options.Check();
  SKYQUILT_CHECK(!earlier.blocks.empty(), "a set has blocks");
  if (!options.altitudes.empty()) {
    throw base::UsageError("photos cannot be added to blocks of given heights (partition.altitudes): it is not known which height new blocks have");
  }
  Inputs in = InputsOf(survey, options, earlier.image_width);
  in.margin_m = earlier.blocks.front().margin_m;
  BlockGrid grid = GridOf(earlier);
  const int columns_before = Extend(in.area.min_enu.x(), in.area.max_enu.x(), *in.margin_m, grid.x_edges);
  const int rows_before = Extend(in.area.min_enu.y(), in.area.max_enu.y(), *in.margin_m, grid.y_edges);
  if (static_cast<int64_t>(grid.rows()) * grid.columns() > kMaxBlocks) {
    throw base::UsageError(
        fmt::format("the added photos are too far from the others: {} x {} blocks of the present size would be more than {}. Give "
                    "them a project of their own, or --restart for larger blocks",
                    grid.rows(), grid.columns(), kMaxBlocks));
  }
  int first_row = 0, first_column = 0;
  std::sscanf(earlier.blocks.front().name.c_str(), "r%dc%d", &first_row, &first_column);
  in.first_row = first_row - rows_before;
  in.first_column = first_column - columns_before;
  std::vector<Block> blocks = BlocksOf(in, grid);
  KeepUnchanged(in, earlier, rows_before, columns_before, grid.columns(), blocks);
  ScaleCosts(blocks);
  BlockSet set = SetOf(in, grid, std::move(blocks));
  set.number_reason = fmt::format("{} x {} of them as before, others of their size around them", earlier.rows, earlier.columns);
  return set;
}

}  // namespace skyquilt::partition
