#include "products/product_kinds.h"

#include <gtest/gtest.h>

#include "products/product_options.h"
#include "tests/support/error_of.h"

namespace skyquilt::products {
namespace {

TEST(ProductKinds, FollowHowPhotosLook) {
  EXPECT_EQ(NamesOf(KindsOf("auto", false)), "orthophoto, surface model, terrain, buildings, video");
  EXPECT_EQ(NamesOf(KindsOf("auto", true)), "elevations of walls, video along the cameras");
  for (const bool level : {false, true}) {
    EXPECT_EQ(NamesOf(KindsOf("all", level)), "orthophoto, surface model, terrain, buildings, elevations of walls, video");
    EXPECT_EQ(NamesOf(KindsOf("elevations, ortho", level)), "orthophoto, elevations of walls");
    EXPECT_EQ(NamesOf(KindsOf("buildings", level)), "terrain, buildings");
  }
  EXPECT_EQ(NamesOf({}), "nothing");
}

TEST(ProductKinds, RefuseOthers) {
  ProductOptions options;
  for (const char* kinds : {"", "ortho,", "elevation", "auto,dsm"}) {
    options.kinds = kinds;
    EXPECT_THROW(options.Check(), base::UsageError) << kinds;
  }
  const std::string error = UsageErrorOf([] { KindsOf("elevation", false); });
  EXPECT_NE(error.find("products.kinds = \"elevation\""), std::string::npos) << error;
  EXPECT_NE(error.find("did you mean \"elevations\""), std::string::npos) << error;
}

}  // namespace
}  // namespace skyquilt::products
