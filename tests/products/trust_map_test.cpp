#include "products/trust_map.h"

#include <gdal_priv.h>
#include <gtest/gtest.h>

#include "core/image/image.h"
#include "tests/products/analytic_scene.h"
#include "tests/support/in_temporary_folder.h"

namespace skyquilt::products {
namespace {

class TrustMapTest : public InTemporaryFolder {};

// Four photos show the ground east of the origin; nothing shows what is west of it, nor the house.
trust::Trust EastIsKnown(const AnalyticScene& scene) {
  std::vector<trust::Sighting> sightings;
  for (int x = 0; x < 60; ++x) {
    for (int y = -50; y < 50; ++y) {
      for (int photo = 0; photo < 4; ++photo) sightings.push_back({{x + 0.5, y + 0.5, scene.ground_z}, photo, 4e-4F});
    }
  }
  trust::Trust trust{trust::EvidenceCells(sightings, 1.0), {}, {}};
  std::vector<trust::PixelFacts> facts;
  std::vector<float> errors;
  for (int i = 0; i < 1000; ++i) {
    facts.push_back({trust.evidence.At({i % 2 == 0 ? 30.0 : -30.0, -40.0, scene.ground_z}), 1.0F, 0.0F, 0.0F});
    errors.push_back(i % 2 == 0 ? 4e-4F : 0.04F);
  }
  trust.model = trust::ErrorModel(facts, errors);
  return trust;
}

TEST_F(TrustMapTest, HasTheErrorsToExpectAndTheNumberOfPhotos) {
  AnalyticScene scene;
  scene.open_west = -40.0;
  const scene::SceneInfo info = scene.Info({46.0, 9.0, 500.0}, true);  // on the meridian of its zone: the map's axes are east and north
  base::ThreadPool threads(2);
  const std::filesystem::path file = WriteTrustMap(EastIsKnown(scene), info, scene.Caster(), ProductOptions{}, folder_.path(), threads);
  GDALAllRegister();
  GDALDataset* dataset = GDALDataset::Open(file.c_str(), GDAL_OF_RASTER);
  ASSERT_NE(dataset, nullptr);
  ASSERT_EQ(dataset->GetRasterCount(), 2);
  EXPECT_NE(dataset->GetSpatialRef(), nullptr);
  const int width = dataset->GetRasterXSize(), height = dataset->GetRasterYSize();
  EXPECT_NEAR(width, 240, 4);
  EXPECT_NEAR(height, 200, 4);
  const auto at = [&](int band, double x, double y) {
    float value = 0.0F;
    const int column = static_cast<int>((x + 60.0) / 120.0 * width), row = static_cast<int>((50.0 - y) / 100.0 * height);
    EXPECT_EQ(dataset->GetRasterBand(band)->RasterIO(GF_Read, column, row, 1, 1, &value, 1, 1, GDT_Float32, 0, 0), CE_None);
    return value;
  };
  EXPECT_NEAR(at(1, 30.0, -40.0), 0.02F, 0.004F);
  EXPECT_EQ(at(2, 30.0, -40.0), 4.0F);
  EXPECT_NEAR(at(1, -20.0, 0.0), 0.2F, 0.04F);
  EXPECT_EQ(at(2, -20.0, 0.0), 0.0F);
  EXPECT_NEAR(at(1, 25.0, -5.0), 0.2F, 0.04F) << "the roof";
  EXPECT_EQ(at(1, -50.0, 0.0), -1.0F) << "no ground";
  EXPECT_EQ(dataset->GetRasterBand(1)->GetNoDataValue(), -1.0);
  GDALClose(dataset);
  const image::Image8 picture = image::LoadRgb8(folder_ / "trust.png");
  EXPECT_NEAR(picture.width, width, 4);
  EXPECT_EQ(picture.At(5, picture.height / 2)[0], 255) << "white where there is no ground";
}

}  // namespace
}  // namespace skyquilt::products
