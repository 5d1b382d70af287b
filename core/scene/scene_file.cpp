#include "core/scene/scene_file.h"

#include "core/base/errors.h"

namespace skyquilt::scene {

checkpoint::ArchiveReader OpenScene(const std::filesystem::path& scene_h5) {
  checkpoint::ArchiveReader reader(scene_h5);
  if (reader.kind() != kSceneKind) {
    throw base::InputError(scene_h5, "is a " + reader.kind() + " file, not a scene", "Give the scene.h5 that `skyquilt merge` wrote");
  }
  reader.RequireVersion(kSceneVersion);
  return reader;
}

Borders BordersOf(const checkpoint::ArchiveReader& scene) {
  const bool hard = scene.HasAttribute(kBordersAttribute) && scene.StringAttribute(kBordersAttribute) == NameOf(Borders::kHard);
  return hard ? Borders::kHard : Borders::kSmooth;
}

}  // namespace skyquilt::scene
