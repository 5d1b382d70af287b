// mesh.obj, mesh.mtl and mesh_<tile>.jpg: all tiles of level 0 as Wavefront OBJ, z up, coordinates of the maps minus offset.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/base/output_file.h"
#include "surface/files/file_writer.h"

namespace skyquilt::surface {

class ObjWriter : public FileWriter {
 public:
  // Keeps a reference to the frame.
  ObjWriter(const MapFrame& frame, const std::filesystem::path& folder) : frame_(frame), folder_(folder) {}

  void AddTile(const TexturedTile& tile, const MapVertices* in_map) override;
  void Complete() override;
  void Publish() override;
  std::vector<WrittenFile> Rows() const override;

 private:
  void AddMaterial(const TexturedTile& tile);

  const MapFrame& frame_;
  std::filesystem::path folder_;
  std::unique_ptr<base::OutputFile> obj_;
  std::unique_ptr<base::OutputFile> mtl_;
  std::vector<std::unique_ptr<base::OutputFile>> textures_;  // complete
  uint64_t vertices_ = 0;
  int64_t triangles_ = 0;
};

}  // namespace skyquilt::surface
