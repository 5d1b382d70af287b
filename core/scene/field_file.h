// Writes and reads a trained field in an HDF5 archive, in the layout that checkpoints and scenes share.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "core/checkpoint/archive.h"
#include "core/render/trained_field.h"

namespace skyquilt::scene {

// Version of the layout of checkpoints, both of blocks and of the context.
constexpr int kCheckpointVersion = 2;

// Writes a whole field, for checkpoints. prefix: "", or for instance "blocks/0/". The field must outlive the writer's Commit.
void PutField(const render::TrainedField& field, const std::string& prefix, checkpoint::ArchiveWriter& writer);
// Writes what rendering needs of a field, for scenes. Tables and networks are copied from the field's checkpoint at Commit: the tables with this
// precision and, of hash grids with one position per sample, without the entries that no occupied cell reads (field/used_entries.h); of the occupancy
// only one bit per cell. Throws base::InputError when the sizes of the checkpoint's arrays do not fit together.
// code: that the scene shows, folded into the networks (field::HashField::FoldAppearance); empty: the mean look.
void PutSceneField(const render::TrainedField& description, const std::filesystem::path& checkpoint, const std::string& prefix,
                   checkpoint::ArchiveWriter& writer, checkpoint::Precision tables = checkpoint::Precision::kFloat32,
                   std::span<const float> code = {});
// Writes box, configuration and training record of a field, without its arrays.
void PutDescription(const render::TrainedField& field, const std::string& prefix, checkpoint::ArchiveWriter& writer);
// Reads them. Throws base::InputError for impossible values.
render::TrainedField GetDescription(const checkpoint::ArchiveReader& reader, const std::filesystem::path& file, const std::string& prefix);
// Number of parameters of a field with this description in memory.
int64_t ParameterCountOf(const render::TrainedField& description);
// Number of parameters, and of occupancy cells, of a field in a file, without reading its arrays.
int64_t StoredParameterCount(const checkpoint::ArchiveReader& reader, const std::string& prefix);
int64_t StoredCellCount(const checkpoint::ArchiveReader& reader, const std::string& prefix);
// Reads a whole field and builds its networks. occupancy.tau is empty for a field from a scene. Throws base::InputError when the sizes of its arrays
// do not fit its configuration.
render::TrainedField GetField(const checkpoint::ArchiveReader& reader, const std::filesystem::path& file, const std::string& prefix);

}  // namespace skyquilt::scene
