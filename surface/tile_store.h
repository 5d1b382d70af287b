// The tiles of a surface on disk, in our own format: for going on after an interruption, and for scores of the finished surface.
#pragma once

#include <filesystem>
#include <vector>

#include "core/base/errors.h"
#include "core/base/log.h"
#include "surface/mesh.h"
#include "surface/texture/texture_baker.h"

namespace skyquilt::surface {

// Written atomically, with a checksum. Loading throws base::InputError when a file cannot be read or is damaged.
void SaveMeshTiles(const std::vector<MeshTile>& tiles, const std::filesystem::path& file);
std::vector<MeshTile> LoadMeshTiles(const std::filesystem::path& file);
void SaveMesh(const Mesh& mesh, const std::filesystem::path& file);
Mesh LoadMesh(const std::filesystem::path& file);
void SaveBakedTile(const BakedTile& tile, const std::filesystem::path& file);
BakedTile LoadBakedTile(const std::filesystem::path& file);

// What an earlier call has finished, by one of the functions above; false when there is none, or it is damaged, with a warning that `what` ("the
// piece") is made again.
template <typename T>
bool LoadFinished(const std::filesystem::path& file, T (*load)(const std::filesystem::path&), const char* what, T* result) {
  if (!std::filesystem::exists(file)) return false;
  try {
    *result = load(file);
    return true;
  } catch (const base::InputError& error) {
    base::LogWarning("{}; {} is made again", error.what(), what);
    return false;
  }
}

}  // namespace skyquilt::surface
