// The work of stage "tour", and exports to other folders.
#include <nlohmann/json.hpp>
#include <optional>
#include <system_error>

#include "buildings/files/building_files.h"
#include "coordinator/rendering/scene_session.h"
#include "coordinator/stages/stage_bodies.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/log.h"
#include "tour/export/disk_space.h"
#include "tour/export/export_tour.h"
#include "tour/export/tour_video.h"
#include "tour/format/tour_file.h"
#include "tour/propose/propose_tour.h"
#include "tour/ways/heights.h"

namespace skyquilt::coordinator {
namespace {

bool HasFile(const std::filesystem::path& file) {
  std::error_code error;
  return std::filesystem::exists(std::filesystem::symlink_status(file, error));
}

std::vector<tour::BuildingMark> MarksOf(const std::filesystem::path& file) {
  std::vector<tour::BuildingMark> marks;
  if (file.empty()) return marks;
  const buildings::BuildingSet set = buildings::LoadBuildings(file);
  for (const buildings::Building& building : set.buildings) {
    Eigen::AlignedBox2d box;
    for (const Eigen::Vector2d& corner : building.footprint.outer) box.extend(corner);
    if (box.isEmpty()) continue;
    const Eigen::Vector2d middle = box.center();
    tour::BuildingMark mark;
    mark.id = building.id;
    mark.roof = buildings::NameOf(building.roof);
    mark.middle_enu = {middle.x(), middle.y(), building.shape.ground_z};
    mark.length_m = building.measures.length_m.value / set.scale;
    mark.width_m = building.measures.width_m.value / set.scale;
    mark.height_m = building.measures.height_m.value / set.scale;
    mark.scale = set.scale;
    mark.metric = set.metric;
    mark.accepted = building.accepted;
    mark.seen = building.measures.wall_seen;
    marks.push_back(std::move(mark));
  }
  return marks;
}

std::optional<tour::Heights> HeightsOf(const tour::ExportParts& parts) {
  if (!parts.terrain) return {};
  try {
    return tour::HeightsFromTerrain(parts.terrain());
  } catch (const std::runtime_error& damage) {
    base::LogWarning("ways and views of the tour do without the surface model: {}", damage.what());
    return {};
  }
}

tour::Tour Propose(const Project& project, const scene::SceneInfo& info, const tour::ExportParts& parts, int stops) {
  const nlohmann::json description = base::ParseJson(parts.project_json);
  const std::optional<tour::Heights> heights = HeightsOf(parts);
  tour::ProposeInput input;
  input.name = description.value("name", "");
  input.box_enu = {info.min_enu, info.max_enu};
  input.ground_m = description.value("ground_m", info.min_enu.z());
  input.heights = heights ? &*heights : nullptr;
  input.buildings = MarksOf(parts.buildings);
  input.metric = info.georeferenced || info.accuracy.HasScale();
  input.stops = stops;
  tour::Tour proposed = tour::ProposeTour(input);
  base::LogInfo("tour of {} stop(s) proposed: {}", proposed.stops.size(), project.TourFile().string());
  return proposed;
}

// Hash of a tour.json that is still as it was proposed; empty when there is none.
std::string ProposedHash(const Project& project) {
  return HasFile(project.TourProposal()) ? base::ReadFile(project.TourProposal()) : "";
}

bool IsEdited(const Project& project) {
  return HasFile(project.TourFile()) && base::HashHex(base::ReadFile(project.TourFile())) != ProposedHash(project);
}

// Makes the project's tour, unless there is one to export as it is.
void ProvideTour(const Project& project, const scene::SceneInfo& info, const tour::ExportParts& parts, int auto_stops) {
  if (IsEdited(project)) return;
  if (auto_stops == 0) {
    if (HasFile(project.TourFile())) return;
    throw base::InputError(project.TourFile(), "does not exist: this project has no tour",
                           "Make one with 'skyquilt view --edit', or let one be proposed with --auto 3");
  }
  tour::SaveTour(Propose(project, info, parts, auto_stops), project.folder);
  std::filesystem::create_directories(project.StateFolder());
  base::WriteFileAtomically(project.TourProposal(), base::HashHex(base::ReadFile(project.TourFile())));
}

void Export(Pipeline& pipeline, const TourRequest& request) {
  const Project& project = pipeline.project;
  const Settings& settings = pipeline.settings;
  SKYQUILT_CHECK(pipeline.tour_parts != nullptr, "nobody has the page of tours");
  SceneSession session(pipeline.comm, project.SceneFile(), settings.run, pipeline.verbose, pipeline.quiet, &pipeline.rendering_s);
  const tour::ExportParts parts = pipeline.tour_parts(project);
  ProvideTour(project, session.scene().info(), parts, request.auto_stops);
  const tour::PictureField field = tour::FieldOf(session.scene(), project.SceneFile(), settings.products.plain_surround, session.threads());
  tour::ExportInput input{.project = project.folder,
                          .work = project.TourWorkFolder(),
                          .out = request.out,
                          .exposure = settings.products.exposure,
                          .options = settings.tour,
                          .make_video = nullptr};
  if (request.video) {
    input.make_video = [&](const tour::Tour& of, const std::filesystem::path& file) {
      const products::ProductOptions& products = settings.products;
      const tour::VideoSpec spec{products.video_width, products.video_height, products.video_fps, products.exposure};
      const std::optional<tour::Heights> heights = HeightsOf(parts);
      tour::WriteTourVideo(of, heights ? &*heights : nullptr, field, spec, file);
    };
  }
  const tour::Exported exported = tour::ExportTour(input, parts, field, session.threads());
  base::LogInfo("tour of {} stop(s), {}: {}", exported.stops, tour::MegabytesText(exported.bytes), (request.out / "index.html").string());
}

}  // namespace

std::string EditedTourIdentity(const Project& project) {
  return IsEdited(project) ? FileIdentity(project.TourFile()) : "";
}

void ExportProjectTour(Pipeline& pipeline, const TourRequest& request) {
  if (request.auto_stops > 0 && IsEdited(pipeline.project)) {
    throw base::UsageError("--auto would replace " + pipeline.project.TourFile().string() +
                           ", which was not proposed or was edited since. Leave --auto out to export it, or move it away first");
  }
  Export(pipeline, request);
}

std::string TourBody(Pipeline& pipeline, const StageStamp& /*stamp*/) {
  if (IsEdited(pipeline.project)) base::LogInfo("{} is exported as it is", pipeline.project.TourFile().string());
  Export(pipeline, {.out = pipeline.project.TourFolder(), .auto_stops = pipeline.settings.tour.auto_stops, .video = false});
  return StageStamp::kDone;
}

}  // namespace skyquilt::coordinator
