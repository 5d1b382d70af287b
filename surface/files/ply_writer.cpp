#include "surface/files/ply_writer.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/amounts.h"
#include "core/base/errors.h"
#include "surface/files/georeference_file.h"

namespace skyquilt::surface {
namespace {

constexpr size_t kMostDigits = 20;  // of a number with 64 bits

}  // namespace

std::array<uint8_t, 3> SampleTexture(const image::Image8& texture, const Eigen::Vector2f& uv) {
  if (texture.Empty()) return {128, 128, 128};
  const double x = std::clamp(static_cast<double>(uv.x()) * texture.width - 0.5, 0.0, texture.width - 1.0);
  const double y = std::clamp(static_cast<double>(uv.y()) * texture.height - 0.5, 0.0, texture.height - 1.0);
  const int x0 = static_cast<int>(x);
  const int y0 = static_cast<int>(y);
  const int x1 = std::min(x0 + 1, texture.width - 1);
  const int y1 = std::min(y0 + 1, texture.height - 1);
  const double right = x - x0;
  const double below = y - y0;
  std::array<uint8_t, 3> rgb;
  for (size_t c = 0; c < 3; ++c) {
    const double above_value = (1.0 - right) * texture.At(x0, y0)[c] + right * texture.At(x1, y0)[c];
    const double below_value = (1.0 - right) * texture.At(x0, y1)[c] + right * texture.At(x1, y1)[c];
    rgb[c] = static_cast<uint8_t>(std::lround((1.0 - below) * above_value + below * below_value));
  }
  return rgb;
}

PlyVertices::PlyVertices(const MapFrame& frame, const std::filesystem::path& file, bool with_faces)
    : frame_(frame), file_(file), with_faces_(with_faces) {
  head_bytes_ = Head(0, 0).size() + 2 * kMostDigits;
  file_.Append(std::string(head_bytes_, ' '));
}

void PlyVertices::Add(const Eigen::Vector3d& position, const Eigen::Vector3f& normal, std::initializer_list<uint8_t> bytes) {
  constexpr size_t kRecordsBytes = 1 << 18;
  for (int axis = 0; axis < 3; ++axis) Put(&records_, static_cast<float>(position[axis]));
  for (int axis = 0; axis < 3; ++axis) Put(&records_, normal[axis]);
  records_.insert(records_.end(), bytes);
  ++count_;
  if (records_.size() > kRecordsBytes) FlushRecords();
}

void PlyVertices::FlushRecords() {
  file_.Append(records_);
  records_.clear();
}

void PlyVertices::WriteHead(uint64_t faces) {
  FlushRecords();
  const std::string head = Head(faces, head_bytes_ - Head(faces, 0).size());
  file_.WriteAt(0, AsBytes(head));
}

std::string PlyVertices::Head(uint64_t faces, size_t padding) const {
  std::string head = "ply\nformat binary_little_endian 1.0\n";
  for (const std::string& line : DescribePlace(frame_)) head += "comment " + line + "\n";
  head += "comment " + std::string(padding, '.') + "\n";
  head += "element vertex " + std::to_string(count_) + "\n";
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz"}) head += std::string("property float ") + name + "\n";
  for (const char* name : {"red", "green", "blue", "views", "filled"}) head += std::string("property uchar ") + name + "\n";
  head += with_faces_ ? "element face " + std::to_string(faces) + "\nproperty list uchar int vertex_indices\n" : "property uchar class\n";
  return head + "end_header\n";
}

void PlyMeshWriter::AddTile(const TexturedTile& tile, const MapVertices* in_map) {
  if (in_map == nullptr) return;
  if (!vertices_) {
    vertices_ = std::make_unique<PlyVertices>(frame_, folder_ / "mesh.ply", true);
    faces_ = std::make_unique<base::OutputFile>(folder_ / "mesh.ply.faces");
  }
  const uint64_t first = vertices_->count();
  if (first + tile.position.size() > static_cast<uint64_t>(std::numeric_limits<int32_t>::max())) {
    throw base::InputError(folder_ / "mesh.ply", "would have more than 2,147,483,647 vertices, which the format cannot number",
                           "Turn it off with surface.ply = false and use tiles/tileset.json");
  }
  const image::Image8 texture = tile.atlas_jpeg.empty() ? image::Image8() : image::DecodeRgb8(tile.atlas_jpeg);
  for (size_t i = 0; i < tile.position.size(); ++i) {
    const std::array<uint8_t, 3> rgb = SampleTexture(texture, tile.uv[i]);
    vertices_->Add(in_map->position[i], in_map->normal[i], {rgb[0], rgb[1], rgb[2], tile.views[i], tile.filled[i]});
  }
  std::vector<uint8_t> bytes;
  bytes.reserve(13 * tile.triangle.size());
  for (const Triangle& triangle : tile.triangle) {
    Put(&bytes, uint8_t{3});
    for (const uint32_t index : triangle) Put(&bytes, static_cast<int32_t>(first + index));
  }
  faces_->Append(bytes);
  triangles_ += tile.triangle.size();
}

void PlyMeshWriter::Complete() {
  if (!vertices_) return;
  vertices_->WriteHead(triangles_);
  vertices_->file().AppendContentOf(faces_.get());
  vertices_->file().Complete();
  faces_.reset();
}

void PlyMeshWriter::Publish() {
  if (vertices_) vertices_->file().Publish();
}

std::vector<WrittenFile> PlyMeshWriter::Rows() const {
  if (!vertices_) return {};
  return {{.file = "mesh.ply",
           .content = "mesh with colours",
           .format = "PLY",
           .crs = OffsetCrsName(frame_),
           .vertical = frame_.VerticalName(),
           .bytes = static_cast<int64_t>(vertices_->file().size()),
           .detail = base::CountText(static_cast<int64_t>(triangles_), "triangle")}};
}

void PlyCloudWriter::AddPoints(std::span<const CloudPoint> points) {
  if (points.empty()) return;
  if (!points_) points_ = std::make_unique<PlyVertices>(frame_, folder_ / "cloud.ply", false);
  for (const CloudPoint& point : points) {
    points_->Add(point.position - frame_.offset(), point.normal,
                 {point.rgb[0], point.rgb[1], point.rgb[2], point.views, point.filled, point.las_class});
  }
}

void PlyCloudWriter::Complete() {
  if (!points_) return;
  points_->WriteHead(0);
  points_->file().Complete();
}

void PlyCloudWriter::Publish() {
  if (points_) points_->file().Publish();
}

std::vector<WrittenFile> PlyCloudWriter::Rows() const {
  if (!points_) return {};
  return {{.file = "cloud.ply",
           .content = "point cloud",
           .format = "PLY",
           .crs = OffsetCrsName(frame_),
           .vertical = frame_.VerticalName(),
           .bytes = static_cast<int64_t>(points_->file().size()),
           .detail = base::CountText(static_cast<int64_t>(points_->count()), "point")}};
}

}  // namespace skyquilt::surface
