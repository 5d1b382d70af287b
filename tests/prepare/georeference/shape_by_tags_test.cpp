#include "prepare/georeference/shape_by_tags.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/base/random.h"

namespace skyquilt::test {
namespace {

using namespace prepare::georeference;

// A grid of photos in ENU and a geo-reference whose residuals in height have the form of a dome of so much height, with noise.
void MakeFlight(double dome_m, double noise_m, std::vector<prepare::input::PreparedPhoto>* photos, Georeference* georeference) {
  base::Random random(2, 1);
  georeference->ok = true;
  for (int i = 0; i < 64; ++i) {
    const Eigen::Vector3d centre(20.0 * (i % 8) - 70.0, 20.0 * (i / 8) - 70.0, 60.0);
    prepare::input::PreparedPhoto photo;
    photo.file.name = std::to_string(i);
    photo.cam_from_model = {Eigen::Quaterniond::Identity(), -centre};
    photo.gps = geo::Geodetic{47.0, 8.0, 560.0};
    photo.file.tags.capture_time_s = 2.0 * i;
    photos->push_back(photo);
    const double square = centre.head<2>().squaredNorm() / (90.0 * 90.0);
    georeference->photos.push_back({.residual_m = {0.0, 0.0, -dome_m * square + noise_m * random.Normal()}, .inlier = true});
  }
}

bool Tells(double dome_m, double noise_m, double rtk_share = 0.0, bool placed = true) {
  std::vector<prepare::input::PreparedPhoto> photos;
  Georeference georeference;
  MakeFlight(dome_m, noise_m, &photos, &georeference);
  georeference.ok = placed;
  for (size_t i = 0; i < photos.size(); ++i) photos[i].rtk = static_cast<double>(i) < rtk_share * static_cast<double>(photos.size());
  return TagsTellTheShape(photos, georeference);
}

TEST(TagsTellTheShape, WhenABendIsClearOrTheTagsAreRtk) {
  EXPECT_TRUE(Tells(2.0, 0.3));
  EXPECT_TRUE(Tells(-2.0, 0.3));
  EXPECT_FALSE(Tells(0.0, 0.3));
  EXPECT_FALSE(Tells(0.3, 0.01));  // nothing to bother about
  EXPECT_FALSE(Tells(1.0, 4.0));   // lost in noise
  EXPECT_TRUE(Tells(0.0, 0.3, 0.9));
  EXPECT_FALSE(Tells(0.0, 0.3, 0.3));
  EXPECT_FALSE(Tells(2.0, 0.3, 1.0, false));
}

TEST(TagsTellTheShape, NotWithoutHeights) {
  std::vector<prepare::input::PreparedPhoto> photos;
  Georeference georeference;
  MakeFlight(2.0, 0.1, &photos, &georeference);
  for (TagFit& fit : georeference.photos) fit.residual_m.z() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(TagsTellTheShape(photos, georeference));
}

}  // namespace
}  // namespace skyquilt::test
