// mesh.glb: all tiles of level 0 in one binary glTF file, a primitive and a material each.
#pragma once

#include <memory>

#include "core/base/output_file.h"
#include "surface/files/file_writer.h"
#include "surface/files/gltf_document.h"

namespace skyquilt::surface {

class GlbWriter : public FileWriter {
 public:
  // Keeps a reference to the frame. max_bytes: for tests.
  GlbWriter(const MapFrame& frame, const std::filesystem::path& folder, uint64_t max_bytes = UINT32_MAX);

  // Throws base::InputError with advice when the file would become larger than the format allows.
  void AddTile(const TexturedTile& tile, const MapVertices* in_map) override;
  void Complete() override;
  void Publish() override;
  std::vector<WrittenFile> Rows() const override;

 private:
  GltfPlace Place() const;

  const MapFrame& frame_;
  std::filesystem::path folder_;
  uint64_t max_bytes_;
  GltfDocument document_;
  // The head of the file, whose length depends on all tiles, stands before the binary part.
  std::unique_ptr<base::OutputFile> binary_;
  std::unique_ptr<base::OutputFile> file_;
};

}  // namespace skyquilt::surface
