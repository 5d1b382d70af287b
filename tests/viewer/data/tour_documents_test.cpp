// Saving a tour and the files of its models and pictures.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>

#include "core/base/json_text.h"
#include "tests/support/limited_file_size.h"
#include "tests/tour/format/sample_assets.h"
#include "tests/tour/format/sample_tour.h"
#include "tests/viewer/data/sample_project.h"
#include "viewer/data/tour_assets.h"

namespace skyquilt::viewer {
namespace {

using TourDocument = SampleProjectTest;
using TourAssets = SampleProjectTest;

namespace fs = std::filesystem;

fs::path AssetFolderOf(const SampleProject& sample) {
  return sample.project.folder / "tour" / "assets";
}

// Files in tour/assets, those that are half written included.
size_t FilesIn(const SampleProject& sample) {
  std::error_code error;
  return static_cast<size_t>(std::distance(fs::directory_iterator(AssetFolderOf(sample), error), fs::directory_iterator()));
}

std::string PathOf(const std::string& bytes, const std::string& extension) {
  return "tour/assets/" + tour::AssetNameOf(bytes, extension);
}

// A model of about so many bytes.
std::string LargeGlb(size_t bytes, char fill) {
  tour::SampleModel model;
  model.binary += std::string(bytes, fill);
  model.json["buffers"][0]["byteLength"] = model.binary.size();
  return model.Glb();
}

TEST_F(TourDocument, IsSavedWholeAndTextStaysText) {
  EXPECT_EQ(data_.Get("tour.json", "").status, 204);
  ASSERT_EQ(data_.Put("tour.json", base::JsonText(tour::SampleTour()), "").status, 204);
  const DataReply reply = data_.Get("tour.json", "v=1");
  EXPECT_EQ(reply.content_type, "application/json");
  EXPECT_FALSE(reply.cache);
  EXPECT_EQ(base::ParseJson(reply.body), tour::SampleTour());
  EXPECT_NE(reply.body.find("<script>alert(1)</script>"), std::string::npos);
}

TEST_F(TourDocument, RefusalsNameThePathAndLeaveTheOldFile) {
  ASSERT_EQ(data_.Put("tour.json", base::JsonText(tour::SampleTour()), "").status, 204);
  const std::string before = base::ReadFile(sample_.project.folder / "tour.json");
  const DataReply reply = data_.Put("tour.json", tour::SampleTourWith([](nlohmann::json& json) { json["stops"][1]["pose"]["fovy_deg"] = 500; }), "");
  EXPECT_EQ(reply.status, 400);
  EXPECT_EQ(reply.body, "tour.json is not saved: stops[1].pose.fovy_deg must be a number from 10 to 120");
  for (const std::string& wrong : {std::string("{"), std::string("[]"), std::string(), std::string(500'000, '[')}) {
    EXPECT_EQ(data_.Put("tour.json", wrong, "").status, 400);
  }
  EXPECT_EQ(base::ReadFile(sample_.project.folder / "tour.json"), before);
}

TEST_F(TourDocument, TheSecondEditorIsToldAndOverwritesNothing) {
  const std::string none = data_.Get("tour.json", "").etag;
  const DataReply first = data_.Put("tour.json", base::JsonText(tour::SampleTour()), none);
  ASSERT_EQ(first.status, 204);
  EXPECT_EQ(first.etag, data_.Get("tour.json", "").etag);
  const std::string other = tour::SampleTourWith([](nlohmann::json& json) { json["title"] = "mine"; });
  const DataReply second = data_.Put("tour.json", other, none);
  EXPECT_EQ(second.status, 412);
  EXPECT_NE(second.body.find("another window"), std::string::npos);
  EXPECT_EQ(data_.Get("tour.json", "").etag, first.etag);
  EXPECT_EQ(data_.Put("tour.json", other, first.etag).status, 204);
}

// A page that is left while it saves knows what it has sent, but not what the server has made of it.
TEST_F(TourDocument, WhatFollowsASaveWithoutAnAnswerNamesItsBody) {
  const std::string none = data_.Get("tour.json", "").etag;
  const auto with_title = [](const char* title) { return tour::SampleTourWith([&](nlohmann::json& json) { json["title"] = title; }); };
  const std::string first = with_title("first"), second = with_title("second"), third = with_title("third");
  const std::string known = none + " " + base::HashHex(first);
  ASSERT_EQ(data_.Put("tour.json", second, known).status, 204) << "the first save never came";
  EXPECT_EQ(data_.Put("tour.json", first, none).status, 412) << "the first save comes late";
  ASSERT_EQ(data_.Put("tour.json", first, data_.Get("tour.json", "").etag).status, 204);
  EXPECT_EQ(data_.Put("tour.json", second, known).status, 204) << "the first save came";
  EXPECT_EQ(data_.Put("tour.json", third, known).status, 412) << "what was sent first is in the file no longer";
  const std::string sent_second = none + " " + base::HashHex(second);
  base::WriteFileAtomically(sample_.project.folder / "tour.json", first);
  EXPECT_EQ(data_.Put("tour.json", third, sent_second).status, 412) << "somebody else has written the file since";
}

TEST_F(TourDocument, WhatCannotBeReadIsNoAbsence) {
  fs::create_directories(sample_.project.folder / "tour.json" / "inside");
  EXPECT_EQ(data_.Get("tour.json", "").status, 500);
  EXPECT_EQ(data_.Put("tour.json", base::JsonText(tour::SampleTour()), "").status, 500);
}

TEST_F(TourAssets, AreStoredUnderTheirDigestAndServed) {
  const std::tuple<std::string, const char*, const char*> files[] = {
      {tour::SampleGlb(), "glb", "model/gltf-binary"}, {tour::SamplePng(), "png", "image/png"}, {tour::SampleJpg(), "jpg", "image/jpeg"}};
  for (const auto& [bytes, extension, type] : files) {
    const std::string path = PathOf(bytes, extension);
    EXPECT_EQ(data_.Get(path, "").status, 404);
    for (int i = 0; i < 2; ++i) EXPECT_EQ(data_.Put(path, bytes, "").status, 204) << "again changes nothing";
    const DataReply reply = data_.Get(path, "");
    ASSERT_EQ(reply.status, 200);
    EXPECT_EQ(reply.content_type, type);
    EXPECT_TRUE(reply.cache) << "its name stands for its content";
    EXPECT_EQ(base::ReadFile(reply.file), bytes);
    EXPECT_EQ(reply.file, sample_.project.folder / path);
  }
  EXPECT_EQ(FilesIn(sample_), 3U);
}

TEST_F(TourAssets, HostileUploadsAreRefusedAndLeaveNothing) {
  const std::string glb = tour::SampleGlb(), png = tour::SamplePng(), page = "<html><script>alert(1)</script></html>";
  const auto refused = [&](const std::string& bytes, const std::string& extension) {
    const DataReply reply = data_.Put(PathOf(bytes, extension), bytes, "");
    EXPECT_TRUE(reply.status != 415 || reply.body.starts_with("the file is not saved: ")) << reply.body;
    return reply.status == 415;
  };
  EXPECT_TRUE(refused(glb, "png")) << "another type";
  EXPECT_TRUE(refused(png, "jpg"));
  EXPECT_TRUE(refused(png, "glb"));
  EXPECT_TRUE(refused(page, "png")) << "a page";
  EXPECT_TRUE(refused("", "glb"));
  EXPECT_TRUE(refused(glb.substr(0, glb.size() / 2), "glb")) << "cut off";
  EXPECT_TRUE(refused(png + page, "png")) << "two things at once";
  EXPECT_TRUE(refused(glb + page, "glb"));
  EXPECT_TRUE(refused(tour::SampleGlb([](nlohmann::json& json) { json["buffers"][0]["uri"] = "http://example.org/x"; }), "glb"))
      << "reads from elsewhere";
  EXPECT_EQ(data_.Put(PathOf(glb, "glb"), png, "").status, 415) << "another digest";
  EXPECT_EQ(data_.Put(PathOf(glb, "glb"), glb + " ", "").status, 415) << "changed on its way";
  EXPECT_FALSE(fs::exists(sample_.project.folder / "tour"));
}

TEST_F(TourAssets, NamesLeadNowhereElse) {
  const std::string png = tour::SamplePng(), name = tour::AssetNameOf(png, "png");
  for (const std::string& path :
       {std::string("tour/assets/"), "tour/assets/x/" + name, "tour/assets/" + name + "/", "tour/assets/." + name, "tour/assets/" + name + ".html",
        std::string("tour/assets/photo.png"), "tour/assets/" + std::string(64, 'A') + ".png"}) {
    EXPECT_EQ(data_.Put(path, png, "").status, 400) << path;
    EXPECT_EQ(data_.Get(path, "").status, 404) << path;
  }
  for (const std::string& path : {"tour/" + name, name, std::string("tour"), "before/tour/assets/" + name, "./tour/assets/" + name}) {
    EXPECT_EQ(data_.Put(path, png, "").status, 405) << path;
    EXPECT_EQ(data_.Get(path, "").status, 404) << path;
  }
  fs::create_directories(AssetFolderOf(sample_));
  base::WriteFileAtomically(sample_.folder / "secret", "secret");
  fs::create_symlink(sample_.folder / "secret", AssetFolderOf(sample_) / name);
  EXPECT_EQ(data_.Get("tour/assets/" + name, "").status, 404) << "links are not followed";
  fs::create_directories(AssetFolderOf(sample_) / (std::string(64, 'c') + ".png"));
  EXPECT_EQ(data_.Get("tour/assets/" + std::string(64, 'c') + ".png", "").status, 404);
  EXPECT_EQ(data_.Put("tour/assets/" + name, png, "").status, 204) << "the link is replaced";
  EXPECT_EQ(base::ReadFile(sample_.folder / "secret"), "secret");
  EXPECT_EQ(base::ReadFile(AssetFolderOf(sample_) / name), png);
}

TEST_F(TourAssets, DamagedFilesAreStoredAgain) {
  const std::string png = tour::SamplePng(), path = PathOf(png, "png");
  ASSERT_EQ(data_.Put(path, png, "").status, 204);
  std::string damaged = png;
  damaged[20] = 'x';
  base::WriteFileAtomically(sample_.project.folder / path, damaged);
  EXPECT_EQ(data_.Put(path, png, "").status, 204);
  EXPECT_EQ(base::ReadFile(sample_.project.folder / path), png);
}

TEST_F(TourAssets, FolderIsLimitedAndTidied) {
  const fs::path& project = sample_.project.folder;
  const std::string first = LargeGlb(700'000, 'a'), second = LargeGlb(700'000, 'b');
  constexpr uint64_t kLimit = 1U << 20U;
  EXPECT_EQ(PutAsset(project, PathOf(first, "glb"), first, kLimit).status, 204);
  const DataReply full = PutAsset(project, PathOf(second, "glb"), second, kLimit);
  EXPECT_EQ(full.status, 413);
  EXPECT_NE(full.body.find("tour/assets"), std::string::npos);
  EXPECT_EQ(PutAsset(project, PathOf(first, "glb"), first, kLimit).status, 204) << "it is there already";
  // A half file that a killed viewer left long ago makes room; one that is being written does not.
  fs::remove(project / PathOf(first, "glb"));
  const fs::path half = AssetFolderOf(sample_) / ".x.glb.tmp.7.0";
  base::WriteFileAtomically(half, first);
  EXPECT_EQ(PutAsset(project, PathOf(second, "glb"), second, kLimit).status, 413);
  fs::last_write_time(half, fs::file_time_type::clock::now() - std::chrono::hours(2));
  EXPECT_EQ(PutAsset(project, PathOf(second, "glb"), second, kLimit).status, 204);
  EXPECT_FALSE(fs::exists(half));
}

TEST_F(TourAssets, AFullDiskLeavesNothingHalf) {
  const std::string small = tour::SamplePng(), large = LargeGlb(300'000, 'a');
  ASSERT_EQ(data_.Put("tour.json", base::JsonText(tour::SampleTour()), "").status, 204);
  const std::string tour_before = base::ReadFile(sample_.project.folder / "tour.json");
  ASSERT_EQ(data_.Put(PathOf(small, "png"), small, "").status, 204);
  auto limit = std::make_optional<LimitedFileSize>(rlim_t{1000});
  const DataReply asset = data_.Put(PathOf(large, "glb"), large, "");
  const DataReply document = data_.Put("tour.json", tour::SampleTourWith([](nlohmann::json& json) { json["title"] = "new"; }), "");
  limit.reset();
  EXPECT_EQ(asset.status, 507) << asset.body;
  EXPECT_NE(asset.body.find("Free some space"), std::string::npos);
  EXPECT_EQ(document.status, 507) << document.body;
  EXPECT_EQ(FilesIn(sample_), 1U);
  EXPECT_EQ(base::ReadFile(sample_.project.folder / "tour.json"), tour_before);
  EXPECT_EQ(data_.Put(PathOf(large, "glb"), large, "").status, 204) << "once there is space";
}

TEST_F(TourAssets, AreWholeOrAbsentWhenTheProcessIsKilled) {
  const std::string large = LargeGlb(4'000'000, 'a'), path = PathOf(large, "glb");
  for (int attempt = 0; attempt < 8; ++attempt) {
    const pid_t child = fork();
    if (child == 0) {
      for (;;) {
        PutAsset(sample_.project.folder, path, large);
        fs::remove(sample_.project.folder / path);
      }
    }
    usleep(static_cast<useconds_t>(20'000 + 17'000 * attempt));
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    const DataReply reply = GetAsset(sample_.project.folder, path);
    EXPECT_TRUE(reply.status == 404 || (reply.status == 200 && base::ReadFile(reply.file) == large));
  }
  EXPECT_EQ(PutAsset(sample_.project.folder, path, large).status, 204);
}

}  // namespace
}  // namespace skyquilt::viewer
