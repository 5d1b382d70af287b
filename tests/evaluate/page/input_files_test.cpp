#include "evaluate/page/input_files.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "core/base/file.h"
#include "evaluate/page/sections.h"
#include "tests/evaluate/page/count_of.h"
#include "tests/evaluate/page/sample_report.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::evaluate::page {
namespace {

// As prepare writes it.
constexpr const char* kHeading = "file,taken,kind,reason,shot,mask,width,height\n";

std::string SectionOfRows(const std::string& rows) {
  ReportInput input;
  input.files = ParseInputFiles(kHeading + rows);
  return InputSection(input);
}

TEST(InputFiles, AreGroupedByKindAndReason) {
  const InputFiles files = ParseInputFiles(std::string(kHeading) +
                                           "._a.jpg,no,hidden or system,hidden file,,,,\n"
                                           "._b.jpg,no,hidden or system,hidden file,,,,\n"
                                           "a.jpg,yes,photo,,a,,4000,3000\n"
                                           "a_T.jpg,no,thermal,picture of heat,a,,640,512\n"
                                           "b.jpg,yes,photo,\"single band: band NIR is taken for all, as there are no photos in colour\",b,,16,8\n"
                                           "odm/,no,other project,\"OpenDroneMap, with 12 pictures\",,,,\n"
                                           "t_a.jpg,no,thumbnail,small,,,,\nt_b.jpg,no,thumbnail,small,,,,\nt_c.jpg,no,thumbnail,small,,,,\n"
                                           "t_d.jpg,no,thumbnail,small,,,,\nt_e.jpg,no,thumbnail,in a folder of thumbnails,,,,\n");
  EXPECT_EQ(files.n_taken, 2);
  EXPECT_EQ(files.n_left_out, 9);
  ASSERT_EQ(files.groups.size(), 6U);
  EXPECT_EQ(files.groups[0].reason, "small");
  EXPECT_EQ(files.groups[0].n, 4);
  EXPECT_EQ(files.groups[0].examples, (std::vector<std::string>{"t_a.jpg", "t_b.jpg", "t_c.jpg"}));
  EXPECT_EQ(files.groups[1].kind, "thermal");
  EXPECT_TRUE(files.groups[2].taken);
  EXPECT_EQ(files.groups[2].reason, "single band: band NIR is taken for all, as there are no photos in colour");
  EXPECT_EQ(files.groups[3].reason, "OpenDroneMap, with 12 pictures");
  EXPECT_EQ(files.groups[5].kind, "hidden or system") << "what is no picture comes last, however many there are";
  EXPECT_TRUE(files.Remarkable());
}

TEST(InputFiles, ReasonsThatNameTheirFileAreOneGroup) {
  std::string rows;
  for (int i = 0; i < 2000; ++i) {
    const std::string name = std::to_string(i);
    rows += name + ".dng,no,other form,\"another form of " + name + ".jpg, which is taken\",,,,\n" + name + ".jpg,yes,photo,,,,,\n";
  }
  const InputFiles files = ParseInputFiles(kHeading + rows);
  EXPECT_EQ(files.n_taken, 2000);
  ASSERT_EQ(files.groups.size(), 1U);
  EXPECT_TRUE(files.groups[0].several);
  EXPECT_EQ(files.groups[0].n, 2000);
  EXPECT_EQ(files.groups[0].examples, (std::vector<std::string>{"0.dng", "1.dng", "2.dng"}));
  const std::string html = SectionOfRows(rows);
  EXPECT_EQ(CountOf(html, "<tr>"), 2U);
  EXPECT_NE(html.find("such as: another form of 0.jpg, which is taken"), std::string::npos);
}

TEST(InputFiles, ASectionIsOnlyThereForWhatIsRemarkable) {
  EXPECT_EQ(SectionOfRows(""), "");
  EXPECT_EQ(SectionOfRows("a.jpg,yes,photo,,a,,16,8\nb.jpg,yes,photo,,b,masks/b.png,16,8\n"), "");
  EXPECT_EQ(SectionOfRows("a.jpg,yes,photo,,,,,\ngeo.txt,no,other file,not a picture,,,,\n@eaDir/,no,hidden or system,thumbnails,,,,\n"), "");
  const std::string html =
      SectionOfRows("a.jpg,yes,photo,,,,,\na.heic,no,unread format,cannot be read (HEIC),,,,\ngeo.txt,no,other file,not a picture,,,,\n");
  EXPECT_NE(html.find("1 photo was taken, 2 other files and folders were left out."), std::string::npos) << html;
  EXPECT_EQ(CountOf(html, "<tr>"), 3U);
  EXPECT_LT(html.find("a.heic"), html.find("geo.txt"));
  const std::string band = SectionOfRows("a.tif,yes,photo,single band: band Green is taken for all,,,,\n");
  EXPECT_NE(band.find("and nothing was left out."), std::string::npos) << band;
}

TEST(InputFiles, OddNamesAreReadAndShownAsTheyAre) {
  const std::string rows =
      "\"x, \"\"y\"\".jpg\",no,thumbnail,small,,,,\n"
      "\"two\nlines.jpg\",no,thumbnail,small,,,,\n"
      "<script>alert(1)</script>.jpg,no,thumbnail,small,,,,\n"
      "\"a & b's, \"\"<b>\"\"\",no,map,\"<i>\"\"x\"\"</i>, y\",,,,\n";
  const InputFiles files = ParseInputFiles(kHeading + rows);
  ASSERT_EQ(files.groups.size(), 2U);
  EXPECT_EQ(files.groups[0].examples, (std::vector<std::string>{"x, \"y\".jpg", "two\nlines.jpg", "<script>alert(1)</script>.jpg"}));
  EXPECT_EQ(files.groups[1].reason, "<i>\"x\"</i>, y");
  const std::string html = SectionOfRows(rows);
  EXPECT_EQ(html.find("<script"), std::string::npos);
  EXPECT_EQ(html.find("<b>"), std::string::npos);
  EXPECT_EQ(html.find("<i>"), std::string::npos);
  EXPECT_NE(html.find("&lt;script&gt;alert(1)&lt;/script&gt;.jpg"), std::string::npos) << html;
  EXPECT_NE(html.find("a &amp; b"), std::string::npos) << html;
}

TEST(InputFiles, OtherTablesAreNoError) {
  for (const char* csv : {"", "\n", "name,used\na.jpg,yes\n", "file,taken,kind\na_T.jpg,no,thermal\n", "\"file"}) {
    const InputFiles files = ParseInputFiles(csv);
    EXPECT_TRUE(files.groups.empty()) << csv;
    EXPECT_EQ(files.n_taken + files.n_left_out, 0) << csv;
  }
  // A later version may have more columns, in another order; a damaged line does no harm.
  const InputFiles later = ParseInputFiles("kind,file,taken,note,reason\r\nthermal,a_T.jpg,no,,heat\r\nbroken\nphoto,\"a.jpg");
  EXPECT_EQ(later.n_left_out, 1);
  ASSERT_EQ(later.groups.size(), 1U);
  EXPECT_EQ(later.groups[0].kind, "thermal");
}

TEST(InputFiles, AMissingFileIsNoError) {
  const TemporaryFolder folder;
  EXPECT_FALSE(ReadInputFiles(folder / "input.csv").Remarkable());
  base::WriteFileAtomically(folder / "input.csv", std::string(kHeading) + "a_T.jpg,no,thermal,heat,,,,\n");
  EXPECT_EQ(ReadInputFiles(folder / "input.csv").n_left_out, 1);
}

TEST(InputFiles, ThePageHasTheSectionAndAWayToIt) {
  const TemporaryFolder folder;
  SampleReport sample(folder / "report");
  EXPECT_EQ(BuildReportPage(sample.input).find("href=\"#input\""), std::string::npos);
  sample.input.files = ParseInputFiles(std::string(kHeading) + "a_T.jpg,no,thermal,heat,,,,\n");
  const std::string html = BuildReportPage(sample.input);
  EXPECT_NE(html.find("href=\"#input\""), std::string::npos);
  EXPECT_EQ(CountOf(html, "<section id=\"input\">"), 1U);
}

}  // namespace
}  // namespace skyquilt::evaluate::page
