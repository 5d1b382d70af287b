#include "coordinator/stages/stage_inputs.h"

#include <filesystem>

#include "core/base/errors.h"
#include "core/survey/made_masks.h"
#include "prepare/georeference/tags/photo_positions.h"
#include "prepare/input/masks/masks.h"
#include "prepare/rigs/rig_config.h"
#include "prepare/video/find_videos.h"

namespace skyquilt::coordinator {
namespace {

// Of masks that were found beside the photo folder, images/; empty when there are none. Those in the folder are among its pictures.
std::string MasksIdentity(const Pipeline& pipeline) {
  if (!pipeline.settings.prepare.masks.empty() || !pipeline.videos.empty() || !std::filesystem::is_directory(pipeline.photos)) return "";
  const prepare::input::MaskPlaces places = prepare::input::FindMaskPlaces(std::filesystem::canonical(pipeline.photos), "", {});
  std::string identity;
  for (const std::filesystem::path& folder : places.folders) identity += PhotosIdentity(folder, pipeline.project.folder);
  for (const std::filesystem::path& file : places.shared) identity += FileIdentity(file);
  return identity.empty() ? "" : base::HashHex(identity);
}

// They matter to videos alone: records of surveys of photos do without.
const std::vector<std::string>& VideoOptionNames() {
  static const std::vector<std::string> names = {"prepare.video_overlap", "prepare.video_limit", "prepare.video_size",
                                                 "prepare.video_clock_offset_s"};
  return names;
}

// They matter to panoramas and rigs alone: they count where they are not the default.
const std::vector<std::string>& RigOptionNames() {
  static const std::vector<std::string> names = {"prepare.panoramas",
                                                 "prepare.panorama_views",
                                                 "prepare.panorama_pitches",
                                                 "prepare.panorama_fov_deg",
                                                 "prepare.panorama_width",
                                                 "prepare.nadir_mask_deg",
                                                 "prepare.rig"};
  return names;
}

void AddRigInputs(const Pipeline& pipeline, FlatOptions* inputs) {
  const FlatOptions usual = Select(Settings().Flat(), RigOptionNames());
  for (const auto& [name, value] : Select(pipeline.settings.Flat(), RigOptionNames())) {
    if (usual.at(name) != value) (*inputs)[name] = value;
  }
  if (!std::filesystem::is_directory(pipeline.photos)) return;
  const std::filesystem::path images = pipeline.photos / "images";
  const std::filesystem::path rig =
      prepare::rigs::FindRigConfig(std::filesystem::is_directory(images) ? images : pipeline.photos, pipeline.settings.prepare.rig);
  if (!rig.empty()) (*inputs)["rig"] = FileIdentity(rig);
}

// Of the file that limits the products.
std::string BoundaryIdentity(const Pipeline& pipeline) {
  const std::string& file = pipeline.settings.products.boundary;
  return file.empty() ? "" : FileIdentity(file);
}

// What heights are above is an input, so that another choice makes the files again. The default is left out: it gives what older programs gave.
void AddVertical(const Pipeline& pipeline, FlatOptions* inputs) {
  const std::string& vertical = pipeline.settings.products.vertical;
  if (vertical != products::ProductOptions().vertical) (*inputs)["vertical"] = vertical;
}

// The kinds of products that stage "products" makes; what photos that look down give is what older programs gave, and is left out.
void AddKinds(const Pipeline& pipeline, FlatOptions* inputs) {
  const auto made = [](products::ProductKinds kinds) {
    kinds.terrain = kinds.buildings = false;  // by other stages
    return products::NamesOf(kinds);
  };
  const std::string kinds = made(KindsOf(pipeline));
  if (kinds != made(products::KindsOf("auto", false))) (*inputs)["kinds"] = kinds;
}

// Of a file that an option names; empty for none. Throws base::InputError when it is not there, before earlier results are removed.
std::string NamedFileIdentity(const std::string& file, const std::string& option) {
  if (file.empty()) return "";
  if (!std::filesystem::is_regular_file(file)) throw base::InputError(file, "no such file", "Correct " + option + ", or leave it empty");
  return FileIdentity(file);
}

}  // namespace

std::string SurveyIdentity(const Project& project) {
  const std::filesystem::path tracks = project.SurveyFolder() / "tracks.bin";
  std::string identity = FileIdentity(project.SurveyFolder() / "survey.json") + " " + FileIdentity(project.SurveyFolder() / "points.ply");
  // Surveys of older programs have none, and keep their identity.
  if (std::filesystem::exists(tracks)) identity.append(" ").append(FileIdentity(tracks));
  return identity;
}

std::string MaskedSurveyIdentity(const Pipeline& pipeline) {
  const Project& project = pipeline.project;
  const std::filesystem::path masks = survey::MadeMasksFile(project.SurveyFolder());
  std::string identity = SurveyIdentity(project);
  if (std::filesystem::exists(masks)) {
    identity.append(" ").append(FileIdentity(masks));
  } else if (pipeline.settings.masks.Any()) {
    throw base::InputError(masks, "does not exist yet, but section [masks] asks for masks",
                           "Run 'skyquilt masks " + project.folder.string() + "' first");
  }
  return identity;
}

std::vector<std::string> OptionsAmongInputs() {
  std::vector<std::string> names = {"prepare.holdout_poses", "prepare.alpha", "prepare.bands", "prepare.photos"};
  names.insert(names.end(), VideoOptionNames().begin(), VideoOptionNames().end());
  names.insert(names.end(), RigOptionNames().begin(), RigOptionNames().end());
  return names;
}

FlatOptions PrepareInputs(const Pipeline& pipeline) {
  FlatOptions inputs{{"photos", pipeline.photos.string()}, {"model", pipeline.model.string()}};
  if (pipeline.videos.empty()) {
    inputs["images"] = PhotosIdentity(pipeline.photos, pipeline.project.folder);
    const std::string developed = DevelopedIdentity(pipeline.photos, pipeline.project.folder);
    if (!developed.empty()) inputs["HEIC and raw"] = developed;
  } else {
    // Their frames are a result.
    inputs["videos"] = base::HashHex(prepare::video::VideosIdentity(pipeline.videos));
    FlatOptions options = Select(pipeline.settings.Flat(), VideoOptionNames());
    inputs.merge(options);
  }
  if (std::filesystem::is_regular_file(pipeline.model)) inputs["model file"] = FileIdentity(pipeline.model);
  const std::filesystem::path images = pipeline.photos / "images";
  std::string positions;
  for (const std::filesystem::path& file :
       prepare::georeference::PositionFiles(std::filesystem::is_directory(images) ? images : pipeline.photos, pipeline.settings.prepare.geo_file)) {
    positions += FileIdentity(file);
  }
  if (!positions.empty()) inputs["positions"] = base::HashHex(positions);
  const prepare::PrepareOptions& options = pipeline.settings.prepare;
  std::string control;
  for (const std::string& file : {options.gcp, options.gcp_marks, options.check_points}) {
    // The check points may be labels.
    if (std::filesystem::is_regular_file(file)) control += FileIdentity(file);
  }
  if (!control.empty()) inputs["control points"] = base::HashHex(control);
  if (options.holdout_poses != prepare::PrepareOptions().holdout_poses) inputs["prepare.holdout_poses"] = options.holdout_poses;
  if (!options.photos.empty()) inputs["prepare.photos"] = options.photos;
  const std::string masks = MasksIdentity(pipeline);
  if (!masks.empty()) inputs["masks"] = masks;
  if (!options.bands.empty()) inputs["prepare.bands"] = options.bands;
  if (options.alpha != prepare::PrepareOptions().alpha) inputs["prepare.alpha"] = options.alpha;
  AddRigInputs(pipeline, &inputs);
  return inputs;
}

FlatOptions ProductInputs(const Pipeline& pipeline) {
  FlatOptions inputs{{"scene", FileIdentity(pipeline.project.StampFile("merge"))}, {"boundary", BoundaryIdentity(pipeline)}};
  AddVertical(pipeline, &inputs);
  AddKinds(pipeline, &inputs);
  return inputs;
}

FlatOptions SurfaceInputs(const Pipeline& pipeline) {
  FlatOptions inputs{{"scene", FileIdentity(pipeline.project.StampFile("merge"))},
                     {"survey", MaskedSurveyIdentity(pipeline)},
                     {"boundary", BoundaryIdentity(pipeline)}};
  AddVertical(pipeline, &inputs);
  if (!KindsOf(pipeline).terrain) inputs["terrain"] = "none";
  return inputs;
}

FlatOptions MaskInputs(const Pipeline& pipeline) {
  const masks::MaskOptions& options = pipeline.settings.masks;
  return {{"survey", SurveyIdentity(pipeline.project)},
          {"network", NamedFileIdentity(options.segment, "masks.segment")},
          {"network's configuration", NamedFileIdentity(options.segment_config, "masks.segment_config")},
          {"ignored ground", NamedFileIdentity(options.ignore_ground, "masks.ignore_ground")}};
}

std::string FootprintsIdentity(const Pipeline& pipeline) {
  const std::string& file = pipeline.settings.buildings.footprints;
  if (file.empty()) return "";
  // Before earlier results are removed.
  if (!std::filesystem::is_regular_file(file)) {
    throw base::InputError(file, "no such file", "Give a file with outlines as buildings.footprints, or leave it empty to find buildings");
  }
  return FileIdentity(file);
}

}  // namespace skyquilt::coordinator
