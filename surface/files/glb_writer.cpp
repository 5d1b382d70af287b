#include "surface/files/glb_writer.h"

#include "core/base/amounts.h"

namespace skyquilt::surface {

GlbWriter::GlbWriter(const MapFrame& frame, const std::filesystem::path& folder, uint64_t max_bytes)
    : frame_(frame), folder_(folder), max_bytes_(max_bytes) {}

void GlbWriter::AddTile(const TexturedTile& tile, const MapVertices* in_map) {
  if (in_map == nullptr) return;
  if (!binary_) binary_ = std::make_unique<base::OutputFile>(folder_ / "mesh.glb.bin");
  GltfPrimitive primitive;
  primitive.name = tile.id.Name();
  for (const Eigen::Vector3d& position : in_map->position) primitive.position.push_back(YUp(position.cast<float>()));
  for (const Eigen::Vector3f& normal : in_map->normal) primitive.normal.push_back(YUp(normal));
  primitive.uv = tile.uv;
  primitive.triangle = tile.triangle;
  primitive.jpeg = tile.atlas_jpeg;
  binary_->Append(document_.Add(primitive));
  // Found now rather than at the end, when all tiles have been made.
  if (document_.binary_bytes() > max_bytes_) document_.Head(Place(), folder_ / "mesh.glb", max_bytes_);
}

void GlbWriter::Complete() {
  if (!binary_) return;
  file_ = std::make_unique<base::OutputFile>(folder_ / "mesh.glb");
  file_->Append(document_.Head(Place(), folder_ / "mesh.glb", max_bytes_));
  file_->AppendContentOf(binary_.get());
  file_->Complete();
  binary_.reset();
}

void GlbWriter::Publish() {
  if (file_) file_->Publish();
}

std::vector<WrittenFile> GlbWriter::Rows() const {
  if (!file_) return {};
  return {{.file = "mesh.glb",
           .content = "textured mesh",
           .format = "GLB",
           .crs = OffsetCrsName(frame_),
           .vertical = frame_.VerticalName(),
           .bytes = static_cast<int64_t>(file_->size()),
           .detail = base::CountText(document_.triangles(), "triangle") + ", " + base::CountText(document_.textures(), "texture")}};
}

GltfPlace GlbWriter::Place() const {
  return {.crs = frame_.CrsName(), .offset = frame_.offset(), .vertical = frame_.VerticalName()};
}

}  // namespace skyquilt::surface
