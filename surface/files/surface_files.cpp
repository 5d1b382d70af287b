#include "surface/files/surface_files.h"

#include <algorithm>
#include <iterator>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/progress.h"
#include "surface/files/earlier_files.h"
#include "surface/files/georeference_file.h"
#include "surface/files/glb_writer.h"
#include "surface/files/las_writer.h"
#include "surface/files/obj_writer.h"
#include "surface/files/ply_writer.h"
#include "surface/files/tileset_writer.h"

namespace skyquilt::surface {

struct SurfaceFiles::Impl {
  const MapFrame& frame;
  std::filesystem::path folder;
  bool mesh_files = false;
  bool cloud_files = false;
  bool closed = false;
  std::vector<std::unique_ptr<FileWriter>> writers;
};

SurfaceFiles::SurfaceFiles(const MapFrame& frame, const FileSelection& selection, double tile_size_m, const std::filesystem::path& folder,
                           int64_t las_points)
    : impl_(new Impl{.frame = frame, .folder = folder, .writers = {}}) {
  base::RequireWritableFolder(folder);
  RemovePartialFiles(folder);
  impl_->mesh_files = selection.glb || selection.obj || selection.ply;
  impl_->cloud_files = selection.cloud;
  std::vector<std::unique_ptr<FileWriter>>& writers = impl_->writers;
  if (selection.glb) writers.push_back(std::make_unique<GlbWriter>(frame, folder));
  if (selection.obj) writers.push_back(std::make_unique<ObjWriter>(frame, folder));
  if (selection.ply) writers.push_back(std::make_unique<PlyMeshWriter>(frame, folder));
  if (selection.cloud) {
    writers.push_back(std::make_unique<LasWriter>(frame, folder, las_points));
    writers.push_back(std::make_unique<PlyCloudWriter>(frame, folder));
  }
  if (selection.tiles) writers.push_back(std::make_unique<TilesetWriter>(frame, tile_size_m, folder));
  // Last, so that it is there only when all others are.
  writers.push_back(std::make_unique<GeoreferenceFile>(frame, folder));
}

SurfaceFiles::~SurfaceFiles() = default;

void SurfaceFiles::Add(const TexturedTile& tile) {
  SKYQUILT_CHECK(!impl_->closed, "Add after Close");
  const TexturedTile clean = CleanTile(tile);
  if (clean.triangle.empty()) return;
  MapVertices in_map;
  const bool finest = clean.id.level == 0;
  if (finest && impl_->mesh_files) in_map = VerticesInMap(clean, impl_->frame);
  for (const auto& writer : impl_->writers) writer->AddTile(clean, finest ? &in_map : nullptr);
}

void SurfaceFiles::AddPoints(std::span<const CloudPoint> points) {
  SKYQUILT_CHECK(!impl_->closed, "AddPoints after Close");
  if (!impl_->cloud_files) return;
  // In pieces, which bounds the memory for converted points.
  constexpr size_t kPiece = 1 << 16;
  for (size_t first = 0; first < points.size(); first += kPiece) {
    base::ThrowIfCancelled();
    const std::vector<CloudPoint> in_map = PointsInMap(points.subspan(first, std::min(kPiece, points.size() - first)), impl_->frame);
    for (const auto& writer : impl_->writers) writer->AddPoints(in_map);
  }
}

std::vector<WrittenFile> SurfaceFiles::Close() {
  SKYQUILT_CHECK(!impl_->closed, "Close after Close");
  impl_->closed = true;
  base::Progress progress("surface files", static_cast<double>(impl_->writers.size()), "formats");
  for (const auto& writer : impl_->writers) {
    base::ThrowIfCancelled();
    writer->Complete();
    progress.Advance();
  }
  RemoveEarlierFiles(impl_->folder);
  std::vector<WrittenFile> files;
  for (const auto& writer : impl_->writers) {
    writer->Publish();
    std::vector<WrittenFile> rows = writer->Rows();
    std::move(rows.begin(), rows.end(), std::back_inserter(files));
  }
  base::SyncPath(impl_->folder);
  progress.Finish();
  // The row of the geo-reference alone is none of a mesh.
  if (files.size() == 1) files.clear();
  return files;
}

}  // namespace skyquilt::surface
