#include "coordinator/tasks/rank_tasks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <optional>
#include <thread>
#include <vector>

#include "coordinator/ranks/rank_messages.h"
#include "coordinator/tasks/task_message.h"
#include "core/base/cancel.h"
#include "core/base/file.h"
#include "tests/coordinator/scheduler/fake_ranks.h"
#include "tests/masks/mask_survey.h"
#include "tests/prepare/poses/fake_extractor.h"
#include "tests/support/error_of.h"
#include "tests/support/made_database.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::coordinator {
namespace {

comm::Message MessageFrom(FakeRank& comm, int tag) {
  while (true) {
    const std::optional<comm::Message> message = comm.TryReceive();
    if (message && message->tag == tag) return *message;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}

// Rank 0 in this thread, two other ranks in threads of their own.
class RankTasksTest : public testing::Test {
 protected:
  void SetUp() override {
    base::ClearCancel();
    test::MadeDatabase(folder_ / "made.db").Run("PRAGMA journal_mode = DELETE");
    program_ = test::WriteFakeExtractor(folder_.path());
    for (int rank = 1; rank < 3; ++rank) {
      ranks_.emplace_back([this, rank] {
        FakeRank comm(network_, rank);
        const comm::Message message = WaitForMessage(comm);
        if (message.tag == kTagTasks) ServeTasks(comm, message.bytes);
      });
    }
  }
  void TearDown() override {
    for (std::thread& thread : ranks_) thread.join();
    base::ClearCancel();
  }
  prepare::poses::FeatureTask Part(int number) {
    const std::string name = std::to_string(number);
    return {.job = {.photo_root = folder_ / "images", .masks = {}, .folder = folder_ / ""},
            .program = program_,
            .arguments = {},
            .camera_model = "PINHOLE",
            .search = {},
            .few_features = 0,
            .search_again = {},
            .names = {"photo " + name + ".jpg", "photo " + name + "b.jpg"},
            .file = folder_ / ("part_" + name + ".db")};
  }

  TemporaryFolder folder_;
  std::filesystem::path program_;
  FakeNetwork network_{3};
  FakeRank root_{network_, 0};
  std::vector<std::thread> ranks_;
};

TEST_F(RankTasksTest, EveryTaskIsDoneOnce) {
  std::vector<prepare::poses::PoseTask> tasks;
  for (int i = 0; i < 5; ++i) tasks.emplace_back(Part(i));
  RankTasks ranks(root_, {.threads = 4}, folder_.path(), false, true);
  EXPECT_EQ(ranks.size(), 2);
  EXPECT_EQ(ranks.threads(), 2);  // of one machine's four
  double done = 0.0;
  ranks.Run(tasks, [&done](double more) { done += more; });
  EXPECT_DOUBLE_EQ(done, 10.0);
  const std::string calls = base::ReadFile(folder_ / "calls");
  EXPECT_EQ(std::count(calls.begin(), calls.end(), '\n'), 5);
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(std::filesystem::exists(folder_ / ("part_" + std::to_string(i) + ".db"))) << i;
  ranks.Run({}, [](double) {});
}

TEST_F(RankTasksTest, AFailureNamesTheRankAndItsLog) {
  base::WriteFileAtomically(folder_ / "fail", "photo 0.jpg");
  RankTasks ranks(root_, {.threads = 2}, folder_.path(), false, true);
  const std::vector<prepare::poses::PoseTask> tasks = {Part(0)};
  const std::string error = InputErrorOf([&] { ranks.Run(tasks, [](double) {}); });
  EXPECT_NE(error.find("rank 1 on "), std::string::npos) << error;
  EXPECT_NE(error.find("colmap_rank_1.log"), std::string::npos) << error;
  EXPECT_NE(error.find("cannot read photo 0.jpg"), std::string::npos) << error;
  // The ranks can go on.
  const std::vector<prepare::poses::PoseTask> others = {Part(1), Part(2)};
  ranks.Run(others, [](double) {});
  EXPECT_TRUE(std::filesystem::exists(folder_ / "part_2.db"));
}

TEST_F(RankTasksTest, RanksMakeTheMasksThatOneProcessMakes) {
  const std::filesystem::path folder = folder_ / "masked", survey = folder / "survey";
  survey::SaveSurvey(masks::MakeMaskSurvey(folder, 7, false), survey);
  const std::filesystem::path lake = folder / "lake.geojson";
  base::WriteFileAtomically(lake, R"({"type":"Polygon","coordinates":[[[40.1,-30],[60,-30],[60,30],[40.1,30],[40.1,-30]]]})");
  const masks::MaskOptions options{.segment = "", .segment_config = "", .ignore_ground = lake.string()};
  {
    MaskTasks ranks(root_, {.threads = 2}, folder_.path(), false, true);
    EXPECT_EQ(ranks.threads(), 1);
    masks::MakeMasks(survey, options, 1, &ranks);
  }
  const std::string shared = base::ReadFile(survey::MadeMasksFile(survey));
  std::filesystem::remove_all(survey::MadeMasksFolder(survey));
  masks::MakeMasks(survey, options, 1);
  EXPECT_EQ(base::ReadFile(survey::MadeMasksFile(survey)), shared);
}

TEST_F(RankTasksTest, AFailedMaskNamesTheRankAndTheRemedy) {
  const std::filesystem::path folder = folder_ / "masked", survey = folder / "survey";
  survey::SaveSurvey(masks::MakeMaskSurvey(folder, 3, false), survey);
  base::WriteFileAtomically(folder / "lake.geojson", R"({"type":"Polygon","coordinates":[[[0,-30],[60,-30],[60,30],[0,30],[0,-30]]]})");
  base::WriteFileAtomically(folder / "images/sub/1.png", "no picture");
  MaskTasks ranks(root_, {.threads = 2}, folder_.path(), false, true);
  const masks::MaskOptions options{.segment = "", .segment_config = "", .ignore_ground = (folder / "lake.geojson").string()};
  const std::string error = InputErrorOf([&] { masks::MakeMasks(survey, options, 1, &ranks); });
  EXPECT_NE(error.find("rank 1 on "), std::string::npos) << error;
  EXPECT_NE(error.find("1.png"), std::string::npos) << error;
  EXPECT_FALSE(std::filesystem::exists(survey::MadeMasksFile(survey)));
}

// Rank 0 ends the search and the program at once, while a task runs.
TEST(ServeTasksTest, TheEndOfTheProgramIsNotLost) {
  const TemporaryFolder folder;
  FakeNetwork network(2);
  FakeRank root(network, 0), comm(network, 1);
  int last_tag = 0;
  std::thread rank([&] {
    ServeTasks(comm, R"({"threads": 1, "verbose": false, "quiet": true})");
    last_tag = WaitForMessage(comm).tag;
  });
  MessageFrom(root, kTagReady);
  root.Send(1, kTagThreads, "1");
  test::MadeDatabase(folder / "made.db").Run("PRAGMA journal_mode = DELETE");
  base::WriteFileAtomically(folder / "slow", "");
  const prepare::poses::FeatureTask task{.job = {.photo_root = folder.path(), .masks = {}, .folder = folder.path()},
                                         .program = test::WriteFakeExtractor(folder.path()),
                                         .arguments = {},
                                         .camera_model = "PINHOLE",
                                         .search = {},
                                         .few_features = 0,
                                         .search_again = {},
                                         .names = {"photo.jpg"},
                                         .file = folder / "part.db"};
  root.Send(1, kTagTask, TaskMessage(0, prepare::poses::ToText(task)));
  MessageFrom(root, kTagTaskPart);
  root.Send(1, kTagDone, "");
  root.Send(1, kTagQuit, "");
  rank.join();
  EXPECT_EQ(last_tag, kTagQuit);
  EXPECT_FALSE(std::filesystem::exists(folder / "part.db"));
}

}  // namespace
}  // namespace skyquilt::coordinator
