#include "odm/place_files.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/progress.h"
#include "core/gis/geotiff.h"
#include "core/gis/read_maps.h"
#include "odm/stage_lines.h"
#include "surface/files/surface_files.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"
#include "tests/surface/files/sample_surface.h"

namespace skyquilt::odm {
namespace {

namespace fs = std::filesystem;

ino_t NumberOf(const fs::path& file) {
  struct stat state = {};
  EXPECT_EQ(stat(file.c_str(), &state), 0) << file;
  return state.st_ino;
}

TEST(ProvideFile, IsAHardLinkThatLeadsToTheNewFile) {
  const TemporaryFolder folder;
  base::WriteFileAtomically(folder / "a", "old");
  ProvideFile(folder / "a", folder / "deep" / "b");
  EXPECT_EQ(NumberOf(folder / "a"), NumberOf(folder / "deep" / "b")) << "no second copy on the disk";
  base::WriteFileAtomically(folder / "a", "new");
  EXPECT_EQ(base::ReadFile(folder / "deep" / "b"), "old") << "a replaced file leaves the link's alone";
  ProvideFile(folder / "a", folder / "deep" / "b");
  EXPECT_EQ(base::ReadFile(folder / "deep" / "b"), "new");
  ProvideFile(folder / "none", folder / "deep" / "b");
  EXPECT_FALSE(fs::exists(folder / "deep" / "b")) << "what is not there must not look like a result";
}

TEST(UprightGlb, OnlyItsHeadIsOther) {
  const TemporaryFolder folder;
  const surface::MapFrame frame = surface::TorontoFrame();
  surface::SurfaceFiles files(frame, {.glb = true, .obj = false, .ply = false, .cloud = false, .tiles = false}, surface::kSampleTile_m,
                              folder.path());
  files.Add(surface::SampleTile({0, 0, 0}));
  files.Close();
  WriteUprightGlb(folder / "mesh.glb", frame.offset(), folder / "odm" / "model.glb");
  const surface::Glb before(folder / "mesh.glb"), after(folder / "odm" / "model.glb");
  EXPECT_EQ(after.binary, before.binary);
  EXPECT_EQ(after.json.at("accessors"), before.json.at("accessors"));
  EXPECT_EQ(after.json.at("extensions").at("CESIUM_RTC").at("center").at(0), frame.offset().x());
  EXPECT_EQ(after.json.at("extensions").at("CESIUM_RTC").at("center").at(1), frame.offset().y());
  EXPECT_EQ(after.json.at("extensionsUsed").back(), "CESIUM_RTC");
  const nlohmann::json& scene_nodes = after.json.at("scenes").at(0).at("nodes");
  ASSERT_EQ(scene_nodes.size(), 1U);
  const nlohmann::json& top = after.json.at("nodes").at(scene_nodes.at(0).get<size_t>());
  EXPECT_EQ(top.at("children"), before.json.at("scenes").at(0).at("nodes"));
  const auto& turn = top.at("rotation");
  const Eigen::Quaterniond rotation(turn[3].get<double>(), turn[0].get<double>(), turn[1].get<double>(), turn[2].get<double>());
  EXPECT_LT((rotation * Eigen::Vector3d(1.0, 2.0, 3.0) - Eigen::Vector3d(1.0, -3.0, 2.0)).norm(), 1e-12) << "y up becomes z up";
  base::WriteFileAtomically(folder / "bad.glb", "glTF");
  EXPECT_NE(InputErrorOf([&] { WriteUprightGlb(folder / "bad.glb", {0, 0, 0}, folder / "x.glb"); }).find("bad.glb"), std::string::npos);
}

// A project folder with maps and a surface, and a dataset around it.
class PlacedProducts : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(project_.ProductsFolder());
    fs::create_directories(project_.SurfaceFolder());
    WriteMap(project_.ProductsFolder() / "dsm.tif");
    WriteMap(project_.ProductsFolder() / "orthophoto.tif");
    WriteMap(project_.SurfaceFolder() / "dtm.tif");
    surface::SurfaceFiles files(frame_, {.glb = true, .obj = true, .ply = false, .cloud = true, .tiles = true}, surface::kSampleTile_m,
                                project_.SurfaceFolder(), 40);
    files.Add(surface::SampleTile({0, 0, 0}));
    files.AddPoints(surface::SamplePoints(100));
    files.Close();
  }
  // Heights of 64 x 64 cells of half a metre, rising by 1 m per cell to the east.
  void WriteMap(const fs::path& file) const {
    const gis::MapGrid grid{
        .georeferenced = true, .zone = frame_.zone(), .left = 630000.0, .top = 4833032.0, .resolution_m = 0.5, .width = 64, .height = 64};
    std::vector<float> values;
    for (size_t i = 0; i < grid.size(); ++i) values.push_back(static_cast<float>(i % 64));
    gis::GeoTiffWriter writer(file, {.grid = grid, .type = gis::PixelType::kFloat32, .nodata = -9999.0, .metadata = {{"PLACE", "here"}}});
    writer.WriteRows(0, grid.height, std::span<const float>(values));
    writer.Close();
  }
  bool Has(const std::string& name) const { return fs::is_regular_file(dataset_.folder / name); }

