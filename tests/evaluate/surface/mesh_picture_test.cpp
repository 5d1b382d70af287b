#include "evaluate/surface/mesh_picture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>

#include "core/base/errors.h"
#include "evaluate/surface/photo_errors.h"
#include "surface/tile_store.h"
#include "tests/evaluate/photos/nadir_view.h"
#include "tests/evaluate/surface/surface_sample.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::evaluate::surface {
namespace {

constexpr int kPictureWidth = 100, kPictureHeight = 80;

// Four colours: red and green in the north, blue and white in the south.
std::vector<uint8_t> FourColors() {
  image::Image8 texture(64, 64, 3);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      const bool east = x >= 32, south = y >= 32;
      uint8_t* rgb = texture.At(x, y);
      rgb[0] = south == east ? 255 : 0;
      rgb[1] = east ? 255 : 0;
      rgb[2] = south ? 255 : 0;
    }
  }
  return image::EncodeJpeg(texture, 95);
}

skyquilt::surface::TexturedTile PaintedTile(const Plate& plate, std::vector<uint8_t> jpeg) {
  skyquilt::surface::TexturedTile tile = PlateTile(plate);
  tile.atlas_jpeg = std::move(jpeg);
  tile.atlas_width = tile.atlas_height = 64;
  return tile;
}

// The frame of a camera at 40 m is 40 m x 32 m.
constexpr Plate kFrame{-20, -16, 20, 16, 0.0}, kWest{-20, -16, 0, 16, 0.0}, kEast{0, -16, 20, 16, 0.0};

void ExpectColor(const SurfacePicture& picture, int x, int y, const Eigen::Vector3f& color) {
  const size_t i = static_cast<size_t>(y) * kPictureWidth + static_cast<size_t>(x);
  EXPECT_EQ(picture.has_mesh[i], 1);
  EXPECT_EQ(picture.colors[i].opacity, 1.0F);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(picture.colors[i].rgb_srgb[c], color[c], 0.05F) << x << " " << y << " " << c;
}

TEST(SurfacePainter, ShowsTheTextureWhereItIs) {
  base::ThreadPool threads(2);
  const SurfaceMesh mesh({PaintedTile(kFrame, FourColors())});
  const photos::TrainingView view = photos::NadirView(0, 0, 40);
  const SurfacePicture picture = SurfacePainter(mesh).Paint(view.camera, view.cam_from_enu, threads);
  ASSERT_EQ(picture.colors.size(), static_cast<size_t>(kPictureWidth) * kPictureHeight);
  for (const int x : {3, 40}) {
    ExpectColor(picture, x, 30, {1, 0, 0});
    ExpectColor(picture, x + 56, 30, {0, 1, 0});
    ExpectColor(picture, x, 50, {0, 0, 1});
    ExpectColor(picture, x + 56, 50, {1, 1, 1});
  }
}

TEST(SurfacePainter, TexturesThatStayInTheirFilesLookTheSame) {
  const TemporaryFolder folder;
  base::ThreadPool threads(2);
  std::vector<skyquilt::surface::TexturedTile> tiles = {PaintedTile(kWest, FourColors()), PlateTile(kEast)};  // the eastern one has no texture
  for (skyquilt::surface::TexturedTile& tile : tiles) {
    const size_t n = tile.position.size();
    tile.normal.resize(n, Eigen::Vector3f::UnitZ());
    tile.uv.resize(n, Eigen::Vector2f::Zero());
    tile.views.resize(n, 3);
    tile.filled.resize(n, 0);
  }
  std::vector<std::filesystem::path> files;
  for (size_t i = 0; i < tiles.size(); ++i) {
    files.push_back(folder / (std::to_string(i) + ".bin"));
    skyquilt::surface::SaveBakedTile({tiles[i], {}}, files.back());
  }
  const SurfaceMesh kept(tiles), read = SurfaceMesh::FromFiles(files);
  EXPECT_TRUE(read.atlas[0].jpeg.empty());
  EXPECT_TRUE(read.HasTexture(0));
  EXPECT_FALSE(read.HasTexture(1));
  EXPECT_EQ(read.JpegOf(0), kept.JpegOf(0));
  const photos::TrainingView view = photos::NadirView(0, 0, 40);
  const SurfacePicture a = SurfacePainter(kept).Paint(view.camera, view.cam_from_enu, threads);
  const SurfacePicture b = SurfacePainter(read).Paint(view.camera, view.cam_from_enu, threads);
  EXPECT_EQ(a.has_mesh, b.has_mesh);
  for (size_t i = 0; i < a.colors.size(); ++i) {
    for (size_t c = 0; c < 3; ++c) ASSERT_EQ(a.colors[i].rgb_srgb[c], b.colors[i].rgb_srgb[c]) << i;
  }
  std::filesystem::remove(files[0]);
  EXPECT_THROW(read.JpegOf(0), base::InputError);
}

