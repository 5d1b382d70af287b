#include "surface/surface_options.h"

#include <gtest/gtest.h>

#include "core/base/errors.h"
#include "tests/support/error_of.h"

namespace skyquilt::surface {
namespace {

TEST(SurfaceOptions, DefaultsAreAllowed) {
  EXPECT_NO_THROW(SurfaceOptions().Check());
}

TEST(SurfaceOptions, TerrainThresholdsMustBeInOrder) {
  SurfaceOptions options;
  options.terrain_low_m = 2.0;
  options.terrain_high_m = 1.0;
  EXPECT_NE(ErrorOf<base::UsageError>([&] { options.Check(); }).find("terrain_high_m"), std::string::npos);
}

}  // namespace
}  // namespace skyquilt::surface
