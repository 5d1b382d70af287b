// The scenes that are shown, loaded from the files of one or two projects and loaded again when these change.
#pragma once

#include <Eigen/Geometry>
#include <cstdlib>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "coordinator/rendering/scene_session.h"
#include "core/comm/communicator.h"
#include "core/trust/trust.h"
#include "viewer/data/file_look.h"
#include "viewer/data/project_data.h"
#include "viewer/data/survey_place.h"
#include "viewer/engine/batch_size.h"
#include "viewer/engine/engine.h"
#include "viewer/engine/renderer.h"
#include "viewer/protocol/replies.h"

namespace skyquilt::viewer {

// For a scene that rank 0 renders by itself while the other ranks hold another one.
class OneProcess : public comm::SingleCommunicator {
 public:
  // ranks: the real communicator, which ends the other ranks when this one fails. Must outlive it.
  explicit OneProcess(comm::Communicator& ranks) : ranks_(ranks) {}

  [[noreturn]] void Abort(int exit_status) override {
    ranks_.Abort(exit_status);
    std::abort();  // not reached, which the compiler does not see
  }

 private:
  comm::Communicator& ranks_;
};

class SceneHolder : public Renderer {
 public:
  // Loads nothing yet. data must outlive it. Throws base::UsageError for an exposure out of range.
  SceneHolder(const EngineInput& input, ProjectData& data);
  ~SceneHolder() override;

  enum class Change { kNone, kFiles, kScene };
  // Whether files differ from those that were read last; reads none. kFiles: surface or report only.
  Change WhatChanged() const;
  // Until Load is called, nothing can be rendered; state() says that a scene is being loaded.
  void Unload();
  // Reads what has changed and raises the revision. What cannot be loaded becomes a reason in state(). Throws base::Interrupted, and base::UsageError
  // when the exposure names an unknown photo at the first loading.
  void Load();
  // After Change::kFiles.
  void ReloadData();

  // Without the number of clients.
  const EngineState& state() const { return state_; }

  // As Render of the main project, in the brightness of this photo. For Query's PhotoCaster.
  void RenderAsPhoto(int photo, std::span<const render::Ray> rays, std::span<render::RayColor> out);

  // What is known about the errors of the main project's scene. Throws BadMessage, with how to fix it, when nothing is.
  trust::Trust TrustOfMain() const;

  const SceneFrame* Frame(Which project) const override;
  std::string WhyNot(Which project) const override;
  size_t Batch(Which project) const override;
  void Render(Which project, std::span<const render::Ray> rays, std::span<render::RayColor> out) override;
  products::View PhotoView(int photo, int width) const override;
  FieldAccess Access() override;

 private:
  struct Loaded {
    std::unique_ptr<coordinator::SceneSession> session;
    scene::Appearance appearance;
    SceneFrame frame;
    BatchSize batch;
    bool placed = true;  // its place in the main project's frame is known
  };
  struct Place {
    coordinator::Project project;
    comm::Communicator* comm = nullptr;
    std::optional<FileLook> read;  // of scene.h5 when it was read last; none: never
    std::unique_ptr<Loaded> loaded;
    std::string why_not;
  };

  void LoadPlace(Which which);
  void JoinFrames();
  std::vector<FileLook> LookAtData() const;
  Loaded& Need(Which project);
  void Timed(Loaded& loaded, size_t rays, const std::function<void()>& render);
  void UpdateState();

  comm::Communicator& comm_;
  coordinator::RunOptions run_;
  std::string exposure_;
  bool plain_surround_ = true;
  bool verbose_, quiet_;
  ProjectData& data_;
  OneProcess alone_;
  Place main_;
  std::optional<Place> before_;
  std::vector<FileLook> data_read_;
  // Box of a survey's points, for questions while there is no scene.
  std::shared_ptr<const survey::Survey> box_of_;
  Eigen::AlignedBox3d box_;
  bool loading_ = true;
  bool loaded_once_ = false;
  EngineState state_;
};

}  // namespace skyquilt::viewer
