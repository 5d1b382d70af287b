#include "odm/request.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <random>

#include "odm/option_table.h"
#include "tests/support/error_of.h"

namespace skyquilt::odm {
namespace {

std::vector<std::string> With(std::vector<std::string> words) {
  words.insert(words.begin(), {"--project-path", "/data"});
  return words;
}

std::string UsageErrorFor(const std::vector<std::string>& words) {
  return UsageErrorOf([&] { Request::Parse(With(words)); });
}

TEST(OdmOptions, EachHasAHelpAndADefaultThatIsAllowed) {
  for (const OptionSpec& option : Options()) {
    EXPECT_TRUE(option.name.starts_with("--")) << option.name;
    EXPECT_FALSE(option.help.empty()) << option.name;
    EXPECT_EQ(FindOption(option.name), &option) << "named twice";
    EXPECT_FALSE(!option.no_effect.empty() && !option.refused.empty()) << option.name;
    if (!option.default_value.empty()) EXPECT_EQ(ValueProblem(option, option.default_value), "") << option.name;
    EXPECT_EQ(option.choices.empty(), option.kind != OptionKind::kChoice) << option.name;
  }
  EXPECT_GT(Options().size(), 60U);
}

TEST(OdmOptions, RangesAreThoseOfTheirDomains) {
  const auto problem = [](const char* option, const char* value) { return ValueProblem(*FindOption(option), value); };
  EXPECT_EQ(problem("--orthophoto-resolution", "0"), "must be above 0, not 0");
  EXPECT_EQ(problem("--orthophoto-resolution", "0.1"), "");
  EXPECT_EQ(problem("--crop", "0"), "");
  EXPECT_EQ(problem("--crop", "-1"), "must be at least 0, not -1");
  EXPECT_EQ(problem("--mesh-octree-depth", "14"), "");
  EXPECT_EQ(problem("--mesh-octree-depth", "15"), "must be from 1 to 14, not 15");
  EXPECT_EQ(problem("--mesh-octree-depth", "0"), "must be from 1 to 14, not 0");
  EXPECT_EQ(problem("--split", "2.5"), "must be a whole number, not 2.5");
  EXPECT_EQ(problem("--split", "400.0"), "");
  EXPECT_EQ(problem("--crop", "much"), "must be a number, not 'much'");
  EXPECT_EQ(problem("--crop", "nan"), "must be a number, not 'nan'");
  EXPECT_NE(problem("--pc-quality", "best").find("ultra, high, medium, low, lowest"), std::string::npos);
}

TEST(OdmRequest, IsReadAsNodeOdmWritesIt) {
  const Request request = Request::Parse(
      {"--pc-quality", "low", "--dsm", "--boundary", "{a:b}", "--project-path", "/data/x", "--crop=1.5", "-e", "odm_dem", "0b1c-uuid"});
  EXPECT_EQ(request.Folder(), "/data/x/0b1c-uuid");
  EXPECT_EQ(request.name(), "0b1c-uuid");
  EXPECT_TRUE(request.Has("--dsm"));
  EXPECT_FALSE(request.Has("--dtm"));
  EXPECT_EQ(request.Text("--pc-quality"), "low");
  EXPECT_EQ(request.Text("--feature-quality"), "high") << "the default";
  EXPECT_EQ(request.Number("--crop"), 1.5);
  EXPECT_EQ(request.Number("--orthophoto-resolution"), 5.0);
  EXPECT_EQ(request.Text("--end-with"), "odm_dem");
  EXPECT_EQ(request.Text("--boundary"), "{a:b}");
  EXPECT_EQ(Request::Parse(With({})).name(), "code") << "OpenDroneMap's default";
  EXPECT_EQ(Request::Parse(With({"--crop", "1", "--crop", "2"})).Number("--crop"), 2.0) << "the last one counts";
  EXPECT_FALSE(Request::Parse(With({"--boundary", "", "a"})).Has("--boundary")) << "left empty on a page";
  EXPECT_EQ(Request::Parse(With({"--resize-to", "-1", "a"})).Number("--resize-to"), -1.0);
}

TEST(OdmRequest, SaysWhatIsWrong) {
  EXPECT_NE(UsageErrorFor({"--orthofoto-resolution", "3"}).find("Did you mean --orthophoto-resolution?"), std::string::npos);
  EXPECT_NE(UsageErrorFor({"--crop"}).find("--crop needs a value"), std::string::npos);
  EXPECT_NE(UsageErrorFor({"--dsm=true"}).find("--dsm takes no value"), std::string::npos);
  EXPECT_NE(UsageErrorFor({"a", "b"}).find("'b'"), std::string::npos);
  EXPECT_NE(UsageErrorFor({"--crop", "-3", "a"}).find("--crop must be at least 0"), std::string::npos);
  EXPECT_NE(UsageErrorFor({"--radiometric-calibration", "camera"}).find("several spectral bands"), std::string::npos);
  EXPECT_EQ(UsageErrorFor({"--radiometric-calibration", "none"}), "");
  EXPECT_NE(UsageErrorFor({"--skip-band-alignment"}).find("several spectral bands"), std::string::npos);
  for (const char* name : {"..", "a/b"}) EXPECT_NE(UsageErrorFor({name}).find("name of a folder"), std::string::npos) << name;
  EXPECT_NE(UsageErrorOf([] { Request::Parse({"a"}); }).find("--project-path is missing"), std::string::npos);
  EXPECT_TRUE(Request::Parse({"--what", "-h"}).help()) << "help is given whatever else is wrong";
}

TEST(OdmRequest, ALinePerOptionWithoutEffect) {
  const Request request = Request::Parse(With({"--split", "400", "--dsm", "--force-gps", "--matcher-type", "flann", "a"}));
  const std::vector<std::string> notes = request.Notes();
  ASSERT_EQ(notes.size(), 2U) << "not for defaults, nor for options that have an effect";
  for (const char* option : {"--split:", "--force-gps:"}) {
    EXPECT_TRUE(std::any_of(notes.begin(), notes.end(), [&](const std::string& note) { return note.starts_with(option); })) << option;
  }
}

RC_GTEST_PROP(OdmRequest, TheOrderOfOptionsDoesNotMatter, ()) {
  std::vector<std::vector<std::string>> parts = {{"--dsm"}, {"--crop", "2"}, {"--project-path", "/p"}, {"name"}, {"--pc-quality=high"}, {"--gltf"}};
  std::mt19937 random(*rc::gen::arbitrary<uint32_t>());
  std::shuffle(parts.begin(), parts.end(), random);
  std::vector<std::string> words;
  for (const std::vector<std::string>& part : parts) words.insert(words.end(), part.begin(), part.end());
  const Request request = Request::Parse(words);
  RC_ASSERT(request.Folder() == "/p/name");
  RC_ASSERT(request.Has("--dsm") && request.Has("--gltf") && request.Number("--crop") == 2.0 && request.Text("--pc-quality") == "high");
}

}  // namespace
}  // namespace skyquilt::odm
