#include "surface/tile_store.h"

#include <array>
#include <bit>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>

#include "core/base/errors.h"
#include "core/base/file.h"

namespace skyquilt::surface {
namespace {

// A file: 8 characters that tell its kind and version, the number of bytes that follow the checksum, base::HashHex of these bytes, and the bytes:
// numbers in little-endian order, vectors as their length and their members.
static_assert(std::endian::native == std::endian::little);
constexpr std::string_view kTilesMagic = "SQTILES1", kMeshMagic = "SQMESH_1", kBakedMagic = "SQBAKED1";
constexpr size_t kMagicBytes = 8, kChecksumBytes = 16, kHeadBytes = kMagicBytes + sizeof(uint64_t) + kChecksumBytes;
constexpr size_t kVector3dBytes = 3 * sizeof(double), kVector3fBytes = 3 * sizeof(float), kVector2fBytes = 2 * sizeof(float);
constexpr size_t kPointBytes = kVector3dBytes + kVector3fBytes + 6;
constexpr int32_t kMostLevels = 64;

class ContentWriter {
 public:
  template <typename T>
  void Number(T value) {
    static_assert(std::is_arithmetic_v<T>);
    Raw(&value, sizeof(T));
  }
  // Members without gaps, of this size.
  template <size_t kMemberBytes, typename T>
  void Vector(const std::vector<T>& values) {
    static_assert(sizeof(T) == kMemberBytes);
    Number(static_cast<uint64_t>(values.size()));
    Raw(values.data(), values.size() * sizeof(T));
  }
  void Raw(const void* data, size_t bytes) {
    if (bytes > 0) content_.append(static_cast<const char*>(data), bytes);
  }
  void Save(std::string_view magic, const std::filesystem::path& file) const {
    std::string whole(magic);
    const uint64_t bytes = content_.size();
    whole.append(reinterpret_cast<const char*>(&bytes), sizeof(bytes)).append(base::HashHex(content_)).append(content_);
    base::WriteFileAtomically(file, whole);
  }

 private:
  std::string content_;
};

class ContentReader {
 public:
  ContentReader(std::string_view magic, const std::filesystem::path& file) : file_(file), whole_(base::ReadFile(file)) {
    if (whole_.size() < kHeadBytes) Fail("is cut off after " + std::to_string(whole_.size()) + " bytes");
    if (whole_.compare(0, kMagicBytes, magic) != 0) Fail("does not begin with " + std::string(magic) + ": it is another kind or version of file");
    at_ = kMagicBytes;
    const uint64_t bytes = Number<uint64_t>();
    if (bytes != whole_.size() - kHeadBytes) {
      Fail("has " + std::to_string(whole_.size() - kHeadBytes) + " bytes of content instead of " + std::to_string(bytes));
    }
    if (whole_.compare(at_, kChecksumBytes, base::HashHex(std::string_view(whole_).substr(kHeadBytes))) != 0) {
      Fail("is damaged: its checksum does not fit its content");
    }
    at_ = kHeadBytes;
  }

  template <typename T>
  T Number() {
    T value;
    Raw(&value, sizeof(T));
    return value;
  }
  // A number of members of this many bytes each, which are sure to be there.
  size_t Count(size_t member_bytes) {
    const uint64_t count = Number<uint64_t>();
    if (count > (whole_.size() - at_) / member_bytes) Fail("announces " + std::to_string(count) + " members where there is no room for them");
    return static_cast<size_t>(count);
  }
  template <size_t kMemberBytes, typename T>
  void Vector(std::vector<T>* values) {
    static_assert(sizeof(T) == kMemberBytes);
    values->resize(Count(kMemberBytes));
    Raw(values->data(), values->size() * sizeof(T));
  }
  void Raw(void* data, size_t bytes) {
    if (bytes > whole_.size() - at_) Fail("ends inside its content");
    if (bytes > 0) std::memcpy(data, whole_.data() + at_, bytes);
    at_ += bytes;
  }
  void End() const {
    if (at_ != whole_.size()) Fail("goes on after its content");
  }
  void Require(bool condition, const std::string& finding) const {
    if (!condition) Fail(finding);
  }
  [[noreturn]] void Fail(const std::string& finding) const { throw base::InputError(file_, finding, "Delete it; the same command makes it again"); }

