// The whole engine on project folders, with clients that are plain functions.
#include "viewer/engine/engine.h"

#include <gtest/gtest.h>

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "products/camera_path.h"
#include "tests/support/connect_alone.h"
#include "tests/support/in_temporary_folder.h"
#include "tests/viewer/engine/whole_scene.h"
#include "viewer/engine/scene_holder.h"
#include "viewer/protocol/frame.h"

namespace skyquilt::viewer {
namespace {

using EngineTest = InTemporaryFolder;
using SceneHolderTest = InTemporaryFolder;

// A folder that counts as a project, without a survey.
coordinator::Project EmptyProject(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder / ".state");
  base::WriteFileAtomically(folder / ".state" / "prepare.json", "{}");
  return coordinator::Project::Open(folder);
}

EngineInput InputOf(comm::Communicator& comm, const coordinator::Project& project) {
  EngineInput input{.comm = comm, .project = project, .before = {}, .run = {}, .exposure = "normal"};
  input.run.threads = 2;
  return input;
}

// Runs an engine on a thread and keeps what it sends to one client.
class RunningEngine {
 public:
  RunningEngine(const EngineInput& input, ProjectData& data) : engine(input, data) {
    base::ClearCancel();
    thread_ = std::thread([this] {
      engine.Run({.send =
                      [this](ClientId client, const OutMessage& message) {
                        const std::lock_guard lock(mutex_);
                        (message.binary ? frames_ : texts_).push_back(*message.bytes);
                        if (message.binary) {
                          const FrameHeader header = DecodeFrame(*message.bytes).header;
                          engine.OnMessage(client, FrameAck{header.seq, header.pass});
                        }
                        changed_.notify_all();
                      },
                  .queued = [](ClientId) { return size_t{0}; }});
    });
  }
  ~RunningEngine() {
    base::RequestCancel();
    thread_.join();
    base::ClearCancel();
  }
  // Waits for a text with this part, and returns it. Empty after a minute.
  std::string Text(const std::string& part) {
    std::unique_lock lock(mutex_);
    std::string found;
    changed_.wait_for(lock, std::chrono::minutes(1), [&] {
      for (const std::string& text : texts_) {
        if (text.find(part) != std::string::npos) found = text;
      }
      return !found.empty();
    });
    return found;
  }
  // Waits for a view's last pass; earlier ones are left out when they come too late. Empty header after a minute.
  DecodedFrame LastPass(uint32_t seq) {
    std::unique_lock lock(mutex_);
    DecodedFrame found;
    changed_.wait_for(lock, std::chrono::minutes(1), [&] {
      for (const std::string& bytes : frames_) {
        DecodedFrame frame = DecodeFrame(bytes);
        if (frame.header.seq == seq && frame.header.pass == 2) found = std::move(frame);
      }
      return found.header.seq == seq;
    });
    return found;
  }
  void Forget() {
    const std::lock_guard lock(mutex_);
    texts_.clear();
    frames_.clear();
  }

