#include "prepare/poses/extract_features.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <iterator>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/survey/colmap_database.h"
#include "prepare/poses/match_pairs.h"
#include "tests/prepare/poses/fake_extractor.h"
#include "tests/prepare/poses/made_photos.h"
#include "tests/support/error_of.h"
#include "tests/support/made_database.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::prepare::poses {
namespace {

TEST(PhotosPerPartTest, EveryProcessGetsSomeAndEveryThreadToo) {
  EXPECT_EQ(PhotosPerPart(1000, 0, 2), 64U);
  EXPECT_EQ(PhotosPerPart(18, 2, 1), 5U);
  EXPECT_EQ(PhotosPerPart(3, 2, 1), 4U);
  EXPECT_EQ(PhotosPerPart(100000, 4, 16), 512U);
  EXPECT_EQ(PhotosPerPart(100, 50, 16), 64U);
  EXPECT_EQ(PhotosPerPart(0, 3, 0), 4U);
}

TEST(PoseTaskText, IsReadBack) {
  const FeatureTask features{.job = {.photo_root = "/photos", .masks = "/masks", .folder = "/project"},
                             .program = "/bin/colmap",
                             .arguments = {"--a", "1"},
                             .camera_model = "OPENCV",
                             .search = {"--fast"},
                             .few_features = 70,
                             .search_again = {"--slow", "2"},
                             .names = {"with space.jpg", "latin1 \xe4.jpg"},
                             .file = "/project/part.db"};
  const auto again = std::get<FeatureTask>(TaskFromText(ToText(features)));
  EXPECT_EQ(again.names, features.names);
  EXPECT_EQ(again.arguments, features.arguments);
  EXPECT_EQ(again.camera_model, "OPENCV");
  EXPECT_EQ(again.few_features, 70U);
  EXPECT_EQ(again.search, features.search);
  EXPECT_EQ(again.search_again, features.search_again);
  EXPECT_EQ(again.job.photo_root, "/photos");
  EXPECT_EQ(again.job.masks, "/masks");
  EXPECT_EQ(again.job.folder, "/project");
  EXPECT_EQ(again.program, "/bin/colmap");
  EXPECT_EQ(again.file, features.file);
  const MatchTask match{.database = "/project/database.db",
                        .pairs = {{1, 2}, {1, 9}},
                        .rules = {.max_ratio = 0.75, .max_distance = 0.6, .mutual = false},
                        .min_matches = 15,
                        .file = "/project/chunk.bin",
                        .key = "0123"};
  const auto matched = std::get<MatchTask>(TaskFromText(ToText(match)));
  EXPECT_EQ(matched.database, match.database);
  EXPECT_EQ(matched.pairs, match.pairs);
  EXPECT_EQ(matched.rules.max_ratio, 0.75);
  EXPECT_EQ(matched.rules.max_distance, 0.6);
  EXPECT_FALSE(matched.rules.mutual);
  EXPECT_EQ(matched.min_matches, 15U);
  EXPECT_EQ(matched.file, match.file);
  EXPECT_EQ(matched.key, match.key);
}

// Processes that work one after another in this one, the last task first.
class PlayedRanks : public RemoteTasks {
 public:
  int size() override { return 3; }
  int threads() override { return 1; }
  void Run(std::span<const PoseTask> tasks, const TaskProgress& on_progress) override {
    for (size_t i = tasks.size(); i-- > 0;) runners_[i % 3].Run(TaskFromText(ToText(tasks[i])), on_progress);
  }

 private:
  std::array<TaskRunner, 3> runners_{TaskRunner(1, "colmap_rank_1.log"), TaskRunner(1, "colmap_rank_2.log"), TaskRunner(1, "colmap_rank_3.log")};
};

class ExtractFeaturesTest : public testing::Test {
 protected:
  void SetUp() override {
    photos_ = test::GridPhotos(4, 5, 20.0, 25.0, {47.0, 8.0, 400.0});
    for (size_t i = 0; i < photos_.size(); i += 3) photos_[i].tags.model = "another camera";
    test::MadeDatabase(folder_ / "made.db").Run("PRAGMA journal_mode = DELETE");  // one file, to copy
    settings_.program = test::WriteFakeExtractor(folder_.path());
  }
  ColmapJob JobIn(const std::string& name) {
    std::filesystem::create_directories(folder_ / name);
    return {.photo_root = folder_ / "images", .masks = {}, .folder = folder_ / name};
  }
  void Extract(const ColmapJob& job, RemoteTasks* ranks) { ExtractFeatures(job, settings_, photos_, {}, "input", ranks); }
  size_t CountCalls() {
    const std::string calls = base::ReadFile(folder_ / "calls");
    std::filesystem::remove(folder_ / "calls");
    return static_cast<size_t>(std::count(calls.begin(), calls.end(), '\n'));
  }
  void ExpectSame(const ColmapJob& a, const ColmapJob& b) {
    const survey::ColmapDatabase one(a.Database()), other(b.Database());
    const auto images = one.ReadImages(), others = other.ReadImages();
    ASSERT_EQ(images.size(), photos_.size());
    ASSERT_EQ(others.size(), photos_.size());
    for (size_t i = 0; i < images.size(); ++i) {
      EXPECT_EQ(images[i].id, others[i].id);
      EXPECT_EQ(images[i].name, others[i].name);
      EXPECT_EQ(images[i].camera_id, others[i].camera_id);
      EXPECT_EQ(one.ReadDescriptors(images[i].id), other.ReadDescriptors(images[i].id)) << images[i].name;
    }
  }