 private:
  std::filesystem::path file_;
  std::string whole_;
  size_t at_ = 0;
};

void WriteId(const TileId& id, ContentWriter* to) {
  for (const int number : {id.level, id.column, id.row}) to->Number(static_cast<int32_t>(number));
}

TileId ReadId(ContentReader* from) {
  TileId id;
  id.level = from->Number<int32_t>();
  id.column = from->Number<int32_t>();
  id.row = from->Number<int32_t>();
  from->Require(id.level >= 0 && id.level < kMostLevels, "has a tile of level " + std::to_string(id.level));
  return id;
}

void RequireTriangles(const ContentReader& from, const std::vector<Triangle>& triangles, size_t n_vertices) {
  for (const Triangle& t : triangles) {
    for (const uint32_t v : t) from.Require(v < n_vertices, "has a triangle with vertex " + std::to_string(v) + " of " + std::to_string(n_vertices));
  }
}

void WriteMesh(const Mesh& mesh, ContentWriter* to) {
  const size_t n = mesh.position.size();
  SKYQUILT_CHECK(mesh.key.size() == n && mesh.views.size() == n && mesh.filled.size() == n, "the vectors of a mesh differ in length");
  to->Vector<kVector3dBytes>(mesh.position);
  to->Vector<sizeof(uint64_t)>(mesh.key);
  to->Vector<1>(mesh.views);
  to->Vector<1>(mesh.filled);
  to->Vector<3 * sizeof(uint32_t)>(mesh.triangle);
}

Mesh ReadMesh(ContentReader* from) {
  Mesh mesh;
  from->Vector<kVector3dBytes>(&mesh.position);
  from->Vector<sizeof(uint64_t)>(&mesh.key);
  from->Vector<1>(&mesh.views);
  from->Vector<1>(&mesh.filled);
  from->Vector<3 * sizeof(uint32_t)>(&mesh.triangle);
  const size_t n = mesh.position.size();
  from->Require(mesh.key.size() == n && mesh.views.size() == n && mesh.filled.size() == n, "has a mesh whose vectors differ in length");
  RequireTriangles(*from, mesh.triangle, n);
  return mesh;
}

void WriteTextured(const TexturedTile& tile, ContentWriter* to) {
  const size_t n = tile.position.size();
  SKYQUILT_CHECK(tile.normal.size() == n && tile.uv.size() == n && tile.views.size() == n && tile.filled.size() == n,
                 "the vectors of a textured tile differ in length");
  WriteId(tile.id, to);
  to->Number(tile.error_m);
  to->Vector<kVector3dBytes>(tile.position);
  to->Vector<kVector3fBytes>(tile.normal);
  to->Vector<kVector2fBytes>(tile.uv);
  to->Vector<1>(tile.views);
  to->Vector<1>(tile.filled);
  to->Vector<3 * sizeof(uint32_t)>(tile.triangle);
  to->Number(static_cast<int32_t>(tile.atlas_width));
  to->Number(static_cast<int32_t>(tile.atlas_height));
  to->Vector<1>(tile.atlas_jpeg);
}

TexturedTile ReadTextured(ContentReader* from) {
  TexturedTile tile;
  tile.id = ReadId(from);
  tile.error_m = from->Number<double>();
  from->Vector<kVector3dBytes>(&tile.position);
  from->Vector<kVector3fBytes>(&tile.normal);
  from->Vector<kVector2fBytes>(&tile.uv);
  from->Vector<1>(&tile.views);
  from->Vector<1>(&tile.filled);
  from->Vector<3 * sizeof(uint32_t)>(&tile.triangle);
  const size_t n = tile.position.size();
  from->Require(tile.normal.size() == n && tile.uv.size() == n && tile.views.size() == n && tile.filled.size() == n,
                "has a tile whose vectors differ in length");
  RequireTriangles(*from, tile.triangle, n);
  tile.atlas_width = from->Number<int32_t>();
  tile.atlas_height = from->Number<int32_t>();
  from->Require(tile.atlas_width >= 0 && tile.atlas_height >= 0, "has a texture of negative size");
  from->Vector<1>(&tile.atlas_jpeg);
  return tile;
}

// Member by member, because CloudPoint has gaps.
void WritePoints(const std::vector<CloudPoint>& points, ContentWriter* to) {
  to->Number(static_cast<uint64_t>(points.size()));
  for (const CloudPoint& point : points) {
    const std::array<uint8_t, 6> bytes = {point.rgb[0], point.rgb[1], point.rgb[2], point.views, point.filled, point.las_class};
    to->Raw(point.position.data(), kVector3dBytes);
    to->Raw(point.normal.data(), kVector3fBytes);
    to->Raw(bytes.data(), bytes.size());
  }
}

std::vector<CloudPoint> ReadPoints(ContentReader* from) {
  std::vector<CloudPoint> points(from->Count(kPointBytes));
  for (CloudPoint& point : points) {
    std::array<uint8_t, 6> bytes;
    from->Raw(point.position.data(), kVector3dBytes);
    from->Raw(point.normal.data(), kVector3fBytes);
    from->Raw(bytes.data(), bytes.size());
    point.rgb = {bytes[0], bytes[1], bytes[2]};
    point.views = bytes[3];
    point.filled = bytes[4];
    point.las_class = bytes[5];
  }
  return points;
}

}  // namespace

void SaveMeshTiles(const std::vector<MeshTile>& tiles, const std::filesystem::path& file) {
  ContentWriter writer;
  writer.Number(static_cast<uint64_t>(tiles.size()));
  for (const MeshTile& tile : tiles) {
    WriteId(tile.id, &writer);
    writer.Number(tile.error_m);
    WriteMesh(tile.mesh, &writer);
  }
  writer.Save(kTilesMagic, file);
}

std::vector<MeshTile> LoadMeshTiles(const std::filesystem::path& file) {
  ContentReader reader(kTilesMagic, file);
  constexpr size_t kLeastTileBytes = 3 * sizeof(int32_t) + sizeof(double) + 5 * sizeof(uint64_t);
  std::vector<MeshTile> tiles(reader.Count(kLeastTileBytes));
  for (MeshTile& tile : tiles) {
    tile.id = ReadId(&reader);
    tile.error_m = reader.Number<double>();
    tile.mesh = ReadMesh(&reader);
  }
  reader.End();
  return tiles;
}

void SaveMesh(const Mesh& mesh, const std::filesystem::path& file) {
  ContentWriter writer;
  WriteMesh(mesh, &writer);
  writer.Save(kMeshMagic, file);
}

Mesh LoadMesh(const std::filesystem::path& file) {
  ContentReader reader(kMeshMagic, file);
  Mesh mesh = ReadMesh(&reader);
  reader.End();
  return mesh;
}

void SaveBakedTile(const BakedTile& tile, const std::filesystem::path& file) {
  ContentWriter writer;
  WriteTextured(tile.tile, &writer);
  WritePoints(tile.points, &writer);
  writer.Save(kBakedMagic, file);
}

BakedTile LoadBakedTile(const std::filesystem::path& file) {
  ContentReader reader(kBakedMagic, file);
  BakedTile tile;
  tile.tile = ReadTextured(&reader);
  tile.points = ReadPoints(&reader);
  reader.End();
  return tile;
}

}  // namespace skyquilt::surface
