#include "merge/merge.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/errors.h"
#include "core/brightness/luminance.h"
#include "core/brightness/response.h"
#include "core/render/trained_field.h"
#include "core/scene/background.h"
#include "core/scene/field_file.h"
#include "core/scene/scene_file.h"

namespace skyquilt::merge {
namespace {

struct Loaded {
  render::TrainedField description;
  brightness::Response response;  // this and the fields below are read from the context only
  brightness::Luminance luminance;
  brightness::LuminanceState luminance_state;
  scene::Background background;
};

Loaded LoadTrained(const std::filesystem::path& file, const std::string& kind, const geo::Geodetic& origin) {
  if (!std::filesystem::exists(file)) throw base::InputError(file, "is missing", "Run `skyquilt train` to the end first");
  const checkpoint::ArchiveReader reader(file);
  if (reader.kind() != kind)
    throw base::InputError(file, "is a " + reader.kind() + " file, not a " + kind,
                           "Put this project's own checkpoint there, or train again with --restart");
  reader.RequireVersion(scene::kCheckpointVersion);
  if (reader.IntAttribute("complete") == 0) throw base::InputError(file, "is not trained to the end", "Run `skyquilt train` again; it resumes");
  const bool same_place = reader.DoubleAttribute("origin_latitude_deg") == origin.latitude_deg &&
                          reader.DoubleAttribute("origin_longitude_deg") == origin.longitude_deg &&
                          reader.DoubleAttribute("origin_height_m") == origin.height_m;
  if (!same_place) throw base::InputError(file, "belongs to a survey with another origin", "Train this survey again with --restart");
  Loaded loaded{scene::GetDescription(reader, file, ""), {}, {}, {}, {}};
  if (kind != "context") return loaded;
  loaded.response = brightness::GetResponse(reader, file);
  brightness::GetLuminance(reader, &loaded.luminance, &loaded.luminance_state);
  loaded.background = scene::GetBackground(reader, file);
  return loaded;
}

}  // namespace

void MergeScene(const MergeInput& input) {
  if (input.blocks.empty()) throw base::InputError(input.scene, "there is no trained block to merge", "Run `skyquilt train` first");
  const Loaded context = LoadTrained(input.context, "context", input.origin);
  const bool nothing_to_show =
      !input.use_context && std::all_of(input.blocks.begin(), input.blocks.end(), [](const TrainedBlock& block) { return block.shows_context; });
  if (nothing_to_show)
    throw base::InputError(input.scene, "no block can be shown without the context", "Train longer, or with train.coupling = guided");
  std::vector<render::TrainedField> blocks, covered;
  std::vector<std::filesystem::path> files;
  double gsd_m = std::numeric_limits<double>::infinity();
  for (const TrainedBlock& block : input.blocks) {
    (block.shows_context ? covered : blocks).push_back(LoadTrained(block.checkpoint, "block", input.origin).description);
    if (!block.shows_context) files.push_back(block.checkpoint);
    gsd_m = std::min(gsd_m, block.gsd_m);
  }

  checkpoint::ArchiveWriter writer(scene::kSceneKind, scene::kSceneVersion);
  writer.SetAttribute("origin_latitude_deg", input.origin.latitude_deg);
  writer.SetAttribute("origin_longitude_deg", input.origin.longitude_deg);
  writer.SetAttribute("origin_height_m", input.origin.height_m);
  writer.SetAttribute("georeferenced", static_cast<int64_t>(input.georeferenced ? 1 : 0));
  scene::PutAccuracy(input.accuracy, writer);
  scene::PutHeightReference(input.height_reference, writer);
  brightness::PutResponse(context.response, writer);
  brightness::PutLuminance(context.luminance, context.luminance_state, writer);
  scene::PutBackground(context.background, writer);
  writer.SetAttribute("gsd_m", std::isfinite(gsd_m) ? gsd_m : 0.0);
  writer.SetAttribute(scene::kBordersAttribute, scene::NameOf(input.borders));
  writer.SetAttribute("config", input.config_toml);
  writer.SetAttribute("config_hash", input.config_hash);
  writer.SetAttribute("blocks", static_cast<int64_t>(blocks.size()));
  const auto put = [&](const render::TrainedField& field, const std::filesystem::path& file, const std::string& prefix) {
    const std::vector<float> code = input.look.empty() ? std::vector<float>() : CodeOfLook(input.look, file);
    scene::PutSceneField(field, file, prefix, writer, input.storage, code);
  };
  if (input.use_context) put(context.description, input.context, scene::kContextPrefix);
  for (size_t i = 0; i < blocks.size(); ++i) put(blocks[i], files[i], scene::BlockPrefix(static_cast<int64_t>(i)));
  writer.SetAttribute(scene::kCoveredBlocksAttribute, static_cast<int64_t>(covered.size()));
  for (size_t i = 0; i < covered.size(); ++i) scene::PutDescription(covered[i], scene::CoveredBlockPrefix(static_cast<int64_t>(i)), writer);
  writer.Commit(input.scene);
}

}  // namespace skyquilt::merge
