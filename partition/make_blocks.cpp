#include "partition/make_blocks.h"

#include <algorithm>
#include <cmath>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/order_statistics.h"
#include "partition/altitude.h"
#include "partition/block_grid.h"
#include "partition/capacity.h"
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
};

double MarginOf(const BlockGrid& grid) {
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

double VoxelsOf(const Inputs& in, const BlockGrid& grid, int index, double voxel_m) {
  const Eigen::Vector2d margin = Eigen::Vector2d::Constant(MarginOf(grid));
  return SurfaceVoxels(in.area, in.points, grid.Min(index) - margin, grid.Max(index) + margin, voxel_m);
}

// Uses more and more blocks until the surface of each fits the largest table, or the next grid would have more than kMaxBlocks.
BlockGrid AutoGrid(const Inputs& in) {
  const Eigen::Vector2d extent = in.area.max_enu - in.area.min_enu;
  const double largest_table = std::exp2(in.options.max_log2_table_size);
  const double most_voxels = largest_table * in.options.max_voxels_per_entry;
  BlockGrid grid = SplitByCount(in.area.min_enu, in.area.max_enu, 1, 1);
  int rows = 1;
  int columns = 1;
  for (double side = extent.maxCoeff();; side *= 0.9) {
    const int next_rows = std::max(1, static_cast<int>(std::lround(extent.y() / side)));
    const int next_columns = std::max(1, static_cast<int>(std::lround(extent.x() / side)));
    if (static_cast<double>(next_rows) * next_columns > kMaxBlocks) return grid;
    if (side < extent.maxCoeff() && next_rows == rows && next_columns == columns) continue;
    grid = SplitByCount(in.area.min_enu, in.area.max_enu, next_rows, next_columns);
    rows = next_rows;
    columns = next_columns;
    // A factor of sqrt(2) too much is accepted, as Log2TableSize rounds to the nearest power of two.
    bool fits = true;
    for (int index = 0; fits && index < rows * columns; ++index) {
      const double agl = BlockAltitude(in.altitudes, grid.Min(index), grid.Max(index));
      const double voxel_m = in.options.voxel_per_gsd * SurveyGsd(in.survey, agl, in.image_width);
      fits = VoxelsOf(in, grid, index, voxel_m) <= most_voxels * std::sqrt(2.0);
    }
    if (fits) return grid;
  }
}

BlockGrid MakeGrid(const Inputs& in) {
  const BlockRequest request = ParseBlockRequest(in.options.blocks);
  if (request.kind == BlockRequestKind::kCount) return SplitByCount(in.area.min_enu, in.area.max_enu, request.rows, request.columns);
  if (request.kind == BlockRequestKind::kSize) return SplitBySize(in.area.min_enu, in.area.max_enu, request.size_m);
  return AutoGrid(in);
}

void CheckAltitudeCount(const PartitionOptions& options, int rows, int columns) {
  const size_t n_blocks = static_cast<size_t>(rows) * static_cast<size_t>(columns);
  if (options.altitudes.empty() || options.altitudes.size() == n_blocks) return;
  throw base::UsageError("partition.altitudes has " + std::to_string(options.altitudes.size()) + " altitude(s) but partition.blocks = \"" +
                         options.blocks + "\" gives " + std::to_string(n_blocks) + " block(s) (" + std::to_string(rows) + " row(s) x " +
                         std::to_string(columns) + " column(s)); give one per block in row-major order from the south-west");
}

// Fills in everything that does not depend on the photos that see the block.
Block MakeBlock(const Inputs& in, const BlockGrid& grid, int index) {
  Block block;
  block.id = index;
  block.name = "r" + std::to_string(index / grid.columns()) + "c" + std::to_string(index % grid.columns());
  block.margin_m = MarginOf(grid);
  block.flown_agl_m = BlockAltitude(in.altitudes, grid.Min(index), grid.Max(index));
  block.altitude_agl_m = in.options.altitudes.empty() ? block.flown_agl_m : in.options.altitudes[static_cast<size_t>(index)];
  // Voxels far finer than the photos' pixels cannot be told apart by them.
  const double sharpest_agl_m = std::max(block.altitude_agl_m, LowestAltitude(in, block.flown_agl_m));
  block.gsd_m = SurveyGsd(in.survey, sharpest_agl_m, in.image_width);
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

// The exact bytes of the numbers, so that any change of the survey that could move a block changes the hash.
void Append(std::string& bytes, const double* values, Eigen::Index count) {
  bytes.append(reinterpret_cast<const char*>(values), static_cast<size_t>(count) * sizeof(double));
}

std::string ConfigHash(const survey::Survey& survey, PartitionOptions options, int image_width) {
  config::Sections sections;
  sections.Add("partition", options, "");
  std::string bytes = config::Hash(config::Flatten(sections)) + " " + std::to_string(image_width) + " ";
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
  return base::HashHex(bytes);
}

}  // namespace

BlockSet MakeBlocks(const survey::Survey& survey, const PartitionOptions& options, int image_width) {
  options.Check();
  if (image_width < 0)
    throw base::UsageError("image width = " + std::to_string(image_width) + " is not allowed: it must be positive, or 0 for full size");
  const BlockRequest request = ParseBlockRequest(options.blocks);
  if (request.kind == BlockRequestKind::kCount) CheckAltitudeCount(options, request.rows, request.columns);

  Inputs in{survey, options, image_width, ReliablePoints(survey), {}, {}};
  in.area = FindSurveyArea(survey, in.points, options.area, options.min_views);
  in.altitudes = TrainingAltitudes(survey, 0.5 * (in.area.min_enu + in.area.max_enu), in.area.ground_m);
  const BlockGrid grid = MakeGrid(in);
  CheckAltitudeCount(options, grid.rows(), grid.columns());

  BlockSet set;
  set.origin = survey.origin;
  set.georeferenced = survey.georeferenced;
  set.accuracy = survey.fit.accuracy;
  set.height_reference = survey.height_reference;
  set.rows = grid.rows();
  set.columns = grid.columns();
  set.image_width = image_width;
  set.config_hash = ConfigHash(survey, options, image_width);
  for (int index = 0; index < set.rows * set.columns; ++index) set.blocks.push_back(MakeBlock(in, grid, index));
  if (options.heights == "survey") UseCommonHeights(set.blocks);
  std::vector<Box> boxes;
  for (const Block& block : set.blocks) boxes.push_back({block.TrainMin(), block.TrainMax()});
  std::vector<BoxVisibility> views = FindVisibility(survey, boxes, image_width);
  for (size_t i = 0; i < set.blocks.size(); ++i) {
    Block& block = set.blocks[i];
    AddViews(block, std::move(views[i]), VoxelsOf(in, grid, block.id, block.finest_voxel_m), options);
  }
  ScaleCosts(set.blocks);
  if (std::all_of(set.blocks.begin(), set.blocks.end(), [](const Block& block) { return block.empty; })) {
    throw base::InputError(survey.photo_root.empty() ? "survey" : survey.photo_root,
                           "every block is empty (" + set.blocks.front().name + ": " + set.blocks.front().empty_reason + ")",
                           "Check the poses and the sparse points of the survey, or hold out fewer photos");
  }
  return set;
}

}  // namespace skyquilt::partition
