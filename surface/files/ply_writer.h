// mesh.ply and cloud.ply: binary PLY, coordinates of the maps minus offset.
#pragma once

#include <array>
#include <initializer_list>
#include <memory>
#include <string>

#include "core/base/output_file.h"
#include "core/image/image.h"
#include "surface/files/file_writer.h"

namespace skyquilt::surface {

// Colour of the texture at a place in it, bilinear between the middles of texels; grey without texture.
std::array<uint8_t, 3> SampleTexture(const image::Image8& texture, const Eigen::Vector2f& uv);

// The vertices of a PLY file, behind a head of fixed length: their number is known only at the end.
class PlyVertices {
 public:
  PlyVertices(const MapFrame& frame, const std::filesystem::path& file, bool with_faces);
  // position: offset subtracted. bytes: red, green, blue, views, filled; of points without faces also the ASPRS class.
  void Add(const Eigen::Vector3d& position, const Eigen::Vector3f& normal, std::initializer_list<uint8_t> bytes);
  uint64_t count() const { return count_; }
  // Writes the waiting vertices and the head with the numbers of vertices and faces.
  void WriteHead(uint64_t faces);
  base::OutputFile& file() { return file_; }
  const base::OutputFile& file() const { return file_; }

 private:
  std::string Head(uint64_t faces, size_t padding) const;
  void FlushRecords();

  const MapFrame& frame_;
  base::OutputFile file_;
  bool with_faces_;
  size_t head_bytes_ = 0;
  uint64_t count_ = 0;
  std::vector<uint8_t> records_;
};

// Both keep a reference to the frame.
class PlyMeshWriter : public FileWriter {
 public:
  PlyMeshWriter(const MapFrame& frame, const std::filesystem::path& folder) : frame_(frame), folder_(folder) {}

  // Throws base::InputError, too, when the atlas cannot be decoded, or for more vertices than the format can number.
  void AddTile(const TexturedTile& tile, const MapVertices* in_map) override;
  void Complete() override;
  void Publish() override;
  std::vector<WrittenFile> Rows() const override;

 private:
  const MapFrame& frame_;
  std::filesystem::path folder_;
  std::unique_ptr<PlyVertices> vertices_;
  std::unique_ptr<base::OutputFile> faces_;  // stand after all vertices
  uint64_t triangles_ = 0;
};

class PlyCloudWriter : public FileWriter {
 public:
  PlyCloudWriter(const MapFrame& frame, const std::filesystem::path& folder) : frame_(frame), folder_(folder) {}

  void AddPoints(std::span<const CloudPoint> points) override;
  void Complete() override;
  void Publish() override;
  std::vector<WrittenFile> Rows() const override;

 private:
  const MapFrame& frame_;
  std::filesystem::path folder_;
  std::unique_ptr<PlyVertices> points_;
};

}  // namespace skyquilt::surface
