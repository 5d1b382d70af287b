// A field in an archive: the layout that checkpoints and scenes share.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "core/checkpoint/archive.h"
#include "core/render/trained_field.h"

namespace skyquilt::scene {

// Arrays under `prefix` ("" or "fields/r0c0/"). The field must outlive the writer's Commit.
void PutField(const render::TrainedField& field, const std::string& prefix, checkpoint::ArchiveWriter& writer);
// What rendering needs of a field that a checkpoint holds (under no prefix), for scenes: tables and networks are copied from there at Commit, the
// tables with this precision and without the entries that no occupied cell reads (field/reached_entries.h); of the occupancy only which cells are
// occupied. Throws base::InputError when the checkpoint's arrays disagree.
void PutFieldOf(const render::TrainedField& description, const std::filesystem::path& checkpoint, const std::string& prefix,
                checkpoint::ArchiveWriter& writer, checkpoint::Precision tables = checkpoint::Precision::kFloat32);
// The same without the arrays.
void PutDescription(const render::TrainedField& field, const std::string& prefix, checkpoint::ArchiveWriter& writer);
// Place and shape of a field, without its arrays. Throws base::InputError for one that cannot be.
render::TrainedField GetDescription(const checkpoint::ArchiveReader& reader, const std::filesystem::path& file, const std::string& prefix);
// In memory, of a field of this shape.
int64_t HeldParameters(const render::TrainedField& description);
// Of a field in a file, without reading its arrays.
int64_t StoredParameters(const checkpoint::ArchiveReader& reader, const std::string& prefix);
int64_t StoredCells(const checkpoint::ArchiveReader& reader, const std::string& prefix);
// occupancy.tau is empty for a field from a scene. Throws base::InputError when arrays and configuration disagree.
render::TrainedField GetField(const checkpoint::ArchiveReader& reader, const std::filesystem::path& file, const std::string& prefix);

}  // namespace skyquilt::scene
