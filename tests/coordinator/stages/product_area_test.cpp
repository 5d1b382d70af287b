#include "coordinator/stages/product_area.h"

#include <gtest/gtest.h>

#include "core/gis/boundary.h"
#include "core/gis/map_projection.h"
#include "core/survey/made_masks.h"
#include "core/survey/survey.h"
#include "tests/support/connect_alone.h"
#include "tests/support/nadir_photo.h"
#include "tests/support/project_fixture.h"

namespace skyquilt::coordinator {
namespace {

class ProductArea : public ProjectFixture {
 protected:
  void SetUp() override {
    survey_.origin = {47.5, 8.6, 400.0};
    survey_.georeferenced = true;
    survey_.cameras.push_back({camera::CameraModel::kPinhole, 120, 90, {120.0, 120.0, 60.0, 45.0}});
    for (int i = 0; i < 3; ++i) survey_.photos.push_back(NadirPhoto({30.0 * i, 0.0, 60.0}, std::to_string(i) + ".jpg"));
    for (int i = 0; i < 8; ++i) survey_.points.push_back({.x_in_enu = {10.0 * i, 5.0 * (i % 3), 0.0}});
    survey::SaveSurvey(survey_, project_.SurveyFolder());
  }
  void IgnoreGround() {
    survey::MadeMasks masks{.ground = "lake.geojson", .ground_rings = {{{10, 10}, {20, 10}, {20, 20}, {10, 20}}}};
    for (const survey::Photo& photo : survey_.photos) masks.photos.push_back({.photo = photo.name});
    std::filesystem::create_directories(survey::MadeMasksFolder(project_.SurveyFolder()));
    survey::SaveMadeMasks(masks, project_.SurveyFolder());
  }
  // Whether products cover the place.
  static bool Covers(const std::string& boundary, const survey::Survey& survey, double x, double y) {
    gis::MapGrid grid;
    grid.georeferenced = true;
    grid.zone = geo::UtmZoneOf(survey.origin);
    const gis::MapProjection projection(survey.origin, grid);
    return gis::Boundary::Read(boundary, true, grid.zone).Contains(projection.EastingNorthing({x, y, 0.0}));
  }
  survey::Survey survey_;
};

TEST_F(ProductArea, LeavesIgnoredGroundOut) {
  const auto comm = comm::ConnectAlone();
  Pipeline pipeline{.comm = *comm, .project = project_, .settings = {}};
  pipeline.settings.products.resolution_m = 0.25;
  EXPECT_EQ(OptionsOfProducts(pipeline).boundary, "");
  IgnoreGround();
  const products::ProductOptions options = OptionsOfProducts(pipeline);
  EXPECT_EQ(options.resolution_m, 0.25);
  EXPECT_FALSE(Covers(options.boundary, survey_, 15.0, 15.0));
  for (const Eigen::Vector2d& at : {Eigen::Vector2d(15.0, 9.9), {15.0, 20.1}, {60.0, 0.0}, {-150.0, 150.0}}) {
    EXPECT_TRUE(Covers(options.boundary, survey_, at.x(), at.y())) << at.transpose();
  }
}

TEST_F(ProductArea, IsLimitedByTheBoundaryToo) {
  const auto comm = comm::ConnectAlone();
  Pipeline pipeline{.comm = *comm, .project = project_, .settings = {}};
  IgnoreGround();
  // What products cover without a boundary, given as one, and cut once more.
  Touch(folder_ / "boundary.geojson", base::ReadFile(OptionsOfProducts(pipeline).boundary));
  pipeline.settings.products.boundary = (folder_ / "boundary.geojson").string();
  survey::MadeMasks masks = *survey::LoadMadeMasks(project_.SurveyFolder());
  masks.ground_rings = {{{40, -10}, {50, -10}, {50, 10}, {40, 10}}};
  survey::SaveMadeMasks(masks, project_.SurveyFolder());
  const std::string area = OptionsOfProducts(pipeline).boundary;
  EXPECT_FALSE(Covers(area, survey_, 15.0, 15.0));
  EXPECT_FALSE(Covers(area, survey_, 45.0, 0.0));
  EXPECT_TRUE(Covers(area, survey_, 55.0, 0.0));
}

}  // namespace
}  // namespace skyquilt::coordinator
