#include "viewer/data/gcp_list.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace skyquilt::viewer {
namespace {

TEST(GcpList, ReadsWhatOthersWrite) {
  const nlohmann::json gcp = ReadGcpList(
      "# comment\r\n"
      "WGS84 UTM 32N\r\n"
      "465400.5\t5247100.25 410 100.5 200.25 a.jpg north\r\n"
      "\n"
      "465400.5 5247100.25 410 1 2 b.jpg north extra words\n"
      "1 2 3 4 5 c.jpg\n"
      "1 2 3 6 7 d.jpg\n"
      "1 2 3 4\n"
      "1 2 three 4 5 e.jpg\n"
      "1 2 nan 4 5 e.jpg");
  EXPECT_EQ(gcp["crs"], "WGS84 UTM 32N");
  ASSERT_EQ(gcp["points"].size(), 2U);
  EXPECT_EQ(gcp["points"][0]["name"], "north");
  EXPECT_EQ(gcp["points"][0]["marks"].size(), 2U);
  EXPECT_EQ(gcp["points"][0]["marks"][0]["pixel"], nlohmann::json({100.5, 200.25}));
  EXPECT_EQ(gcp["points"][1]["marks"].size(), 2U) << "the same place without a name is one point";
  EXPECT_EQ(gcp["skipped"], 3);
}

TEST(GcpList, ReadsBackWhatItWrites) {
  const nlohmann::json gcp = nlohmann::json::parse(R"({"crs": "EPSG:32632", "points": [
    {"name": "a", "x": 465400.1234, "y": 5247100.25, "z": -410.5, "marks": [{"photo": "1.jpg", "pixel": [0.25, 3999.75]}, {"photo": "2.jpg", "pixel": [1.0, 2.0]}]},
    {"name": "b", "x": 1.0, "y": 2.0, "z": 3.0, "marks": [{"photo": "1.jpg", "pixel": [5.0, 6.0]}]}]})");
  EXPECT_EQ(ReadGcpList(GcpListText(gcp)), gcp);
}

TEST(GcpList, EmptyAndOddTextsAreNoPoints) {
  for (const char* text : {"", "\n\n", "#", "EPSG:32632", "EPSG:32632\n\n#x\n", "\xff\xfe\x00"}) {
    EXPECT_TRUE(ReadGcpList(text)["points"].empty()) << text;
  }
}

}  // namespace
}  // namespace skyquilt::viewer
