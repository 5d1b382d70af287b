#include "tour/export/export_tour.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/json_text.h"
#include "core/image/image.h"
#include "core/image/srgb.h"
#include "tests/support/error_of.h"
#include "tests/support/limited_file_size.h"
#include "tests/tour/export/sample_tour_project.h"
#include "tour/export/tour_video.h"

namespace skyquilt::tour {
namespace {

namespace fs = std::filesystem;

nlohmann::json JsonOf(const fs::path& out, const std::string& name) {
  return base::ParseJson(ContentOf(out, name));
}

std::set<std::string> AllFiles(const fs::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) names.insert(entry.path().lexically_relative(folder).generic_string());
  }
  return names;
}

int64_t BytesOfAll(const fs::path& folder) {
  int64_t bytes = 0;
  for (const std::string& name : AllFiles(folder)) bytes += static_cast<int64_t>(fs::file_size(folder / name));
  return bytes;
}

class ExportTourTest : public ::testing::Test, protected SampleTourProject {};

TEST_F(ExportTourTest, WritesEverythingAndSaysWhatIsMissing) {
  const Exported exported = Export();
  EXPECT_EQ(exported.stops, 2U);
  EXPECT_EQ(exported.tiles, 21U);
  EXPECT_EQ(exported.bytes, BytesOfAll(out));
  std::set<std::string> expected = {"index.html", "tour.js", "tour.css", "licences.txt", "poster.jpg", "embed.html"};
  for (const char* name : {"project.json", "tour.json", "manifest.json", "measurements.geojson", "terrain.bin", "tiles/tileset.json"}) {
    expected.insert(std::string("data/") + name + ".js");
  }
  expected.insert("data/assets/" + picture_name + ".js");
  for (const char* stop : {"first", "second"}) {
    for (const char* name : {"still.png", "still.depth", "panorama.jpg", "panorama.depth"})
      expected.insert(std::string("data/stops/") + stop + "/" + name + ".js");
  }
  for (const auto& entry : fs::directory_iterator(parts.tiles)) {
    if (entry.path().extension() == ".glb") expected.insert("data/tiles/" + entry.path().filename().string() + ".js");
  }
  EXPECT_EQ(AllFiles(out), expected);

  EXPECT_EQ(ContentOf(out, "tour.json"), base::ReadFile(project / "tour.json")) << "as it was saved";
  EXPECT_EQ(ContentOf(out, "assets/" + picture_name), picture);
  EXPECT_EQ(ContentOf(out, "terrain.bin"), "terrain");
  const nlohmann::json manifest = JsonOf(out, "manifest.json");
  EXPECT_EQ(manifest["version"], 1);
  EXPECT_EQ(manifest["made_by"], "skyquilt 9");
  ASSERT_EQ(manifest["missing"].size(), 1U);
  EXPECT_NE(manifest["missing"][0].get<std::string>().find("lost.png"), std::string::npos);
  EXPECT_EQ(manifest["stops"].size(), 2U);
  const image::Image8 poster = image::LoadRgb8(out / "poster.jpg");
  EXPECT_EQ(poster.width, 48);
  // The folder is given away: neither exact frames nor names of folders of this machine.
  const nlohmann::json project = JsonOf(out, "project.json");
  EXPECT_TRUE(project["scene"].is_null() && project["points"].is_null());
  EXPECT_EQ(project["photos"][0]["available"], false);
  EXPECT_EQ(ContentOf(out, "project.json").find("somebody"), std::string::npos);
}

// Texts of a tour are in base64, and nowhere else but, escaped, in embed.html.
TEST_F(ExportTourTest, ScriptsInTextsStayData) {
  SaveTour(TourWith("</title><script>alert(1)</script>"), project);
  Export();
  for (const std::string& name : AllFiles(out)) {
    EXPECT_EQ(base::ReadFile(out / name).find("<script>alert("), std::string::npos) << name;
  }
  EXPECT_EQ(JsonOf(out, "tour.json")["stops"][0]["title"], "</script><script>alert(1)</script>");
}

