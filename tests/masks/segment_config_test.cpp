#include "masks/segment_config.h"

#include <gtest/gtest.h>

#include "core/base/file.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::masks {
namespace {

constexpr const char* kToml = R"(# what people write
input_width = 64
input_height = 48
photo_width = 128
overlap = 8
scale = 0.25
mean = [1, 2.5, 3]
std = [1, 2, 4]
channels = "bgr"
classes = ["ground", "car", "person"]
ignore = ["person", "car"]
threshold = 0.25
dilate_px = 3
)";
constexpr const char* kJson = R"({"input_width": 64, "input_height": 48, "photo_width": 128, "overlap": 8, "scale": 0.25, "mean": [1, 2.5, 3],
  "std": [1, 2, 4], "channels": "bgr", "classes": ["ground", "car", "person"], "ignore": ["person", "car"], "threshold": 0.25,
  "dilate_px": 3})";

class SegmentConfigTest : public testing::Test {
 protected:
  SegmentConfig Read(const std::string& text, const std::string& name = "net.toml") const {
    base::WriteFileAtomically(folder_ / name, text);
    return ReadSegmentConfig(folder_ / name);
  }
  // The example with one line changed.
  std::string ErrorWith(const std::string& key, const std::string& line) const {
    std::string text = kToml;
    const size_t at = text.find("\n" + key + " ") + 1;
    text.replace(at, text.find('\n', at) - at, line);
    return InputErrorOf([&] { Read(text); });
  }
  TemporaryFolder folder_;
};

TEST_F(SegmentConfigTest, TomlAndJsonSayTheSame) {
  for (const SegmentConfig& config : {Read(kToml), Read(kJson, "net.json")}) {
    EXPECT_EQ(config.input_width, 64);
    EXPECT_EQ(config.input_height, 48);
    EXPECT_EQ(config.photo_width, 128);
    EXPECT_EQ(config.overlap, 8);
    EXPECT_EQ(config.scale, 0.25);
    EXPECT_EQ(config.mean, (std::array<double, 3>{1, 2.5, 3}));
    EXPECT_EQ(config.std, (std::array<double, 3>{1, 2, 4}));
    EXPECT_TRUE(config.bgr);
    EXPECT_EQ(config.classes, (std::vector<std::string>{"ground", "car", "person"}));
    EXPECT_EQ(config.IgnoredClasses(), (std::vector<std::string>{"car", "person"}));
    EXPECT_EQ(config.threshold, 0.25);
    EXPECT_EQ(config.dilate_px, 3);
  }
}

TEST_F(SegmentConfigTest, MostKeysHaveDefaults) {
  const SegmentConfig config = Read("input_width = 64\ninput_height = 32\nclasses = [\"person\"]\nignore = [\"person\"]\n");
  EXPECT_EQ(config.photo_width, 64);
  EXPECT_EQ(config.overlap, 0);
  EXPECT_DOUBLE_EQ(config.scale, 1.0 / 255.0);
  EXPECT_EQ(config.mean, (std::array<double, 3>{0, 0, 0}));
  EXPECT_EQ(config.std, (std::array<double, 3>{1, 1, 1}));
  EXPECT_FALSE(config.bgr);
  EXPECT_EQ(config.threshold, 0.5);
  EXPECT_EQ(config.dilate_px, 0);
}

TEST_F(SegmentConfigTest, ErrorsNameFileKeyAndRemedy) {
  const std::vector<std::array<std::string, 3>> cases = {
      {"input_width", "", "input_width"},
      {"input_width", "input_width = 0", "input_width"},
      {"input_width", "input_width = 64.5", "input_width"},
      {"input_height", "input_height = \"48\"", "input_height"},
      {"overlap", "overlap = 25", "overlap"},  // more than half of the height
      {"mean", "mean = [1, 2]", "mean"},
      {"mean", "mean = [1, 2, nan]", "mean"},
      {"std", "std = [1, 0, 1]", "std"},
      {"channels", "channels = \"rbg\"", "channels"},
      {"classes", "classes = []", "classes"},
      {"ignore", "ignore = []", "ignore"},
      {"ignore", "ignore = [\"dog\"]", "'dog'"},
      {"dilate_px", "dilate_pix = 3", "did you mean 'dilate_px'?"},
      {"scale", "scale = -1", "scale"},
      {"scale", "scale = ", "line 6"},
  };
  for (const auto& [key, line, found] : cases) {
    const std::string error = ErrorWith(key, line);
    EXPECT_NE(error.find("net.toml"), std::string::npos) << line << ": " << error;
    EXPECT_NE(error.find(found), std::string::npos) << line << ": " << error;
  }
  EXPECT_NE(ErrorWith("ignore", "ignore = [\"dog\"]").find("docs/input.md"), std::string::npos);
}

TEST_F(SegmentConfigTest, ErrorsInJsonNameTheLine) {
  std::string text = kJson;
  text.replace(text.find("[1, 2, 4]"), 9, "[1, 2]");
  const std::string error = InputErrorOf([&] { Read(text, "net.json"); });
  EXPECT_NE(error.find("net.json"), std::string::npos) << error;
  EXPECT_NE(error.find("line 2"), std::string::npos) << error;
  EXPECT_NE(InputErrorOf([&] { Read("{\"input_width\": ", "net.json"); }).find("net.json"), std::string::npos);
  EXPECT_NE(InputErrorOf([&] { ReadSegmentConfig(folder_ / "absent.toml"); }).find("absent.toml"), std::string::npos);
}

}  // namespace
}  // namespace skyquilt::masks
