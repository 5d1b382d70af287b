#include "tour/export/staged_folder.h"

#include <gtest/gtest.h>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"
#include "tour/export/disk_space.h"
#include "tour/export/embed_page.h"
#include "tour/export/script_data.h"

namespace skyquilt::tour {
namespace {

namespace fs = std::filesystem;

class Staged : public testing::Test {
 protected:
  void Fill(const StagedFolder& staged, const std::string& content) {
    for (const char* name : {"index.html", "tour.js", "poster.jpg"}) base::WriteFileAtomically(staged.partial() / name, content);
    WriteScript(staged.partial() / "data", "manifest.json", content);
    WriteScript(staged.partial() / "data", content + ".txt", content);
  }
  void Publish(const std::string& content) {
    StagedFolder staged(out_, {});
    Fill(staged, content);
    staged.Publish();
  }

  TemporaryFolder folder_;
  fs::path out_ = folder_ / "out";
};

TEST_F(Staged, ANewExportReplacesTheOldOneAndNothingElse) {
  Publish("old");
  base::WriteFileAtomically(out_ / "robots.txt", "mine");
  base::WriteFileAtomically(out_ / "tour.mp4", "of the old one");
  Publish("new");
  EXPECT_EQ(base::ReadFile(out_ / "index.html"), "new");
  EXPECT_EQ(base::ReadFile(out_ / "robots.txt"), "mine");
  EXPECT_TRUE(fs::exists(out_ / "data" / "new.txt.js"));
  EXPECT_FALSE(fs::exists(out_ / "data" / "old.txt.js"));
  EXPECT_FALSE(fs::exists(out_ / "tour.mp4"));
  EXPECT_FALSE(fs::exists(folder_ / "out.partial"));
}

TEST_F(Staged, WhatIsNotPublishedChangesNothing) {
  Publish("old");
  {
    const StagedFolder staged(out_, {});
    Fill(staged, "new");
    EXPECT_TRUE(fs::exists(folder_ / "out.partial" / "index.html"));
  }
  EXPECT_EQ(base::ReadFile(out_ / "index.html"), "old");
  EXPECT_TRUE(fs::exists(out_ / "data" / "old.txt.js"));
  EXPECT_FALSE(fs::exists(folder_ / "out.partial"));
  // As a killed export leaves it.
  base::WriteFileAtomically((fs::create_directories(folder_ / "out.partial"), folder_ / "out.partial" / "half"), "x");
  Publish("new");
  EXPECT_FALSE(fs::exists(out_ / "half"));
}

TEST_F(Staged, AFolderWithSomethingElseIsLeftAlone) {
  fs::create_directories(out_);
  EXPECT_NO_THROW(StagedFolder(out_, {})) << "an empty one may be filled";
  fs::create_directories(out_ / "data");
  base::WriteFileAtomically(out_ / "index.html", "a page of mine");
  EXPECT_THROW(StagedFolder(out_, {}), base::InputError);
  EXPECT_EQ(base::ReadFile(out_ / "index.html"), "a page of mine");
  fs::remove(out_ / "index.html");
  EXPECT_THROW(StagedFolder(out_, {}), base::InputError) << "data of something else";
  EXPECT_NO_THROW(StagedFolder(out_, {"data"}));
  base::WriteFileAtomically(folder_ / "file", "x");
  EXPECT_THROW(StagedFolder(folder_ / "file", {}), base::InputError);
}

// All states in which a kill can leave the folder while the files are moved.
TEST_F(Staged, AnInterruptedMoveIsTakenUpAgain) {
  Publish("old");
  fs::remove(out_ / "index.html");
  EXPECT_NO_THROW(StagedFolder(out_, {}));
  fs::remove(out_ / "tour.js");
  fs::remove(out_ / "poster.jpg");
  EXPECT_NO_THROW(StagedFolder(out_, {}));
  fs::remove_all(out_ / "data");
  EXPECT_NO_THROW(StagedFolder(out_, {}));
  Publish("new");
  EXPECT_EQ(base::ReadFile(out_ / "index.html"), "new");
}

TEST(FreeSpace, TooLittleIsSaidBeforeWorkBegins) {
  const TemporaryFolder folder;
  EXPECT_NO_THROW(RequireFreeSpace(folder / "not" / "yet", 1000, "the tour"));
  const std::string error = InputErrorOf([&] { RequireFreeSpace(folder / "not" / "yet", int64_t{1} << 60, "the tour"); });
  EXPECT_NE(error.find("the tour needs 1152921504606.8 MB"), std::string::npos) << error;
}

TEST(EmbedPage, TitlesStayText) {
  const std::string page = EmbedPage("</pre><script>alert(1)</script>\" onload=\"alert(1)");
  EXPECT_EQ(page.find("<script"), std::string::npos);
  EXPECT_EQ(page.find("\" onload=\""), std::string::npos);
  // As it works, and as text to copy.
  EXPECT_NE(page.find("<iframe src=\"index.html\""), std::string::npos);
  EXPECT_NE(page.find("&lt;iframe src=&quot;https://"), std::string::npos);
}

}  // namespace
}  // namespace skyquilt::tour
