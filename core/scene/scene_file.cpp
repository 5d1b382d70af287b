#include "core/scene/scene_file.h"

#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "core/base/errors.h"

namespace skyquilt::scene {
namespace {

constexpr std::array<std::pair<const char*, double geo::PlaceAccuracy::*>, 5> kAccuracyAttributes = {{
    {"accuracy_scale_percent", &geo::PlaceAccuracy::scale_percent},
    {"accuracy_tilt_deg", &geo::PlaceAccuracy::tilt_deg},
    {"accuracy_yaw_deg", &geo::PlaceAccuracy::yaw_deg},
    {"accuracy_horizontal_m", &geo::PlaceAccuracy::horizontal_m},
    {"accuracy_vertical_m", &geo::PlaceAccuracy::vertical_m},
}};
constexpr const char* kHeightReferenceAttribute = "height_reference";

}  // namespace

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

void PutAccuracy(const geo::PlaceAccuracy& accuracy, checkpoint::ArchiveWriter& writer) {
  for (const auto& [name, member] : kAccuracyAttributes) {
    if (std::isfinite(accuracy.*member)) writer.SetAttribute(name, accuracy.*member);
  }
}

geo::PlaceAccuracy GetAccuracy(const checkpoint::ArchiveReader& scene) {
  geo::PlaceAccuracy accuracy;
  for (const auto& [name, member] : kAccuracyAttributes) {
    if (scene.HasAttribute(name)) accuracy.*member = scene.DoubleAttribute(name);
  }
  return accuracy;
}

void PutHeightReference(geo::HeightReference reference, checkpoint::ArchiveWriter& writer) {
  writer.SetAttribute(kHeightReferenceAttribute, geo::NameOf(reference));
}

geo::HeightReference GetHeightReference(const checkpoint::ArchiveReader& scene, const std::filesystem::path& scene_h5) {
  if (!scene.HasAttribute(kHeightReferenceAttribute)) return geo::HeightReference::kUnknown;
  const std::string name = scene.StringAttribute(kHeightReferenceAttribute);
  const std::optional<geo::HeightReference> reference = geo::HeightReferenceNamed(name);
  if (!reference)
    throw base::InputError(scene_h5, "has heights above '" + name + "', which is unknown", "Merge the scene again with `skyquilt merge`");
  return *reference;
}

}  // namespace skyquilt::scene
