#include "surface/files/obj_writer.h"

#include <array>
#include <charconv>

#include "core/base/amounts.h"
#include "surface/files/georeference_file.h"

namespace skyquilt::surface {
namespace {

// std::to_chars does not depend on the locale, unlike printf.
void AppendFixed(std::string* text, double value, int decimals) {
  std::array<char, 64> digits;
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value, std::chars_format::fixed, decimals);
  *text += ' ';
  text->append(digits.data(), end.ptr);
}

void AppendCorner(std::string* text, uint64_t number) {
  const std::string digits = std::to_string(number);
  text->append(" ").append(digits).append("/").append(digits).append("/").append(digits);
}

}  // namespace

void ObjWriter::AddTile(const TexturedTile& tile, const MapVertices* in_map) {
  if (in_map == nullptr) return;
  if (!obj_) {
    obj_ = std::make_unique<base::OutputFile>(folder_ / "mesh.obj");
    mtl_ = std::make_unique<base::OutputFile>(folder_ / "mesh.mtl");
    for (const std::string& line : DescribePlace(frame_)) obj_->Append("# " + line + "\n");
    obj_->Append("mtllib mesh.mtl\n");
    mtl_->Append("# Skyquilt: one material per tile\n");
  }
  constexpr int kDecimals = 4, kUvDecimals = 6, kNormalDecimals = 4;
  std::string text = "g tile_" + tile.id.Name() + "\n";
  for (const Eigen::Vector3d& position : in_map->position) {
    text += 'v';
    for (int axis = 0; axis < 3; ++axis) AppendFixed(&text, position[axis], kDecimals);
    text += '\n';
  }
  for (const Eigen::Vector2f& uv : tile.uv) {
    text += "vt";
    AppendFixed(&text, static_cast<double>(uv.x()), kUvDecimals);
    AppendFixed(&text, 1.0 - static_cast<double>(uv.y()), kUvDecimals);  // the origin is the lower left corner
    text += '\n';
  }
  for (const Eigen::Vector3f& normal : in_map->normal) {
    text += "vn";
    for (int axis = 0; axis < 3; ++axis) AppendFixed(&text, static_cast<double>(normal[axis]), kNormalDecimals);
    text += '\n';
  }
  text += "usemtl tile_" + tile.id.Name() + "\n";
  for (const Triangle& triangle : tile.triangle) {
    text += 'f';
    for (const uint32_t index : triangle) AppendCorner(&text, vertices_ + index + 1);  // counted from 1
    text += '\n';
  }
  obj_->Append(text);
  vertices_ += tile.position.size();
  triangles_ += static_cast<int64_t>(tile.triangle.size());
  AddMaterial(tile);
}

void ObjWriter::AddMaterial(const TexturedTile& tile) {
  const std::string picture = "mesh_" + tile.id.Name() + ".jpg";
  // Illumination model 0 shows the colour as it is.
  mtl_->Append("\nnewmtl tile_" + tile.id.Name() + "\nKa 1 1 1\nKd 1 1 1\nKs 0 0 0\nd 1\nillum 0\n");
  if (tile.atlas_jpeg.empty()) return;
  mtl_->Append("map_Kd " + picture + "\n");
  base::OutputFile& texture = *textures_.emplace_back(std::make_unique<base::OutputFile>(folder_ / picture));
  texture.Append(tile.atlas_jpeg);
  texture.Complete();
}

void ObjWriter::Complete() {
  if (!obj_) return;
  obj_->Complete();
  mtl_->Complete();
}

void ObjWriter::Publish() {
  if (!obj_) return;
  // What opens the others comes last.
  for (const auto& texture : textures_) texture->Publish();
  mtl_->Publish();
  obj_->Publish();
}

std::vector<WrittenFile> ObjWriter::Rows() const {
  if (!obj_) return {};
  uint64_t bytes = obj_->size() + mtl_->size();
  for (const auto& texture : textures_) bytes += texture->size();
  return {{.file = "mesh.obj",
           .content = "textured mesh",
           .format = "OBJ",
           .crs = OffsetCrsName(frame_),
           .vertical = frame_.VerticalName(),
           .bytes = static_cast<int64_t>(bytes),
           .detail = base::CountText(triangles_, "triangle") + ", " + base::CountText(static_cast<int64_t>(textures_.size()), "texture")}};
}

}  // namespace skyquilt::surface