TEST_F(ExportTourTest, ALimitTakesTheFinestTilesFirst) {
  const int64_t whole = Export().bytes;
  counted.n_rays = 0;
  options.size_mb = static_cast<double>(whole - 20'000) / 1e6;
  const Exported less = Export();
  EXPECT_LE(less.bytes, options.SizeBytes());
  EXPECT_EQ(less.bytes, BytesOfAll(out));
  EXPECT_LT(less.tiles, 21U);
  EXPECT_GE(less.tiles, 5U);
  EXPECT_EQ(counted.n_rays, 0) << "the pictures are there";
  // Stops are over one corner: their quarter stays fine.
  EXPECT_TRUE(fs::exists(out / "data/tiles/0_0_0.glb.js"));
  EXPECT_FALSE(fs::exists(out / "data/tiles/0_3_3.glb.js"));
}

TEST_F(ExportTourTest, TooLittleRoomIsAnErrorThatNamesTheLeast) {
  Export();
  options.size_mb = 0.005;
  const std::string before = base::ReadFile(out / "data" / "manifest.json.js");
  const std::string error = InputErrorOf([&] { Export(); });
  EXPECT_NE(error.find("needs at least"), std::string::npos) << error;
  EXPECT_EQ(base::ReadFile(out / "data" / "manifest.json.js"), before) << "the earlier export stays";
}

TEST_F(ExportTourTest, AnInterruptionLeavesNothingAndLosesNoPicture) {
  int batches = 0;
  // In the second of four pictures; the stills have two batches each, the panoramas three.
  counted.after_batch = [&batches] {
    if (++batches == 4) base::RequestCancel();
  };
  EXPECT_THROW(Export(), base::Interrupted);
  base::ClearCancel();
  EXPECT_FALSE(fs::exists(out));
  EXPECT_FALSE(fs::exists(folder / "given away.partial"));
  counted.after_batch = nullptr;
  counted.n_rays = 0;
  Export();
  EXPECT_EQ(counted.n_rays, 48 * 27 + 2 * 64 * 32);
  EXPECT_TRUE(fs::exists(out / "index.html"));
}

TEST_F(ExportTourTest, AFullDiskLeavesTheEarlierExport) {
  Export();
  const std::string before = base::ReadFile(out / "data" / "tour.json.js");
  SaveTour(TourWith("Another"), project);
  {
    const LimitedFileSize full(1500);
    EXPECT_THROW(Export(), base::InputError);
  }
  EXPECT_EQ(base::ReadFile(out / "data" / "tour.json.js"), before);
  EXPECT_TRUE(fs::exists(out / "index.html"));
  EXPECT_FALSE(fs::exists(folder / "given away.partial"));
}

TEST_F(ExportTourTest, AnotherVersionIsExportedAsFarAsItIsUnderstood) {
  nlohmann::json json = base::ParseJson(base::ReadFile(project / "tour.json"));
  json["version"] = 2;
  json["weather"] = "sunny";
  json["stops"][1]["pose"] = "inside";
  base::WriteFileAtomically(project / "tour.json", base::JsonText(json));
  const Exported exported = Export();
  EXPECT_EQ(exported.stops, 1U);
  EXPECT_GE(exported.missing.size(), 2U);
  EXPECT_EQ(JsonOf(out, "manifest.json")["missing"], exported.missing);
  EXPECT_FALSE(fs::exists(out / "data/stops/second"));
}

// An asset whose content is not what its name says would be refused by nobody later.
TEST_F(ExportTourTest, AChangedAssetCountsAsMissing) {
  base::WriteFileAtomically(AssetFolder(project) / picture_name, std::string(picture.size(), 'x'));
  EXPECT_EQ(Export().missing.size(), 2U);
  EXPECT_FALSE(fs::exists(out / "data" / "assets"));
}

// A file put there by hand under the right digest, which no upload would have let in.
TEST_F(ExportTourTest, AnAssetOfAWrongTypeIsLeftOutByNameAndTheRestPlays) {
  const std::string page = "<html><script>alert(1)</script></html>", program = "MZ\x90" + std::string(200, '\0');
  const std::string page_name = AssetNameOf(page, "png"), model_name = AssetNameOf(program, "glb");
  base::WriteFileAtomically(AssetFolder(project) / page_name, page);
  base::WriteFileAtomically(AssetFolder(project) / model_name, program);
  Tour tour = TourWith("A farm");
  tour.stops[1].picture = page_name;
  Thing model;
  model.kind = ThingKind::kModel;
  model.id = "thing";
  model.text = "The shed";
  model.asset = model_name;
  tour.things.push_back(model);
  tour.assets[page_name] = {"page.png", page.size()};
  tour.assets[model_name] = {"shed.glb", program.size()};
  SaveTour(tour, project);
  const Exported exported = Export();
  EXPECT_EQ(exported.stops, 2U);
  ASSERT_EQ(exported.missing.size(), 4U);
  const auto says = [&](const std::string& one, const std::string& two) {
    return std::ranges::any_of(exported.missing,
                               [&](const std::string& text) { return text.find(one) != std::string::npos && text.find(two) != std::string::npos; });
  };
  EXPECT_TRUE(says("農場", "page.png") && says("The shed", "shed.glb"));
  EXPECT_TRUE(says(page_name, "it is not a PNG picture") && says(model_name, "left out"));
  EXPECT_FALSE(fs::exists(out / "data" / "assets" / (page_name + ".js")) || fs::exists(out / "data" / "assets" / (model_name + ".js")));
  EXPECT_EQ(ContentOf(out, "assets/" + picture_name), picture);
  const auto files = JsonOf(out, "manifest.json")["files"].get<std::set<std::string>>();
  EXPECT_TRUE(files.contains("assets/" + picture_name));
  EXPECT_FALSE(files.contains("assets/" + page_name) || files.contains("assets/" + model_name));
}

// The page brightens the surface and the pictures of the stop alike, so these are not bright themselves; the poster is shown without it.
TEST_F(ExportTourTest, TheExposureOfAStopIsLeftToThePage) {
  Export();
  const image::Image8 plain = image::LoadRgb8(out / "poster.jpg");
  const std::string still = ContentOf(out, "stops/first/still.png");
  Tour tour = TourWith("Brighter");
  tour.stops[0].exposure_stops = 1.0;
  SaveTour(tour, project);
  counted.n_rays = 0;
  Export();
  EXPECT_EQ(counted.n_rays, 0) << "the same pictures";
  EXPECT_EQ(ContentOf(out, "stops/first/still.png"), still);
  const image::Image8 bright = image::LoadRgb8(out / "poster.jpg");
  ASSERT_EQ(bright.data.size(), plain.data.size());
  double off = 0.0;
  for (size_t i = 0; i < plain.data.size(); ++i) {
    const float linear = 2.0F * image::LinearFromSrgb(static_cast<float>(plain.data[i]) / 255.0F);
    const float expected = std::min(255.0F, 255.0F * image::SrgbFromLinear(linear));
    off += static_cast<double>(std::abs(expected - static_cast<float>(bright.data[i])));
  }
  EXPECT_LT(off / static_cast<double>(plain.data.size()), 6.0) << "both are JPEGs";
}

TEST_F(ExportTourTest, GoesIntoTheProjectWithoutTouchingUploads) {
  out = project / "tour";
  Export();
  Export();
  EXPECT_TRUE(fs::exists(out / "index.html"));
  EXPECT_EQ(base::ReadFile(out / "assets" / picture_name), picture);
}

TEST_F(ExportTourTest, ATourIsNeededAndAFolderOfOthersRefused) {
  fs::create_directories(out);
  base::WriteFileAtomically(out / "thesis.doc", "all my work");
  EXPECT_THROW(Export(), base::InputError);
  EXPECT_EQ(counted.n_rays, 0);
  fs::remove_all(out);
  fs::remove(project / "tour.json");
  EXPECT_THROW(Export(), base::InputError);
  SaveTour(Tour{}, project);
  EXPECT_THROW(Export(), base::InputError) << "no stops";
}

TEST(TourOptions, APanoramaHasAnEvenWidth) {
  TourOptions options;
  EXPECT_NO_THROW(options.Check());
  options.panorama_width = 1025;
  EXPECT_THROW(options.Check(), base::UsageError);
}

TEST_F(ExportTourTest, AVideoIsPartOfIt) {
  ExportInput input = Input();
  const VideoSpec spec{.width = 16, .height = 16, .fps = 2, .exposure = "normal"};
  input.make_video = [&](const Tour& tour, const fs::path& file) { WriteTourVideo(tour, nullptr, counted.field, spec, file); };
  const Exported exported = ExportTour(input, parts, counted.field, threads);
  EXPECT_GT(fs::file_size(out / "tour.mp4"), 500U);
  EXPECT_EQ(exported.bytes, BytesOfAll(out));
  Export();
  EXPECT_FALSE(fs::exists(out / "tour.mp4")) << "not one of an earlier tour";
}

TEST_F(ExportTourTest, WithoutASurfaceItSaysSo) {
  parts.tiles.clear();
  parts.terrain = nullptr;
  const Exported exported = Export();
  EXPECT_EQ(exported.tiles_of, 0U);
  EXPECT_EQ(exported.missing.size(), 2U);
  EXPECT_TRUE(JsonOf(out, "project.json")["tiles"].is_null());
  EXPECT_TRUE(JsonOf(out, "project.json")["terrain"].is_null());
}

}  // namespace
}  // namespace skyquilt::tour
