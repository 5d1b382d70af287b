// The tiles of a surface on disk, in our own format: for going on after an interruption, and for scores of the finished surface.
#pragma once

#include <filesystem>
#include <vector>

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

}  // namespace skyquilt::surface
