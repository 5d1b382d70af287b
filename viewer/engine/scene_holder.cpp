#include "viewer/engine/scene_holder.h"

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/camera/corner_radius.h"
#include "products/camera_path.h"
#include "products/product_options.h"

namespace skyquilt::viewer {
namespace {

constexpr double kFallbackGsd_m = 0.05;

coordinator::RunOptions WithHalfTheMemory(coordinator::RunOptions run) {
  run.memory_share *= 0.5;
  return run;
}

// After a session with other ranks could not begin: their late messages must not reach the next one.
void DropLateMessages(comm::Communicator& comm) {
  using Clock = std::chrono::steady_clock;
  Clock::time_point last = Clock::now();
  while (Clock::now() - last < std::chrono::seconds(2)) {
    base::ThrowIfCancelled();
    if (comm.TryReceive()) last = Clock::now();
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

}  // namespace

SceneHolder::SceneHolder(const EngineInput& input, ProjectData& data)
    : comm_(input.comm),
      run_(input.before ? WithHalfTheMemory(input.run) : input.run),
      exposure_(input.exposure),
      plain_surround_(input.plain_surround),
      verbose_(input.verbose),
      quiet_(input.quiet),
      data_(data),
      alone_(input.comm) {
  products::ExposureStops(exposure_);
  main_.project = input.project;
  main_.comm = &comm_;
  if (input.before) {
    before_ = Place();
    before_->project = *input.before;
    before_->comm = comm_.size() > 1 ? static_cast<comm::Communicator*>(&alone_) : &comm_;
  }
  data_read_ = LookAtData();
  state_.exposure = exposure_;
  state_.ranks = comm_.size();
  UpdateState();
}

SceneHolder::~SceneHolder() = default;

std::vector<FileLook> SceneHolder::LookAtData() const {
  std::vector<FileLook> looks;
  // The stamps of maps and buildings are written when they are begun and when they are done.
  const auto look_at = [&](const coordinator::Project& project) {
    for (const std::filesystem::path& file : {project.SurfaceTable(), project.MetricsFile(), project.StampFile("products"),
                                              project.StampFile("buildings"), project.BuildingsFile(), project.BlocksFile()}) {
      looks.push_back(LookAt(file));
    }
  };
  look_at(main_.project);
  if (before_) look_at(before_->project);
  return looks;
}

SceneHolder::Change SceneHolder::WhatChanged() const {
  const auto changed = [](const Place& place) { return !place.read || *place.read != LookAt(place.project.SceneFile()); };
  if (changed(main_) || (before_ && changed(*before_))) return Change::kScene;
  return LookAtData() != data_read_ ? Change::kFiles : Change::kNone;
}

void SceneHolder::Unload() {
  const auto unload = [](Place& place) {
    if (place.read && *place.read == LookAt(place.project.SceneFile())) return;
    place.read.reset();
    place.loaded.reset();
  };
  unload(main_);
  if (before_) unload(*before_);
  loading_ = true;
  ++state_.revision;
  UpdateState();
}

void SceneHolder::Load() {
  if (!main_.read) LoadPlace(Which::kMain);
  if (before_ && !before_->read) LoadPlace(Which::kBefore);
  ReloadData();
  JoinFrames();
  loading_ = false;
  loaded_once_ = true;
  UpdateState();
}

void SceneHolder::ReloadData() {
  std::vector<FileLook> looks = LookAtData();
  // ProjectData read everything when it was made.
  const bool again = loaded_once_ || looks != data_read_;
  data_read_ = std::move(looks);
  if (again) {
    try {
      data_.Reload();
    } catch (const base::Interrupted&) {
      throw;
    } catch (const std::exception& error) {
      base::LogWarning("the project could not be read again: {}", error.what());
    }
  }
  ++state_.revision;
}

void SceneHolder::LoadPlace(Which which) {
  Place& place = which == Which::kMain ? main_ : *before_;
  const std::filesystem::path file = place.project.SceneFile();
  place.read = LookAt(file);
  place.loaded.reset();
  place.why_not.clear();
  const std::string merge = "`skyquilt merge " + place.project.folder.filename().string() + "`";
  if (!place.read->exists) {
    place.why_not = "there is no scene.h5 yet. It is written by " + merge + " once training has finished, and will be shown then";
    return;
  }
  const bool ranks = place.comm->size() > 1;
  bool begun = false;
  std::optional<base::UsageError> bad_exposure;
  try {
    // A bad file is found here, before the other ranks begin. With so little memory no fields are read.
    if (ranks) scene::Scene::Load(file, {.memory_bytes = 1.0});
    begun = true;
    auto session = std::make_unique<coordinator::SceneSession>(*place.comm, file, run_, verbose_, quiet_);
    const scene::SceneInfo& info = session->scene().info();
    scene::Appearance appearance;
    try {
      appearance = products::AppearanceOf(exposure_, info);
    } catch (const base::UsageError& error) {
      if (which == Which::kMain) {
        if (!loaded_once_) bad_exposure = error;
        throw;
      }
      base::LogWarning("the earlier project has no photo '{}': its exact frames have normal brightness", exposure_);
    }
    appearance.plain_surround = plain_surround_;
    const SceneFrame frame{.cones = info.scales.Cones(), .min_enu = info.min_enu, .max_enu = info.max_enu, .scene_from_main = std::nullopt};
    const BatchSize batch(session->threads().size(), ranks ? place.comm->size() - 1 : 0);
    place.loaded = std::make_unique<Loaded>(Loaded{.session = std::move(session), .appearance = appearance, .frame = frame, .batch = batch});
    base::LogInfo("{} loaded: {} block(s)", file.string(), info.blocks.size());
    return;
  } catch (const base::Interrupted&) {
    throw;
  } catch (const base::InputError& error) {
    place.why_not = error.file().filename().string() + " " + error.finding();
  } catch (const std::exception& error) {
    place.why_not = error.what();
  }
  if (bad_exposure) throw base::UsageError(*bad_exposure);
  base::LogWarning("no exact frames of {}: {}", place.project.folder.string(), place.why_not);
  if (ranks && begun) DropLateMessages(*place.comm);
}

// Places the earlier scene in the main project's frame.
void SceneHolder::JoinFrames() {
  if (!before_ || !before_->loaded) return;
  const auto place_of = [](const scene::SceneInfo& info) { return SurveyPlace{info.origin, info.georeferenced}; };
  std::optional<SurveyPlace> main;
  if (main_.loaded) {
    main = place_of(main_.loaded->session->scene().info());
  } else if (const auto survey = data_.survey()) {
    main = SurveyPlace{survey->origin, survey->georeferenced};
  }
  const std::optional<geo::Rigid3d> joined =
      main ? OtherFromMain(*main, place_of(before_->loaded->session->scene().info())) : std::optional<geo::Rigid3d>();
  before_->loaded->placed = joined.has_value();
  before_->loaded->frame.scene_from_main = joined;
  if (joined) return;
  before_->why_not = main ? "only one of the two projects is geo-referenced, so they cannot be laid over each other"
                          : "the place of this project is unknown, because neither its scene nor its survey can be read";
}

void SceneHolder::UpdateState() {
  state_.ready = main_.loaded != nullptr && !loading_;
  if (loading_) {
    state_.reason = "the scene is being loaded";
  } else if (!main_.loaded) {
    state_.reason = main_.why_not;
  } else {
    state_.reason = before_ && Frame(Which::kBefore) == nullptr ? "no exact frames of the earlier project: " + before_->why_not : "";
  }
}

trust::Trust SceneHolder::TrustOfMain() const {
  if (Frame(Which::kMain) == nullptr) throw BadMessage(WhyNot(Which::kMain));
  try {
    return trust::LoadTrustOf(main_.project.SceneFile());
  } catch (const base::InputError& error) {
    base::LogWarning("no map of the errors to expect: {}", error.what());
    throw BadMessage("it is not known how far this scene can be trusted: merge it again (skyquilt merge " + main_.project.folder.filename().string() +
                     " --restart) with trust.tiles above 0");
  }
}

const SceneFrame* SceneHolder::Frame(Which project) const {
  if (loading_) return nullptr;
  if (project == Which::kMain) return main_.loaded ? &main_.loaded->frame : nullptr;
  return before_ && before_->loaded && before_->loaded->placed ? &before_->loaded->frame : nullptr;
}

std::string SceneHolder::WhyNot(Which project) const {
  if (project == Which::kBefore && !before_) return "there is no earlier project; `skyquilt view --compare` names one";
  if (loading_) return "the scene is being loaded";
  return project == Which::kMain ? main_.why_not : before_->why_not;
}

SceneHolder::Loaded& SceneHolder::Need(Which project) {
  if (Frame(project) == nullptr) throw BadMessage(WhyNot(project));
  return project == Which::kMain ? *main_.loaded : *before_->loaded;
}

size_t SceneHolder::Batch(Which project) const {
  if (Frame(project) == nullptr) return 1;
  return (project == Which::kMain ? main_ : *before_).loaded->batch.rays();
}

void SceneHolder::Timed(Loaded& loaded, size_t rays, const std::function<void()>& render) {
  using Clock = std::chrono::steady_clock;
  const int64_t loads = loaded.session->scene().statistics().field_loads;
  const Clock::time_point start = Clock::now();
  render();
  loaded.batch.Add(rays, std::chrono::duration<double>(Clock::now() - start).count(), loaded.session->scene().statistics().field_loads != loads);
}

void SceneHolder::Render(Which project, std::span<const render::Ray> rays, std::span<render::RayColor> out) {
  Loaded& loaded = Need(project);
  Timed(loaded, rays.size(), [&] { loaded.session->scene().RenderRaysOverBackground(rays, out, loaded.appearance, loaded.session->threads()); });
}

void SceneHolder::RenderAsPhoto(int photo, std::span<const render::Ray> rays, std::span<render::RayColor> out) {
  Loaded& loaded = Need(Which::kMain);
  const auto survey = data_.survey();
  if (!survey || photo < 0 || static_cast<size_t>(photo) >= survey->photos.size()) throw BadMessage("the survey has no such photo");
  const brightness::Response& response = loaded.session->scene().info().response;
  const scene::Appearance recorded{.look = scene::Rendition::kRecorded};
  Timed(loaded, rays.size(), [&] { loaded.session->scene().RenderRaysOverBackground(rays, out, recorded, loaded.session->threads()); });
  const survey::Photo& taken = survey->photos[static_cast<size_t>(photo)];
  const std::optional<size_t> index = response.Find(taken.name);
  if (!index) return;
  const camera::Camera& camera = survey->cameras.at(static_cast<size_t>(taken.camera));
  const camera::CornerRadius radius(camera);
  for (size_t i = 0; i < rays.size(); ++i) {
    const auto pixel = camera.ImgFromCam(taken.cam_from_enu.rotation * rays[i].direction_enu);
    const Eigen::Vector2d at = pixel.value_or(camera.PrincipalPoint());
    const brightness::PicturePlace place = {static_cast<float>(at.x() / camera.width), static_cast<float>(at.y() / camera.height)};
    brightness::Expose(response.ExposureOf(*index, pixel ? std::min(1.0F, radius.Squared(*pixel)) : 0.0F, place), out[i].rgb_srgb);
  }
}

products::View SceneHolder::PhotoView(int photo, int width) const {
  const auto survey = data_.survey();
  if (!survey) throw BadMessage("photo: the survey of this project cannot be read");
  if (photo < 0 || static_cast<size_t>(photo) >= survey->photos.size()) {
    throw BadMessage("photo: must be a number from 0, less than the number of photos, which is " + std::to_string(survey->photos.size()));
  }
  return products::ViewsOfPhotos(*survey, {survey->photos[static_cast<size_t>(photo)].name}, width).front();
}

FieldAccess SceneHolder::Access() {
  FieldAccess access;
  access.gsd_m = kFallbackGsd_m;
  const auto caster = [this](Which project) -> RayCaster {
    return [this, project](std::span<const render::Ray> rays, std::span<render::RayColor> out) {
      Loaded& loaded = Need(project);
      std::vector<render::Ray> moved;
      std::span<const render::Ray> ours = rays;
      if (const std::optional<geo::Rigid3d>& place = loaded.frame.scene_from_main) {
        moved.assign(rays.begin(), rays.end());
        for (render::Ray& ray : moved) {
          ray.origin_enu = *place * ray.origin_enu;
          ray.direction_enu = (place->rotation * ray.direction_enu).normalized();
        }
        ours = moved;
      }
      Timed(loaded, rays.size(), [&] { loaded.session->scene().RenderRays(ours, out, loaded.appearance, loaded.session->threads()); });
    };
  };
  if (Frame(Which::kMain) != nullptr) {
    access.main = caster(Which::kMain);
    const scene::SceneInfo& info = main_.loaded->session->scene().info();
    access.min_enu = info.min_enu;
    access.max_enu = info.max_enu;
    if (info.gsd_m > 0.0) access.gsd_m = info.gsd_m;
    access.batch = Batch(Which::kMain);
  } else if (const auto survey = data_.survey(); survey && !survey->points.empty()) {
    if (survey != box_of_) {
      box_of_ = survey;
      box_.setEmpty();
      for (const survey::SparsePoint& point : survey->points) box_.extend(point.x_in_enu);
    }
    access.min_enu = box_.min();
    access.max_enu = box_.max();
  }
  if (const SceneFrame* before = Frame(Which::kBefore)) {
    access.before = caster(Which::kBefore);
    // What stood higher or lay lower before must be inside too.
    const geo::Rigid3d main_from_before = before->scene_from_main.value_or(geo::Rigid3d()).Inverse();
    Eigen::AlignedBox3d box;
    for (int corner = 0; corner < 8; ++corner) {
      Eigen::Vector3d x;
      for (int axis = 0; axis < 3; ++axis) x[axis] = (corner >> axis & 1) != 0 ? before->max_enu[axis] : before->min_enu[axis];
      box.extend(main_from_before * x);
    }
    access.before_min_enu = box.min();
    access.before_max_enu = box.max();
    access.min_enu.z() = std::min(access.min_enu.z(), box.min().z());
    access.max_enu.z() = std::max(access.max_enu.z(), box.max().z());
    access.batch = access.main ? std::min(access.batch, Batch(Which::kBefore)) : Batch(Which::kBefore);
  }
  return access;
}

}  // namespace skyquilt::viewer