  TemporaryFolder folder_;
  Dataset dataset_{.folder = folder_.path(), .images = folder_ / "images", .project = folder_ / "skyquilt"};
  coordinator::Project project_{.folder = folder_ / "skyquilt"};
  const surface::MapFrame frame_ = surface::TorontoFrame();
};

TEST_F(PlacedProducts, AreWhereOpenDroneMapHasThem) {
  const Wishes all{.dsm = true, .dtm = true, .glb = true, .ept = true, .tiles_3d = true};
  PlaceProducts(dataset_, project_, all, {.orthophoto_m = 0.5, .heights_m = 0.5});
  for (const char* name : {"odm_orthophoto/odm_orthophoto.tif", "odm_dem/dsm.tif", "odm_dem/dtm.tif", "odm_texturing/odm_textured_model_geo.obj",
                           "odm_texturing/odm_textured_model_geo.mtl", "odm_texturing/odm_textured_model_geo.glb",
                           "odm_georeferencing/odm_georeferenced_model_1.las", "odm_georeferencing/odm_georeferenced_model_3.las",
                           "odm_georeferencing/coords.txt", "3d_tiles/model/tileset.json", "entwine_pointcloud/ept.json"}) {
    EXPECT_TRUE(Has(name)) << name;
  }
  EXPECT_EQ(NumberOf(dataset_.folder / "odm_dem" / "dsm.tif"), NumberOf(project_.ProductsFolder() / "dsm.tif"));
  const nlohmann::json ept = base::ParseJson(base::ReadFile(dataset_.folder / "entwine_pointcloud" / "ept.json"));
  EXPECT_EQ(ept.at("points"), 100);
  EXPECT_EQ(ept.at("srs").at("horizontal"), std::to_string(frame_.zone().Epsg()));
  EXPECT_TRUE(base::ReadFile(dataset_.folder / "odm_georeferencing" / "coords.txt").starts_with("WGS84 UTM 17N\n"));
  // Another run that asks for less leaves nothing of this one.
  PlaceProducts(dataset_, project_, {.orthophoto = false, .mesh = false}, {.orthophoto_m = 0.5, .heights_m = 0.5});
  for (const char* name : {"odm_orthophoto/odm_orthophoto.tif", "odm_dem/dsm.tif", "odm_dem/dtm.tif", "odm_texturing/odm_textured_model_geo.obj",
                           "3d_tiles/model/tileset.json", "entwine_pointcloud/ept.json"}) {
    EXPECT_FALSE(Has(name)) << name;
  }
  EXPECT_TRUE(Has("odm_georeferencing/odm_georeferenced_model_1.las"));
}