  Engine engine;

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<std::string> texts_, frames_;
  std::thread thread_;
};

ViewRequest FromAbove(uint32_t seq) {
  ViewRequest view;
  view.seq = seq;
  view.eye_enu = {2.5, 2.5, 12.0};
  view.cam_from_enu = products::PoseFromAngles(view.eye_enu, 0.0, -90.0, 0.0).rotation;
  view.fovy_deg = 40.0;
  view.width = 96;
  view.height = 64;
  return view;
}

TEST_F(EngineTest, ServesFramesAndPicksAndNoticesANewScene) {
  const coordinator::Project project = EmptyProject(folder_.path() / "town");
  WriteWholeScene(project.SceneFile(), {.solid = true});
  const auto comm = comm::ConnectAlone();
  ProjectData data(project);
  RunningEngine running(InputOf(*comm, project), data);
  running.engine.OnOpen(3);
  EXPECT_NE(running.Text("welcome").find("3"), std::string::npos);
  ASSERT_FALSE(running.Text("\"ready\":true").empty());
  running.engine.OnMessage(3, FromAbove(1));
  const DecodedFrame last = running.LastPass(1);
  ASSERT_EQ(last.header.seq, 1U);
  PickRequest pick;
  pick.id = 11;
  pick.origin_enu = {2.5, 2.5, 12.0};
  pick.direction_enu = -Eigen::Vector3d::UnitZ();
  running.engine.OnMessage(3, pick);
  const std::string picked = running.Text("picked"), key = "\"depth_m\":";
  ASSERT_NE(picked.find(key), std::string::npos);
  EXPECT_NEAR(std::stod(picked.substr(picked.find(key) + key.size())), 8.0, 0.1);

  running.Forget();
  WriteWholeScene(project.SceneFile(), {.seed = 99});
  ASSERT_FALSE(running.Text("\"ready\":true").empty());
  running.engine.OnMessage(3, FromAbove(2));
  const DecodedFrame newer = running.LastPass(2);
  EXPECT_EQ(newer.header.seq, 2U);
  EXPECT_GT(newer.header.revision, last.header.revision);
  EXPECT_NE(newer.color, last.color);
  running.engine.OnClose(3);
}

TEST_F(EngineTest, GoesOnWithoutASceneUntilThereIsOne) {
  const coordinator::Project project = EmptyProject(folder_.path() / "town");
  const auto comm = comm::ConnectAlone();
  ProjectData data(project);
  RunningEngine running(InputOf(*comm, project), data);
  running.engine.OnOpen(1);
  EXPECT_FALSE(running.Text("skyquilt merge").empty());
  running.Forget();
  base::WriteFileAtomically(project.SceneFile(), "not a scene");
  EXPECT_NE(running.Text("scene.h5 ").find("\"ready\":false"), std::string::npos);
  WriteWholeScene(project.SceneFile());
  EXPECT_FALSE(running.Text("\"ready\":true").empty());
  running.engine.OnMessage(1, FromAbove(1));
  EXPECT_EQ(running.LastPass(1).header.seq, 1U);
}

TEST_F(SceneHolderTest, TheEarlierSceneIsPlacedByItsOrigin) {
  base::ClearCancel();
  const coordinator::Project project = EmptyProject(folder_.path() / "now"), before = EmptyProject(folder_.path() / "then");
  WriteWholeScene(project.SceneFile(), {.solid = true});
  // 20 m higher: what has z = 4 there has z = 24 here.
  WriteWholeScene(before.SceneFile(),
                  {.origin = {kSceneOrigin.latitude_deg, kSceneOrigin.longitude_deg, kSceneOrigin.height_m + 20.0}, .solid = true});
  const auto comm = comm::ConnectAlone();
  ProjectData data(project);
  EngineInput input = InputOf(*comm, project);
  input.before = before;
  SceneHolder scenes(input, data);
  EXPECT_FALSE(scenes.state().ready);
  EXPECT_EQ(scenes.WhatChanged(), SceneHolder::Change::kScene);
  scenes.Load();
  EXPECT_EQ(scenes.WhatChanged(), SceneHolder::Change::kNone);
  EXPECT_TRUE(scenes.state().ready);
  EXPECT_EQ(scenes.state().reason, "");
  const FieldAccess access = scenes.Access();
  const std::vector<render::Ray> down = {{.origin_enu = {2.5, 2.5, 50.0}, .direction_enu = -Eigen::Vector3d::UnitZ()}};
  std::vector<render::RayColor> now(1), then(1);
  access.main(down, now);
  access.before(down, then);
  EXPECT_NEAR(now[0].depth_median, 46.0, 0.1);
  EXPECT_NEAR(then[0].depth_median, 26.0, 0.1);
  EXPECT_GE(access.max_enu.z(), 23.9);  // vertical rays start above both

  // A file of the report: the scene stays.
  std::filesystem::create_directories(project.ReportFolder());
  base::WriteFileAtomically(project.MetricsFile(), "{}");
  EXPECT_EQ(scenes.WhatChanged(), SceneHolder::Change::kFiles);
  const uint32_t revision = scenes.state().revision;
  scenes.ReloadData();
  EXPECT_EQ(scenes.WhatChanged(), SceneHolder::Change::kNone);
  EXPECT_GT(scenes.state().revision, revision);

  // The earlier scene becomes one without a place.
  WriteWholeScene(before.SceneFile(), {.georeferenced = false});
  EXPECT_EQ(scenes.WhatChanged(), SceneHolder::Change::kScene);
  scenes.Unload();
  EXPECT_EQ(scenes.Frame(Which::kMain), nullptr);
  scenes.Load();
  EXPECT_TRUE(scenes.state().ready);
  EXPECT_EQ(scenes.Frame(Which::kBefore), nullptr);
  EXPECT_NE(scenes.state().reason.find("geo-referenced"), std::string::npos);
  EXPECT_FALSE(scenes.Access().before);
}

TEST_F(SceneHolderTest, AWrongExposureEndsTheCommand) {
  base::ClearCancel();
  const coordinator::Project project = EmptyProject(folder_.path() / "town");
  WriteWholeScene(project.SceneFile());
  const auto comm = comm::ConnectAlone();
  ProjectData data(project);
  EngineInput input = InputOf(*comm, project);
  input.exposure = "99";
  EXPECT_THROW(SceneHolder(input, data), base::UsageError);
  input.exposure = "no_such_photo.jpg";
  SceneHolder scenes(input, data);
  EXPECT_THROW(scenes.Load(), base::UsageError);
}

}  // namespace
}  // namespace skyquilt::viewer
