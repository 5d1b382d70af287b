#include "tour/pictures/picture_field.h"

#include <fstream>

#include "core/base/errors.h"
#include "core/checkpoint/user_block.h"

namespace skyquilt::tour {
namespace {

// As in scene.cpp: ranks wait for each other at the end of each batch.
constexpr size_t kRaysOfRanks = 1 << 20;

// The beginning of an archive has the length and the digest of all that follows.
std::string IdentityOf(const std::filesystem::path& scene_h5) {
  std::string text(checkpoint::kUserBlockBytes, '\0');
  std::ifstream stream(scene_h5, std::ios::binary);
  if (!stream.read(text.data(), static_cast<std::streamsize>(text.size()))) {
    throw base::InputError(scene_h5, "cannot be read any more", "Leave the scene in its place while its tour is made");
  }
  return text;
}

}  // namespace

PictureField FieldOf(const scene::Scene& scene, const std::filesystem::path& scene_h5, base::ThreadPool& threads) {
  PictureField field;
  field.identity = IdentityOf(scene_h5);
  field.cones = scene.info().scales.Cones();
  if (scene.statistics().ranks > 1) field.batch_rays = kRaysOfRanks;
  field.caster = [&scene, &threads](const std::string& exposure) {
    return products::BackgroundCasterOf(scene, products::AppearanceOf(exposure, scene.info()), threads);
  };
  return field;
}

}  // namespace skyquilt::tour
