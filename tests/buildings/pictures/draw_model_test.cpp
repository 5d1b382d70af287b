#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "buildings/classes/solid_edges.h"
#include "buildings/pictures/building_pictures.h"
#include "buildings/pictures/line_layer.h"
#include "buildings/pictures/model_view.h"
#include "tests/buildings/pictures/made_cameras.h"
#include "tests/buildings/sample_buildings.h"

namespace skyquilt::buildings {
namespace {

const Eigen::Vector3d kMiddle(26.0, 34.0, 103.0);  // of the default house

HousePlan Plan(RoofKind roof, double yaw = 0.0) {
  HousePlan plan;
  plan.roof = roof;
  plan.yaw_rad = yaw;
  plan.origin = kMiddle.head<2>() - Eigen::Rotation2Dd(yaw) * Eigen::Vector2d(6.0, 4.0);
  return plan;
}

int Luminance(const uint8_t* rgb) {
  return (2 * rgb[0] + 5 * rgb[1] + rgb[2]) / 8;
}

double DistanceTo(const ViewedPiece& piece, const Eigen::Vector2d& x) {
  double nearest = 1e9;
  for (size_t i = 1; i < piece.points.size(); ++i) {
    const Eigen::Vector2d &a = piece.points[i - 1], along = piece.points[i] - a;
    const double t = along.squaredNorm() > 0.0 ? std::clamp((x - a).dot(along) / along.squaredNorm(), 0.0, 1.0) : 0.0;
    nearest = std::min(nearest, (x - a - t * along).norm());
  }
  return nearest;
}

struct Drawing {
  Building building;
  camera::Camera camera;
  geo::Rigid3d pose;
  image::Image8 picture, drawn;
  PhotoPart part;

