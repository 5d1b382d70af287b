// Names and version of the layout of scene.h5, shared by the merge stage that writes it and Scene that reads it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "core/checkpoint/archive.h"
#include "core/geo/height_reference.h"
#include "core/geo/place_accuracy.h"
#include "core/scene/scene.h"

namespace skyquilt::scene {

constexpr const char* kSceneKind = "scene";
constexpr int kSceneVersion = 3;
constexpr const char* kBordersAttribute = "borders";  // NameOf(Borders); missing: smooth
constexpr const char* kContextPrefix = "context/";
inline std::string BlockPrefix(int64_t i) {
  return "blocks/" + std::to_string(i) + "/";
}

// Blocks in whose place the context is shown: descriptions without arrays. Missing: none.
constexpr const char* kCoveredBlocksAttribute = "covered_blocks";
inline std::string CoveredBlockPrefix(int64_t i) {
  return "covered_blocks/" + std::to_string(i) + "/";
}

// Throws base::InputError when the file is damaged, is not a scene, or has another version.
checkpoint::ArchiveReader OpenScene(const std::filesystem::path& scene_h5);
Borders BordersOf(const checkpoint::ArchiveReader& scene);
// The accuracy of the scene's place on Earth: attributes accuracy_scale_percent and so on, without those that are unknown.
void PutAccuracy(const geo::PlaceAccuracy& accuracy, checkpoint::ArchiveWriter& writer);
geo::PlaceAccuracy GetAccuracy(const checkpoint::ArchiveReader& scene);
// Attribute height_reference; unknown where there is none. Throws base::InputError, which names the file, for one that no program writes.
void PutHeightReference(geo::HeightReference reference, checkpoint::ArchiveWriter& writer);
geo::HeightReference GetHeightReference(const checkpoint::ArchiveReader& scene, const std::filesystem::path& scene_h5);

}  // namespace skyquilt::scene