TEST(SurfacePainter, ColorsBetweenTwoPixelsAreInterpolated) {
  base::ThreadPool threads(1);
  image::Image8 grey(2, 1, 3, 0);
  for (int c = 0; c < 3; ++c) grey.At(1, 0)[c] = 200;
  const SurfaceMesh mesh({PaintedTile(kFrame, image::EncodeJpeg(grey, 100))});
  const photos::TrainingView view = photos::NadirView(0, 0, 40);
  const SurfacePicture picture = SurfacePainter(mesh).Paint(view.camera, view.cam_from_enu, threads);
  for (const int x : {0, 20, 40, 50, 60, 80, 99}) {
    const double share = std::clamp(2.0 * (x + 0.5) / kPictureWidth - 0.5, 0.0, 1.0);
    EXPECT_NEAR(picture.colors[static_cast<size_t>(x)].rgb_srgb[1], share * 200.0 / 255.0, 0.01) << x;
  }
}

TEST(SurfacePainter, TheNearestSurfaceHidesTheOthers) {
  base::ThreadPool threads(2);
  image::Image8 grey(64, 64, 3, 128);
  const SurfaceMesh mesh({PaintedTile(kFrame, FourColors()), PaintedTile({0, -16, 20, 16, 5.0}, image::EncodeJpeg(grey, 95))});
  const photos::TrainingView view = photos::NadirView(0, 0, 40);
  const SurfacePicture picture = SurfacePainter(mesh).Paint(view.camera, view.cam_from_enu, threads);
  ExpectColor(picture, 20, 30, {1, 0, 0});
  ExpectColor(picture, 70, 30, {0.5F, 0.5F, 0.5F});
}

TEST(SurfacePainter, NothingIsSeenBesideTheMesh) {
  base::ThreadPool threads(2);
  const photos::TrainingView view = photos::NadirView(0, 0, 40);
  const SurfaceMesh mesh({PaintedTile(kWest, FourColors()), PlateTile(kEast)});  // the eastern tile has no texture
  const SurfacePicture picture = SurfacePainter(mesh).Paint(view.camera, view.cam_from_enu, threads);
  for (int x = 0; x < kPictureWidth; ++x) {
    const size_t i = static_cast<size_t>(10 * kPictureWidth + x);
    EXPECT_EQ(picture.has_mesh[i], x < 50 ? 1 : 0);
    EXPECT_EQ(picture.colors[i].opacity, x < 50 ? 1.0F : 0.0F);
  }
  const SurfaceMesh none;
  EXPECT_EQ(SurfacePainter(none).Paint(view.camera, view.cam_from_enu, threads).has_mesh, std::vector<uint8_t>(kPictureWidth * kPictureHeight, 0));
}

TEST(SurfacePainter, DoesNotDependOnTheCacheOrTheThreads) {
  base::ThreadPool one(1), three(3);
  std::vector<skyquilt::surface::TexturedTile> tiles;
  for (int i = 0; i < 8; ++i) tiles.push_back(PaintedTile({-20.0 + 5 * i, -16, -15.0 + 5 * i, 16, 0.1 * i}, FourColors()));
  const SurfaceMesh mesh(tiles);
  SurfacePainter small(mesh, 1), large(mesh);
  const photos::TrainingView view = photos::NadirView(2, 1, 40);
  for (int i = 0; i < 2; ++i) {
    const SurfacePicture a = small.Paint(view.camera, view.cam_from_enu, three), b = large.Paint(view.camera, view.cam_from_enu, one);
    EXPECT_EQ(a.has_mesh, b.has_mesh);
    for (size_t p = 0; p < a.colors.size(); ++p) ASSERT_EQ(a.colors[p].rgb_srgb[0], b.colors[p].rgb_srgb[0]);
  }
}