  Drawing(Building one, const camera::Camera& lens, uint8_t grey)
      : building(std::move(one)),
        camera(lens),
        pose(LookingAt({8.0, 8.0, 125.0}, kMiddle)),
        picture(lens.width, lens.height, 3, grey),
        part(PartAround(building, camera, pose)) {
    drawn = DrawModel(building, picture, camera, pose, part);
  }
  Eigen::Vector2d PixelOf(const Eigen::Vector3d& x) const { return *camera.ImgFromCam(pose * x) - Eigen::Vector2d(part.left, part.top); }
  const uint8_t* At(const Eigen::Vector2d& pixel) const { return drawn.At(static_cast<int>(pixel.x()), static_cast<int>(pixel.y())); }
  // On the house's axes, as sample_buildings has them.
  Eigen::Vector3d Place(double u, double v, double z) const {
    const Eigen::Vector2d enu = EnuOf(building.shape, {u, v});
    return {enu.x(), enu.y(), z};
  }
};

// All edges of a box seen from above a corner: three at the far lower corner are behind it.
TEST(ViewEdges, ABoxHidesThreeOfItsEdges) {
  for (int i = 0; i < 16; ++i) {
    const double angle = 0.2 + 0.37 * i;
    const Eigen::Vector3d eye = kMiddle + Eigen::Vector3d(30.0 * std::cos(angle), 30.0 * std::sin(angle), 25.0);
    const Building house = MadeHouse(Plan(RoofKind::kFlat, 0.05));
    const auto pieces = ViewEdges(house.lod22, Pinhole(), LookingAt(eye, kMiddle));
    // From in front of a wall its opposite ones are hidden with the sides: one wall and the deck are seen.
    const Eigen::Vector2d side = (Eigen::Rotation2Dd(-0.05) * (eye - kMiddle).head<2>()).cwiseAbs() - Eigen::Vector2d(6.0, 4.0);
    const int walls_seen = (side.x() > 0.0 ? 1 : 0) + (side.y() > 0.0 ? 1 : 0);
    ASSERT_EQ(pieces.size(), 12U);
    const auto hidden = std::count_if(pieces.begin(), pieces.end(), [](const ViewedPiece& piece) { return piece.hidden; });
    EXPECT_EQ(hidden, walls_seen == 2 ? 3 : 5) << angle;
    EXPECT_EQ(std::count_if(pieces.begin(), pieces.end(), [](const ViewedPiece& piece) { return piece.roof; }), 4);
  }
}

TEST(ViewEdges, AnEdgeBehindAnotherPartIsHiddenWhereItIsBehindIt) {
  HousePlan plan = Plan(RoofKind::kFlat);
  plan.length_m = 16.0;
  plan.width_m = 14.0;
  const Building house = MadeCourtyard(plan);
  const auto pieces = ViewEdges(house.lod22, Pinhole(), LookingAt({28.0, 5.0, 117.0}, {28.0, 37.0, 103.0}));
  // The courtyard's far wall (v = 11): its top is seen, its foot is behind the near wing.
  bool top_seen = false, foot_hidden = true;
  const camera::Camera camera = Pinhole();
  const geo::Rigid3d pose = LookingAt({28.0, 5.0, 117.0}, {28.0, 37.0, 103.0});
  const auto pixel = [&](double z) {
    const Eigen::Vector2d enu = EnuOf(house.shape, {8.0, 11.0});
    return *camera.ImgFromCam(pose * Eigen::Vector3d(enu.x(), enu.y(), z));
  };
  for (const ViewedPiece& piece : pieces) {
    if (DistanceTo(piece, pixel(plan.eave_z)) < 0.5) top_seen |= !piece.hidden;
    if (DistanceTo(piece, pixel(plan.ground_z)) < 0.5) foot_hidden &= piece.hidden;
  }
  EXPECT_TRUE(top_seen);
  EXPECT_TRUE(foot_hidden);
  // The vertical edges of that wall are seen above the near wing's deck only: pieces of both kinds that join.
  EXPECT_GT(pieces.size(), EdgesOf(house.lod22).size());
}

TEST(ViewEdges, CoplanarFacesHaveNoEdgeAndBehindTheCameraIsNothing) {
  Building house = MadeHouse(Plan(RoofKind::kFlat));
  Solid& solid = house.lod22;
  const auto roof = std::find_if(solid.face.begin(), solid.face.end(), [](const Face& face) { return face.kind == FaceKind::kRoof; });
  const Face second{FaceKind::kRoof, {roof->outer[0], roof->outer[2], roof->outer[3]}, {}};
  roof->outer.pop_back();
  solid.face.push_back(second);
  EXPECT_EQ(ViewEdges(solid, Pinhole(), LookingAt({8.0, 8.0, 125.0}, kMiddle)).size(), 12U);
  EXPECT_TRUE(ViewEdges(solid, Pinhole(), LookingAt({8.0, 8.0, 125.0}, {-20.0, -20.0, 125.0})).empty());
  EXPECT_TRUE(ViewEdges(Solid{}, Pinhole(), LookingAt({8.0, 8.0, 125.0}, kMiddle)).empty());
}

TEST(DrawModel, FrontCornersAreDrawnAndNothingElseChanges) {
  for (const camera::Camera& camera : {Pinhole(), Barrel()}) {
    const Drawing drawing(MadeHouse(Plan(RoofKind::kGable, 0.3)), camera, 128);
    ASSERT_EQ(drawing.drawn.width, drawing.part.width);
    ASSERT_EQ(drawing.drawn.height, drawing.part.height);
    // The corners of the front: eaves, ridge and foot of the wall.
    for (const Eigen::Vector3d& x : {drawing.Place(0, 0, 105), drawing.Place(12, 0, 105), drawing.Place(0, 4, 108), drawing.Place(0, 0, 100)})
      EXPECT_GT(Luminance(drawing.At(drawing.PixelOf(x))), 170);
    const auto pieces = ViewEdges(drawing.building.lod22, camera, drawing.pose);
    int changed = 0;
    for (int y = 0; y < drawing.drawn.height; ++y) {
      for (int x = 0; x < drawing.drawn.width; ++x) {
        const uint8_t* rgb = drawing.drawn.At(x, y);
        if (rgb[0] == 128 && rgb[1] == 128 && rgb[2] == 128) continue;
        if (++changed % 5 != 0) continue;  // each costs a search among all pieces
        double nearest = 1e9;
        for (const ViewedPiece& piece : pieces)
          nearest = std::min(nearest, DistanceTo(piece, Eigen::Vector2d(drawing.part.left + x + 0.5, drawing.part.top + y + 0.5)));
        EXPECT_LT(nearest, 4.0);
      }
    }
    EXPECT_GT(changed, 1000);
  }
}

TEST(DrawModel, HiddenEdgesAreFainterThanVisibleOnes) {
  const Drawing drawing(MadeHouse(Plan(RoofKind::kFlat)), Pinhole(), 40);
  const int front = Luminance(drawing.At(drawing.PixelOf(drawing.Place(0, 0, 102)))),
            back = Luminance(drawing.At(drawing.PixelOf(drawing.Place(12, 8, 102))));
  EXPECT_GT(front, 180);
  EXPECT_GT(back, 45);
  EXPECT_LT(back, front - 40);
}

TEST(DrawModel, LinesStandOutOnSnowAndOnTar) {
  for (const uint8_t grey : {uint8_t{0}, uint8_t{255}}) {
    const Drawing drawing(MadeHouse(Plan(RoofKind::kHip)), Pinhole(), grey);
    const Eigen::Vector2d on = drawing.PixelOf(drawing.Place(6, 0, 105));
    int brightest = 0, darkest = 255;
    for (int dy = -4; dy <= 4; ++dy) {
      const int value = Luminance(drawing.At(on + Eigen::Vector2d(0, dy)));
      brightest = std::max(brightest, value);
      darkest = std::min(darkest, value);
    }
    EXPECT_GT(brightest, 180);
    EXPECT_LT(darkest, 110);
  }
}

TEST(DrawModel, EdgesBendWithTheLens) {
  const Drawing drawing(MadeHouse(Plan(RoofKind::kFlat)), Barrel(), 0);
  // A camera at its side, so that the house fills a part far from the middle.
  const geo::Rigid3d pose = LookingAt({8.0, 8.0, 125.0}, {12.0, 42.0, 103.0});
  const auto pixel = [&](double u) { return *drawing.camera.ImgFromCam(pose * drawing.Place(u, 0, 105)); };
  const Eigen::Vector2d bent = pixel(6.0), straight = 0.5 * (pixel(0.0) + pixel(12.0));
  const PhotoPart whole{0, 0, drawing.camera.width, drawing.camera.height};
  const image::Image8 drawn = DrawModel(drawing.building, drawing.picture, drawing.camera, pose, whole);
  EXPECT_GT(Luminance(drawn.At(static_cast<int>(bent.x()), static_cast<int>(bent.y()))), 150);
  // The middle of the distorted edge is where the lens puts it, off the chord; both ends are in the picture.
  EXPECT_GT((bent - straight).norm(), 3.0);
}

TEST(DrawModel, AnEmptyPartGivesAnEmptyPicture) {
  const Building house = MadeHouse(Plan(RoofKind::kFlat));
  const image::Image8 picture(600, 450, 3, 9);
  const geo::Rigid3d away = LookingAt({8.0, 8.0, 125.0}, {-20.0, -20.0, 125.0});
  EXPECT_EQ(PartAround(house, Pinhole(), away).width, 0);
  EXPECT_TRUE(DrawModel(house, picture, Pinhole(), away, PartAround(house, Pinhole(), away)).Empty());
  EXPECT_THROW(DrawModel(house, picture, Pinhole(), away, {500, 0, 200, 100}), std::logic_error);
  EXPECT_THROW(DrawModel(house, image::Image8(10, 10, 3), Pinhole(), away, {}), std::logic_error);
}

TEST(LineLayer, CoverageIsTheAreaOfTheLine) {
  // A line of width w and length l covers about w * l pixels, whatever its direction.
  for (const double angle : {0.0, 0.3, 0.8, 1.4}) {
    LineLayer layer(200, 200);
    const Eigen::Vector2d half = 80.0 * Eigen::Vector2d(std::cos(angle), std::sin(angle)), middle(100.3, 99.6);
    layer.Add(middle - half, middle, 3.0);
    layer.Add(middle, middle + half, 3.0);
    image::Image8 image(200, 200, 3);
    layer.BlendInto(&image, {255, 255, 255}, 1.0);
    double sum = 0.0;
    for (size_t i = 0; i < image.data.size(); i += 3) sum += image.data[i] / 255.0;
    EXPECT_NEAR(sum, 3.0 * 160.0 + 7.0, 12.0) << angle;  // with two half discs at the ends
  }
}

TEST(LineLayer, LinesOutsideChangeNothing) {
  LineLayer layer(50, 40);
  layer.Add({-100.0, -20.0}, {200.0, -20.0}, 3.0);
  layer.Add({1e12, 0.0}, {1e12, 40.0}, 3.0);
  layer.Add({std::nan(""), 0.0}, {10.0, 10.0}, 3.0);
  image::Image8 image(50, 40, 3, 7);
  layer.BlendInto(&image, {255, 255, 255}, 1.0);
  EXPECT_TRUE(std::all_of(image.data.begin(), image.data.end(), [](uint8_t value) { return value == 7; }));
}

}  // namespace
}  // namespace skyquilt::buildings
