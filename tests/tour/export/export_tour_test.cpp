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
#include "tests/core/gis/limited_file_size.h"
#include "tests/support/error_of.h"
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

TEST(ExportTour, WritesEverythingAndSaysWhatIsMissing) {
  SampleTourProject sample;
  const Exported exported = sample.Export();
  EXPECT_EQ(exported.stops, 2U);
  EXPECT_EQ(exported.tiles, 21U);
  EXPECT_EQ(exported.bytes, BytesOfAll(sample.out));
  std::set<std::string> expected = {"index.html", "tour.js", "tour.css", "licences.txt", "poster.jpg", "embed.html"};
  for (const char* name : {"project.json", "tour.json", "manifest.json", "measurements.geojson", "terrain.bin", "tiles/tileset.json"}) {
    expected.insert(std::string("data/") + name + ".js");
  }
  expected.insert("data/assets/" + sample.picture_name + ".js");
  for (const char* stop : {"first", "second"}) {
    for (const char* name : {"still.png", "still.depth", "panorama.jpg", "panorama.depth"})
      expected.insert(std::string("data/stops/") + stop + "/" + name + ".js");
  }
  for (const auto& entry : fs::directory_iterator(sample.parts.tiles)) {
    if (entry.path().extension() == ".glb") expected.insert("data/tiles/" + entry.path().filename().string() + ".js");
  }
  EXPECT_EQ(AllFiles(sample.out), expected);

  EXPECT_EQ(ContentOf(sample.out, "tour.json"), base::ReadFile(sample.project / "tour.json")) << "as it was saved";
  EXPECT_EQ(ContentOf(sample.out, "assets/" + sample.picture_name), sample.picture);
  EXPECT_EQ(ContentOf(sample.out, "terrain.bin"), "terrain");
  const nlohmann::json manifest = JsonOf(sample.out, "manifest.json");
  EXPECT_EQ(manifest["version"], 1);
  EXPECT_EQ(manifest["made_by"], "skyquilt 9");
  ASSERT_EQ(manifest["missing"].size(), 1U);
  EXPECT_NE(manifest["missing"][0].get<std::string>().find("lost.png"), std::string::npos);
  EXPECT_EQ(manifest["stops"].size(), 2U);
  const image::Image8 poster = image::LoadRgb8(sample.out / "poster.jpg");
  EXPECT_EQ(poster.width, 48);
  // The folder is given away: neither exact frames nor names of folders of this machine.
  const nlohmann::json project = JsonOf(sample.out, "project.json");
  EXPECT_TRUE(project["scene"].is_null() && project["points"].is_null());
  EXPECT_EQ(project["photos"][0]["available"], false);
  EXPECT_EQ(ContentOf(sample.out, "project.json").find("somebody"), std::string::npos);
}

// Texts of a tour are in base64, and nowhere else but, escaped, in embed.html.
TEST(ExportTour, ScriptsInTextsStayData) {
  SampleTourProject sample;
  SaveTour(sample.TourWith("</title><script>alert(1)</script>"), sample.project);
  sample.Export();
  for (const std::string& name : AllFiles(sample.out)) {
    EXPECT_EQ(base::ReadFile(sample.out / name).find("<script>alert("), std::string::npos) << name;
  }
  EXPECT_EQ(JsonOf(sample.out, "tour.json")["stops"][0]["title"], "</script><script>alert(1)</script>");
}