TEST_F(PlacedProducts, MapsHaveTheCellsThatWereAskedFor) {
  PlaceProducts(dataset_, project_, {.dsm = true, .cloud = false}, {.orthophoto_m = 0.5, .heights_m = 2.0});
  const gis::MapGrid coarse = gis::ReadMapGrid(dataset_.folder / "odm_dem" / "dsm.tif");
  EXPECT_EQ(coarse.resolution_m, 2.0);
  EXPECT_EQ(coarse.width, 16);
  EXPECT_EQ(coarse.left, 630000.0);
  const image::ImageF heights = gis::MapReader(dataset_.folder / "odm_dem" / "dsm.tif").Read(0, 0, 16, 16);
  for (int column = 0; column < 16; ++column) EXPECT_NEAR(heights.At(column, 5)[0], 4.0F * static_cast<float>(column) + 1.5F, 1e-4F) << "means";
  EXPECT_EQ(gis::ReadMapGrid(dataset_.folder / "odm_orthophoto" / "odm_orthophoto.tif").resolution_m, 0.5);
}

TEST_F(PlacedProducts, CanBeCopiedAndRemoved) {
  PlaceProducts(dataset_, project_, {.dsm = true}, {});
  CopyResults(dataset_.folder, folder_ / "copy");
  EXPECT_TRUE(fs::is_regular_file(folder_ / "copy" / "odm_dem" / "dsm.tif"));
  EXPECT_FALSE(fs::exists(folder_ / "copy" / "skyquilt"));
  RemoveResultFolders(dataset_.folder);
  EXPECT_FALSE(fs::exists(dataset_.folder / "odm_dem"));
  EXPECT_TRUE(fs::exists(project_.ProductsFolder() / "dsm.tif"));
}

// A socket on which NodeODM would listen.
class Listener {
 public:
  Listener() : socket_(socket(AF_INET, SOCK_DGRAM, 0)) {
    sockaddr_in address = {};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    EXPECT_EQ(bind(socket_, reinterpret_cast<const sockaddr*>(&address), size), 0);
    EXPECT_EQ(getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size), 0);
    port_ = ntohs(address.sin_port);
  }
  ~Listener() { close(socket_); }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;
  int port() const { return port_; }
  // All that came so far.
  std::vector<std::string> Heard() const {
    std::vector<std::string> messages;
    std::string buffer(200, '\0');
    for (ssize_t n = 0; (n = recv(socket_, buffer.data(), buffer.size(), MSG_DONTWAIT)) > 0;)
      messages.push_back(buffer.substr(0, static_cast<size_t>(n)));
    return messages;
  }

 private:
  int socket_;
  int port_ = 0;
};

TEST(StageLines, TellWhatRunsAndHowFarItIs) {
  const Listener listener;
  const Step train = Steps().at(2);
  ASSERT_EQ(train.stage, "train");
  testing::internal::CaptureStdout();
  {
    StageLines lines("0b1c-uuid", listener.port());
    lines.Begin(train);
    base::Progress::SetQuiet(true);
    base::Progress("blocks", 10.0, "steps").Finish();
    base::Progress::SetQuiet(false);
    lines.End(train);
  }
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "[INFO]    Running openmvs stage\n[INFO]    Finished openmvs stage\n");
  const std::vector<std::string> messages = listener.Heard();
  ASSERT_GE(messages.size(), 2U);
  double before = 0.0;
  for (const std::string& message : messages) {
    const std::string head = "PGUP/" + std::to_string(getpid()) + "/0b1c-uuid/";
    ASSERT_TRUE(message.starts_with(head)) << message;
    const double percent = std::stod(message.substr(head.size()));
    EXPECT_GE(percent, before);
    before = percent;
  }
  EXPECT_NEAR(before, train.progress_to, 0.01);
}

}  // namespace
}  // namespace skyquilt::odm