  TemporaryFolder folder_;
  std::vector<input::PhotoFile> photos_;
  ColmapSettings settings_;
  PlayedRanks ranks_;
};

TEST_F(ExtractFeaturesTest, RanksMakeTheSameDatabase) {
  const ColmapJob alone = JobIn("alone"), shared = JobIn("shared");
  Extract(alone, nullptr);
  EXPECT_EQ(CountCalls(), 2U);  // one for each camera
  Extract(shared, &ranks_);
  EXPECT_EQ(CountCalls(), 6U);  // 13 and 7 photos in parts of at most 4
  ExpectSame(alone, shared);
  const auto images = survey::ColmapDatabase(alone.Database()).ReadImages();
  EXPECT_EQ(std::count_if(images.begin(), images.end(), [](const auto& image) { return image.camera_id == 1; }), 7);
  EXPECT_TRUE(std::filesystem::exists(shared.folder / "colmap_rank_1.log"));
  EXPECT_FALSE(std::filesystem::exists(shared.folder / "colmap.log"));
  RemoveFeatureParts(shared);
  EXPECT_FALSE(std::filesystem::exists(shared.folder / "features"));
}

TEST_F(ExtractFeaturesTest, FinishedPartsAreUsedAfterAFailure) {
  const ColmapJob job = JobIn("job");
  base::WriteFileAtomically(folder_ / "fail", photos_[0].name);  // in the first part, which is made last
  const std::string error = InputErrorOf([&] { Extract(job, &ranks_); });
  EXPECT_NE(error.find("cannot read " + photos_[0].name), std::string::npos) << error;
  EXPECT_NE(error.find("colmap_rank_1.log"), std::string::npos) << error;
  EXPECT_FALSE(std::filesystem::exists(job.Database()));
  EXPECT_EQ(CountCalls(), 6U);
  std::filesystem::remove(folder_ / "fail");
  Extract(job, &ranks_);
  EXPECT_EQ(CountCalls(), 1U);
  EXPECT_EQ(survey::ColmapDatabase(job.Database()).ReadImages().size(), photos_.size());
  // Other options: nothing is used, not even the part that is made first.
  base::WriteFileAtomically(folder_ / "fail", photos_[19].name);
  EXPECT_THROW(ExtractFeatures(job, settings_, photos_, {}, "other input", &ranks_), base::InputError);
  EXPECT_EQ(CountCalls(), 1U);
}

TEST_F(ExtractFeaturesTest, RanksFindTheSameMatches) {
  const ColmapJob alone = JobIn("alone"), shared = JobIn("shared");
  Extract(alone, nullptr);
  std::filesystem::copy_file(alone.Database(), shared.Database());
  std::vector<std::string> names;
  for (const input::PhotoFile& photo : photos_) names.push_back(photo.name);
  const PhotoPairs pairs = AllPairs(photos_.size());
  base::ThreadPool threads(2);
  FeatureStore store(alone.Database(), names, kFeatureMemory_bytes), shared_store(shared.Database(), names, kFeatureMemory_bytes);
  MatchPairs({.folder = alone.folder / "matches", .input = "input"}, store, pairs, threads);
  const MatchJob job{.folder = shared.folder / "matches", .input = "input"};
  MatchPairs(job, shared_store, pairs, threads, &ranks_);
  EXPECT_EQ(shared_store.n_loads(), 0U);
  const std::vector<survey::ImagePair> matched = store.database().ReadMatchedPairs(15);
  EXPECT_EQ(matched.size(), pairs.size());
  EXPECT_EQ(shared_store.database().ReadMatchedPairs(15), matched);
  for (const auto& [a, b] : matched) EXPECT_EQ(shared_store.database().ReadMatches(a, b), store.database().ReadMatches(a, b));
  // 190 pairs for three processes.
  const auto chunks = std::distance(std::filesystem::directory_iterator(job.folder), std::filesystem::directory_iterator());
  EXPECT_EQ(chunks, 12);
}

}  // namespace
}  // namespace skyquilt::prepare::poses
