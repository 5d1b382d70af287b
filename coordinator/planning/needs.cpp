#include "coordinator/planning/needs.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "coordinator/scheduler/field_context.h"
#include "core/base/amounts.h"
#include "core/base/errors.h"
#include "core/base/log.h"
#include "products/product_options.h"

namespace skyquilt::coordinator {
namespace {

constexpr double kProgramMemory = 256e6;
// Bytes on disk.
constexpr double kFeatureBytes = 152.0;  // of a feature in COLMAP's database: descriptor and place
constexpr double kMatchBytes = 20e3;     // of a pair of photos
constexpr double kViewBytes = 6.0;       // of a pixel of a picture of depth, which stands beside its successor
constexpr double kMeshBytes = 150.0;     // of a cell of the surface, in all its files and the work folder
constexpr double kTexelBytes = 2.0;      // of a texel, in all files
constexpr double kMapBytes = 5.0;        // of a map cell, compressed: colours, heights, sources
constexpr double kReportBytes = 1.5e6;   // of a photo in the report
constexpr double kPairsOfPhoto = 8.4;

double TrainingMemory(const WorkSize& size, const Settings& settings, int log2_table_size) {
  partition::Block block;
  block.log2_table_size = log2_table_size;
  const int ranks_here = (size.ranks + size.machines - 1) / std::max(1, size.machines);
  const int threads = std::max(1, size.threads / std::max(1, ranks_here));
  const int training = std::max(1, ranks_here - (size.ranks > 1 && size.machines == 1 ? 1 : 0));
  return training * (kProgramMemory + ExpectedTrainingBytes(block, settings.train, threads));
}

}  // namespace

Needs NeedsOf(const WorkSize& size, const Settings& settings) {
  const partition::PartitionOptions& partition = settings.partition;
  const int largest = size.log2_table_size > 0 ? size.log2_table_size : partition.max_log2_table_size;
  const int smallest = size.log2_table_size > 0 ? size.log2_table_size : std::min(partition.min_log2_table_size, partition.max_log2_table_size);
  Needs needs;
  needs.memory = TrainingMemory(size, settings, largest);
  needs.least_memory = TrainingMemory(size, settings, smallest);

  const double pixels = size.PixelsAt(settings.run.image_width), surface = size.SurfacePixelsAt(settings.run.image_width);
  if (!size.poses_given) {
    const double features = size.photos * std::min(4096.0, static_cast<double>(settings.prepare.max_features)) * kFeatureBytes;
    needs.disk += 2.0 * features + kPairsOfPhoto * size.photos * kMatchBytes;  // parts and the whole stand beside each other
  }
  needs.disk += 3.0 * pixels * size.photos;  // decoded photos
  // A checkpoint holds parameters and two moments and stands beside its successor; the scene has the parameters again.
  const double parameters = std::ldexp(1.0, largest) * settings.train.features * settings.train.levels;
  needs.disk += (size.blocks + 1.0) * parameters * 4.0 * (3.0 + 1.0) + 2.0 * parameters * 12.0;
  if (!size.level) needs.disk += kMapBytes * (surface + std::min(size.surface_pixels, settings.products.MostAutomaticCells()));
  if (settings.surface.enabled) {
    const surface::SurfaceOptions& options = settings.surface;
    const double views = pixels * size.TrainingPhotos() / std::max(1.0, options.view_gsd * options.view_gsd) * (options.virtual_views ? 2.0 : 1.0);
    needs.disk += 2.0 * kViewBytes * views + kMeshBytes * surface / (options.voxel_gsd * options.voxel_gsd) +
                  kTexelBytes * surface / (options.texel_gsd * options.texel_gsd);
  }
  needs.disk += kReportBytes * std::min(size.held_out, settings.evaluate.report_photos);
  return needs;
}

Room RoomFor(const std::filesystem::path& folder, const Settings& settings) {
  Room room{.memory_limit = settings.run.MemoryLimitBytes(), .disk = std::numeric_limits<double>::infinity()};
  std::filesystem::path at = std::filesystem::absolute(folder).lexically_normal();
  while (!std::filesystem::exists(at) && at.has_parent_path() && at != at.parent_path()) at = at.parent_path();
  std::error_code error;
  const std::filesystem::space_info space = std::filesystem::space(at, error);
  if (!error) room.disk = static_cast<double>(space.available);
  return room;
}

void RequireRoom(const Needs& needs, const Room& room, const std::filesystem::path& folder) {
  if (needs.least_memory > room.memory_limit) {
    throw base::UsageError("training needs at least " + base::FormatCount(needs.least_memory) + "B of memory on each machine, but the limit is " +
                           base::FormatCount(room.memory_limit) +
                           "B (run.memory_gb). Raise --memory, use fewer ranks per machine or fewer threads, or a smaller train.batch_samples");
  }
  if (needs.disk > room.disk) {
    throw base::InputError(folder,
                           "has " + base::FormatCount(room.disk) + "B of free disk, but this run needs about " + base::FormatCount(needs.disk) + "B",
                           "Make room, choose a folder on a larger disk, or a smaller --image-width");
  }
  if (needs.memory > room.memory_limit) {
    base::LogWarning(
        "a block with the largest tables would need {}B of memory, the limit is {}B (run.memory_gb): partition may make one that is refused. "
        "Lower partition.max_log2_table_size or raise --memory",
        base::FormatCount(needs.memory), base::FormatCount(room.memory_limit));
  }
}

}  // namespace skyquilt::coordinator