// A photo of one grey; the western half of the mesh is 10 too dark, the eastern half has none; the field is 20 too bright.
struct ComparedPhoto {
  photos::HeldOutPhoto task;
  photos::PhotoResult findings;
  SurfacePicture picture;

  ComparedPhoto() {
    task.photo = image::Image8(kPictureWidth, kPictureHeight, 3, 100);
    findings.scored = image::Image8(kPictureWidth, kPictureHeight, 1, 1);
    findings.render = image::Image8(kPictureWidth, kPictureHeight, 3, 120);
    findings.score.psnr_db = 22.0;
    picture.colors.resize(static_cast<size_t>(kPictureWidth) * kPictureHeight);
    picture.has_mesh.assign(picture.colors.size(), 0);
    for (size_t i = 0; i < picture.colors.size(); ++i) {
      if (i % kPictureWidth >= kPictureWidth / 2) continue;
      picture.has_mesh[i] = 1;
      for (float& c : picture.colors[i].rgb_srgb) c = 90.0F / 255.0F;
    }
  }
};

double PsnrOfDifference(double difference) {
  return -20.0 * std::log10(difference / 255.0);
}

TEST(SurfacePhotoErrors, MissingMeshIsBlackAndCounted) {
  ComparedPhoto photo;
  SurfacePhotoErrors errors;
  const image::Image8 shown = errors.Add(photo.task, photo.findings, photo.picture);
  EXPECT_EQ(*shown.At(0, 0), 90);
  EXPECT_EQ(*shown.At(kPictureWidth - 1, 0), 0);
  SurfaceScores scores;
  errors.Fill(&scores);
  EXPECT_EQ(scores.pixels, kPictureWidth * kPictureHeight);
  EXPECT_DOUBLE_EQ(scores.missing_share, 0.5);
  EXPECT_NEAR(scores.psnr, PsnrOfDifference(std::sqrt(0.5 * 100 + 0.5 * 10000)), 1e-3);
  EXPECT_NEAR(scores.psnr_where_mesh, PsnrOfDifference(10), 1e-3);
  EXPECT_NEAR(scores.psnr_field_where_mesh, PsnrOfDifference(20), 1e-3);
  EXPECT_EQ(scores.psnr_field, 22.0);
  EXPECT_TRUE(scores.classes.empty());
}

TEST(SurfacePhotoErrors, OnlyScoredPixelsCountAndClassesArePooled) {
  ComparedPhoto photo;
  photo.findings.true_class = image::Image8(kPictureWidth, kPictureHeight, 1, static_cast<uint8_t>(survey::SurfaceClass::kRoad));
  for (int y = 0; y < kPictureHeight; ++y) {
    for (int x = 0; x < kPictureWidth; ++x) {
      if (x >= 75) *photo.findings.scored.At(x, y) = 0;
      if (x < 25) *photo.findings.true_class.At(x, y) = static_cast<uint8_t>(survey::SurfaceClass::kRoof);
    }
  }
  SurfacePhotoErrors errors;
  errors.Add(photo.task, photo.findings, photo.picture);
  errors.Add(photo.task, photo.findings, photo.picture);
  SurfaceScores scores;
  errors.Fill(&scores);
  EXPECT_NEAR(scores.missing_share, 1.0 / 3.0, 1e-12);
  ASSERT_EQ(scores.classes.size(), 5U);
  const SurfaceClassScore &roof = scores.classes[0], &ground = scores.classes[2], &road = scores.classes[3], &tree = scores.classes[4];
  EXPECT_EQ(roof.name, "roof");
  EXPECT_EQ(roof.pixels, 2 * 25 * kPictureHeight);
  EXPECT_EQ(roof.missing_pixels, 0);
  EXPECT_NEAR(roof.psnr_db, PsnrOfDifference(10), 1e-3);
  EXPECT_EQ(ground.name, "ground");
  EXPECT_EQ(ground.pixels, 2 * 50 * kPictureHeight);
  EXPECT_EQ(ground.missing_pixels, 2 * 25 * kPictureHeight);
  EXPECT_NEAR(road.psnr_field_db, PsnrOfDifference(20), 1e-3);
  EXPECT_TRUE(std::isnan(tree.psnr_db));
}

}  // namespace
}  // namespace skyquilt::evaluate::surface
