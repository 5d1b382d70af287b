#include "simulate/surface_mesh.h"

#include <bit>
#include <cstring>
#include <string>

#include "core/base/file.h"
#include "simulate/classify.h"

namespace skyquilt::simulate {
namespace {

static_assert(std::endian::native == std::endian::little);
constexpr size_t kVertexBytes = 3 * sizeof(float);
constexpr size_t kFaceBytes = 1 + 3 * sizeof(int32_t) + 1;

std::string Header(const Mesh& mesh) {
  std::string header = "ply\nformat binary_little_endian 1.0\ncomment metres, local east north up about the origin in simulate.json\ncomment class:";
  for (size_t id = 1; id < survey::kSurfaceClassNames.size(); ++id) {
    header += (id > 1 ? ", " : " ") + std::to_string(id) + " " + survey::kSurfaceClassNames[id];
  }
  header += "\nelement vertex " + std::to_string(mesh.position.size()) + "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
            std::to_string(mesh.triangle.size()) + "\nproperty list uchar int vertex_indices\nproperty uchar class\nend_header\n";
  return header;
}

}  // namespace

void WriteSurfaceMesh(const World& world, const std::filesystem::path& file) {
  const Mesh& mesh = world.mesh();
  std::string content = Header(mesh);
  size_t at = content.size();
  content.resize(at + mesh.position.size() * kVertexBytes + mesh.triangle.size() * kFaceBytes);
  const auto put = [&content, &at](const void* value, size_t n_bytes) {
    std::memcpy(content.data() + at, value, n_bytes);
    at += n_bytes;
  };
  for (const Eigen::Vector3f& position : mesh.position) put(position.data(), kVertexBytes);
  for (size_t i = 0; i < mesh.triangle.size(); ++i) {
    const auto& corner = mesh.triangle[i];
    const Eigen::Vector3f middle = (mesh.position[corner[0]] + mesh.position[corner[1]] + mesh.position[corner[2]]) / 3.0F;
    const uint8_t n_corners = 3;
    const auto class_id = static_cast<uint8_t>(ClassOf(mesh.tag[i], middle, world.city(), world.marsh()));
    put(&n_corners, 1);
    put(corner.data(), 3 * sizeof(int32_t));
    put(&class_id, 1);
  }
  base::WriteFileAtomically(file, content);
}

}  // namespace skyquilt::simulate
