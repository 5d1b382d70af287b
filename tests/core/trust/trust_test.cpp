#include "core/trust/trust.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "tests/support/error_of.h"
#include "tests/support/in_temporary_folder.h"

namespace skyquilt::trust {
namespace {

constexpr int kWidth = 8, kHeight = 6;

// Straight down on a level plane, one metre per pixel.
void RaysDown(int row, std::span<render::Ray> rays) {
  for (size_t x = 0; x < rays.size(); ++x) {
    rays[x].origin_enu = {static_cast<double>(x) + 0.5, row + 0.5, 10.0};
    rays[x].direction_enu = {0.0, 0.0, -1.0};
    rays[x].pixel_width = 1.0F;
  }
}

std::vector<render::RayColor> Plane() {
  std::vector<render::RayColor> colors(static_cast<size_t>(kWidth) * kHeight);
  for (size_t i = 0; i < colors.size(); ++i) {
    colors[i].rgb_srgb[1] = 0.05F * static_cast<float>(i % kWidth);
    colors[i].opacity = 1.0F;
    colors[i].depth = colors[i].depth_median = 9.5F;
    colors[i].depth_front = 9.0F;
    colors[i].depth_back = 11.0F;
  }
  return colors;
}

Trust SomeTrust() {
  std::vector<Sighting> sightings;
  for (int x = 0; x < kWidth / 2; ++x) {
    for (int y = 0; y < kHeight; ++y) sightings.push_back({{x + 0.5, y + 0.5, 0.5}, x % 2, 0.01F});
  }
  return {EvidenceCells(sightings, 1.0), ErrorModel(), "scene"};
}

TEST(Trust, FactsOfAPictureAreThoseOfThePlacesItShows) {
  base::ThreadPool threads(2);
  const std::vector<PixelFacts> facts = FactsOf(SomeTrust().evidence, kWidth, kHeight, Plane(), RaysDown, threads);
  ASSERT_EQ(facts.size(), 48U);
  EXPECT_TRUE(facts[0].evidence.seen);
  EXPECT_EQ(facts[0].evidence.photos, 2.0F);  // two columns, of two photos, in a cell of two metres
  EXPECT_FALSE(facts[kWidth - 1].evidence.seen);
  for (const PixelFacts& fact : facts) {
    EXPECT_NEAR(fact.gradient, 0.05F, 1e-6F);
    EXPECT_NEAR(fact.spread_pixels, 2.0F, 1e-6F);
    EXPECT_EQ(fact.opacity, 1.0F);
  }
}

TEST(Trust, PixelsWithoutASurfaceHaveNoError) {
  base::ThreadPool threads(2);
  std::vector<render::RayColor> colors = Plane();
  colors[3].depth_median = std::numeric_limits<float>::quiet_NaN();
  colors[4].opacity = 0.0F;
  const TrustPicture picture = TrustOf(SomeTrust(), kWidth, kHeight, colors, RaysDown, threads);
  for (size_t i = 0; i < colors.size(); ++i) {
    EXPECT_EQ(std::isfinite(picture.error.data[i]), i != 3 && i != 4) << i;
    if (i == 3 || i == 4) EXPECT_EQ(picture.photos.data[i], 0.0F);
  }
}

class TrustFileTest : public InTemporaryFolder {
 protected:
  TrustFileTest() { MakeScene(1); }
  void MakeScene(int64_t number) const {
    checkpoint::ArchiveWriter scene("scene", 1);
    scene.SetAttribute("number", number);
    scene.Commit(Scene());
  }
  std::filesystem::path Scene() const { return folder_ / "scene.h5"; }
  std::string ErrorOfLoading() const {
    return InputErrorOf([&] { LoadTrustOf(Scene()); });
  }
};

TEST_F(TrustFileTest, BelongsToItsScene) {
  EXPECT_NE(ErrorOfLoading().find("does not exist"), std::string::npos);
  Trust trust = SomeTrust();
  trust.scene = SceneIdentity(Scene());
  Save(trust, TrustFileOf(Scene()));
  EXPECT_EQ(LoadTrustOf(Scene()).evidence.size(), trust.evidence.size());
  MakeScene(2);
  EXPECT_NE(ErrorOfLoading().find("of another scene"), std::string::npos);
}

TEST_F(TrustFileTest, OtherAndDamagedFilesAreNamed) {
  checkpoint::ArchiveWriter block("block", 1);
  block.Commit(TrustFileOf(Scene()));
  EXPECT_NE(ErrorOfLoading().find("not a trust file"), std::string::npos);
  Save(SomeTrust(), TrustFileOf(Scene()));
  std::string bytes = base::ReadFile(TrustFileOf(Scene()));
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  base::WriteFileAtomically(TrustFileOf(Scene()), bytes);
  EXPECT_NE(ErrorOfLoading().find("trust.h5"), std::string::npos);
}

}  // namespace
}  // namespace skyquilt::trust