TEST(ExportTour, ALimitTakesTheFinestTilesFirst) {
  SampleTourProject sample;
  const int64_t whole = sample.Export().bytes;
  sample.counted.n_rays = 0;
  sample.options.size_mb = static_cast<double>(whole - 20'000) / 1e6;
  const Exported less = sample.Export();
  EXPECT_LE(less.bytes, sample.options.SizeBytes());
  EXPECT_EQ(less.bytes, BytesOfAll(sample.out));
  EXPECT_LT(less.tiles, 21U);
  EXPECT_GE(less.tiles, 5U);
  EXPECT_EQ(sample.counted.n_rays, 0) << "the pictures are there";
  // Stops are over one corner: their quarter stays fine.
  EXPECT_TRUE(fs::exists(sample.out / "data/tiles/0_0_0.glb.js"));
  EXPECT_FALSE(fs::exists(sample.out / "data/tiles/0_3_3.glb.js"));
}

TEST(ExportTour, TooLittleRoomIsAnErrorThatNamesTheLeast) {
  SampleTourProject sample;
  sample.Export();
  sample.options.size_mb = 0.005;
  const std::string before = base::ReadFile(sample.out / "data" / "manifest.json.js");
  const std::string error = InputErrorOf([&] { sample.Export(); });
  EXPECT_NE(error.find("needs at least"), std::string::npos) << error;
  EXPECT_EQ(base::ReadFile(sample.out / "data" / "manifest.json.js"), before) << "the earlier export stays";
}

TEST(ExportTour, AnInterruptionLeavesNothingAndLosesNoPicture) {
  SampleTourProject sample;
  int batches = 0;
  // In the second of four pictures; the stills have two batches each, the panoramas three.
  sample.counted.after_batch = [&batches] {
    if (++batches == 4) base::RequestCancel();
  };
  EXPECT_THROW(sample.Export(), base::Interrupted);
  base::ClearCancel();
  EXPECT_FALSE(fs::exists(sample.out));
  EXPECT_FALSE(fs::exists(sample.folder / "given away.partial"));
  sample.counted.after_batch = nullptr;
  sample.counted.n_rays = 0;
  sample.Export();
  EXPECT_EQ(sample.counted.n_rays, 48 * 27 + 2 * 64 * 32);
  EXPECT_TRUE(fs::exists(sample.out / "index.html"));
}

TEST(ExportTour, AFullDiskLeavesTheEarlierExport) {
  SampleTourProject sample;
  sample.Export();
  const std::string before = base::ReadFile(sample.out / "data" / "tour.json.js");
  SaveTour(sample.TourWith("Another"), sample.project);
  {
    const LimitedFileSize full(1500);
    EXPECT_THROW(sample.Export(), base::InputError);
  }
  EXPECT_EQ(base::ReadFile(sample.out / "data" / "tour.json.js"), before);
  EXPECT_TRUE(fs::exists(sample.out / "index.html"));
  EXPECT_FALSE(fs::exists(sample.folder / "given away.partial"));
}

TEST(ExportTour, AnotherVersionIsExportedAsFarAsItIsUnderstood) {
  SampleTourProject sample;
  nlohmann::json json = base::ParseJson(base::ReadFile(sample.project / "tour.json"));
  json["version"] = 2;
  json["weather"] = "sunny";
  json["stops"][1]["pose"] = "inside";
  base::WriteFileAtomically(sample.project / "tour.json", base::JsonText(json));
  const Exported exported = sample.Export();
  EXPECT_EQ(exported.stops, 1U);
  EXPECT_GE(exported.missing.size(), 2U);
  EXPECT_EQ(JsonOf(sample.out, "manifest.json")["missing"], exported.missing);
  EXPECT_FALSE(fs::exists(sample.out / "data/stops/second"));
}

// An asset whose content is not what its name says would be refused by nobody later.
TEST(ExportTour, AChangedAssetCountsAsMissing) {
  SampleTourProject sample;
  base::WriteFileAtomically(AssetFolder(sample.project) / sample.picture_name, std::string(sample.picture.size(), 'x'));
  EXPECT_EQ(sample.Export().missing.size(), 2U);
  EXPECT_FALSE(fs::exists(sample.out / "data" / "assets"));
}

// A file put there by hand under the right digest, which no upload would have let in.
TEST(ExportTour, AnAssetOfAWrongTypeIsLeftOutByNameAndTheRestPlays) {
  SampleTourProject sample;
  const std::string page = "<html><script>alert(1)</script></html>", program = "MZ\x90" + std::string(200, '\0');
  const std::string picture_name = AssetNameOf(page, "png"), model_name = AssetNameOf(program, "glb");
  base::WriteFileAtomically(AssetFolder(sample.project) / picture_name, page);
  base::WriteFileAtomically(AssetFolder(sample.project) / model_name, program);
  Tour tour = sample.TourWith("A farm");
  tour.stops[1].picture = picture_name;
  Thing model;
  model.kind = ThingKind::kModel;
  model.id = "thing";
  model.text = "The shed";
  model.asset = model_name;
  tour.things.push_back(model);
  tour.assets[picture_name] = {"page.png", page.size()};
  tour.assets[model_name] = {"shed.glb", program.size()};
  SaveTour(tour, sample.project);
  const Exported exported = sample.Export();
  EXPECT_EQ(exported.stops, 2U);
  ASSERT_EQ(exported.missing.size(), 4U);
  const auto says = [&](const std::string& one, const std::string& two) {
    return std::ranges::any_of(exported.missing,
                               [&](const std::string& text) { return text.find(one) != std::string::npos && text.find(two) != std::string::npos; });
  };
  EXPECT_TRUE(says("農場", "page.png") && says("The shed", "shed.glb"));
  EXPECT_TRUE(says(picture_name, "it is not a PNG picture") && says(model_name, "left out"));
  EXPECT_FALSE(fs::exists(sample.out / "data" / "assets" / (picture_name + ".js")) ||
               fs::exists(sample.out / "data" / "assets" / (model_name + ".js")));
  EXPECT_EQ(ContentOf(sample.out, "assets/" + sample.picture_name), sample.picture);
  const auto files = JsonOf(sample.out, "manifest.json")["files"].get<std::set<std::string>>();
  EXPECT_TRUE(files.contains("assets/" + sample.picture_name));
  EXPECT_FALSE(files.contains("assets/" + picture_name) || files.contains("assets/" + model_name));
}

// The page brightens the surface and the pictures of the stop alike, so these are not bright themselves; the poster is shown without it.
TEST(ExportTour, TheExposureOfAStopIsLeftToThePage) {
  SampleTourProject sample;
  sample.Export();
  const image::Image8 plain = image::LoadRgb8(sample.out / "poster.jpg");
  const std::string still = ContentOf(sample.out, "stops/first/still.png");
  Tour tour = sample.TourWith("Brighter");
  tour.stops[0].exposure_stops = 1.0;
  SaveTour(tour, sample.project);
  sample.counted.n_rays = 0;
  sample.Export();
  EXPECT_EQ(sample.counted.n_rays, 0) << "the same pictures";
  EXPECT_EQ(ContentOf(sample.out, "stops/first/still.png"), still);
  const image::Image8 bright = image::LoadRgb8(sample.out / "poster.jpg");
  ASSERT_EQ(bright.data.size(), plain.data.size());
  double off = 0.0;
  for (size_t i = 0; i < plain.data.size(); ++i) {
    const float linear = 2.0F * image::LinearFromSrgb(static_cast<float>(plain.data[i]) / 255.0F);
    const float expected = std::min(255.0F, 255.0F * image::SrgbFromLinear(linear));
    off += static_cast<double>(std::abs(expected - static_cast<float>(bright.data[i])));
  }
  EXPECT_LT(off / static_cast<double>(plain.data.size()), 6.0) << "both are JPEGs";
}

TEST(ExportTour, GoesIntoTheProjectWithoutTouchingUploads) {
  SampleTourProject sample;
  sample.out = sample.project / "tour";
  sample.Export();
  sample.Export();
  EXPECT_TRUE(fs::exists(sample.out / "index.html"));
  EXPECT_EQ(base::ReadFile(sample.out / "assets" / sample.picture_name), sample.picture);
}

TEST(ExportTour, ATourIsNeededAndAFolderOfOthersRefused) {
  SampleTourProject sample;
  fs::create_directories(sample.out);
  base::WriteFileAtomically(sample.out / "thesis.doc", "all my work");
  EXPECT_THROW(sample.Export(), base::InputError);
  EXPECT_EQ(sample.counted.n_rays, 0);
  fs::remove_all(sample.out);
  fs::remove(sample.project / "tour.json");
  EXPECT_THROW(sample.Export(), base::InputError);
  SaveTour(Tour{}, sample.project);
  EXPECT_THROW(sample.Export(), base::InputError) << "no stops";
}

TEST(TourOptions, APanoramaHasAnEvenWidth) {
  TourOptions options;
  EXPECT_NO_THROW(options.Check());
  options.panorama_width = 1025;
  EXPECT_THROW(options.Check(), base::UsageError);
}

TEST(ExportTour, AVideoIsPartOfIt) {
  SampleTourProject sample;
  ExportInput input = sample.Input();
  const VideoSpec spec{.width = 16, .height = 16, .fps = 2, .exposure = "normal"};
  input.make_video = [&](const Tour& tour, const fs::path& file) { WriteTourVideo(tour, nullptr, sample.counted.field, spec, file); };
  const Exported exported = ExportTour(input, sample.parts, sample.counted.field, sample.threads);
  EXPECT_GT(fs::file_size(sample.out / "tour.mp4"), 500U);
  EXPECT_EQ(exported.bytes, BytesOfAll(sample.out));
  sample.Export();
  EXPECT_FALSE(fs::exists(sample.out / "tour.mp4")) << "not one of an earlier tour";
}

TEST(ExportTour, WithoutASurfaceItSaysSo) {
  SampleTourProject sample;
  sample.parts.tiles.clear();
  sample.parts.terrain = nullptr;
  const Exported exported = sample.Export();
  EXPECT_EQ(exported.tiles_of, 0U);
  EXPECT_EQ(exported.missing.size(), 2U);
  EXPECT_TRUE(JsonOf(sample.out, "project.json")["tiles"].is_null());
  EXPECT_TRUE(JsonOf(sample.out, "project.json")["terrain"].is_null());
}

}  // namespace
}  // namespace skyquilt::tour
