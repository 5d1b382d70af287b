#include "prepare/control/fit/mark_reading.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/base/random.h"
#include "core/survey/orientation.h"

namespace skyquilt::prepare::control {
namespace {

using Eigen::Vector3d;

constexpr int kTurnedBy180 = 3;
const Eigen::Vector2i kPhotoSize(1600, 1200);

// Photos straight down in three strips, flown there and back, and marks of eight points of the ground, as they are in the stored photos.
struct Nadir {
  survey::ColmapModel model;
  survey::ColmapObservations no_ties;
  std::vector<input::PreparedPhoto> photos;
  ControlPoints control;

  Nadir() {
    model.cameras[1] = {camera::CameraModel::kPinhole, kPhotoSize.x(), kPhotoSize.y(), {1600.0, 1600.0, 800.0, 600.0}};
    for (int i = 0; i < 12; ++i) {
      const int strip = i / 4;
      const Vector3d centre(15.0 * (i % 4), 12.0 * strip, 60.0);
      const Eigen::Quaterniond down(Eigen::AngleAxisd(std::numbers::pi, Vector3d::UnitX()));
      const Eigen::Quaterniond heading(Eigen::AngleAxisd(strip % 2 == 0 ? 0.0 : std::numbers::pi, Vector3d::UnitZ()));
      const Eigen::Quaterniond rotation = down * heading;
      survey::ColmapImage image;
      image.id = static_cast<uint32_t>(i + 1);
      image.camera_id = 1;
      image.name = "photo_" + std::to_string(i) + ".jpg";
      image.cam_from_world = {rotation, -(rotation * centre)};
      photos.push_back(input::PreparePhoto({.name = image.name}, static_cast<size_t>(i), image.cam_from_world));
      model.images.push_back(image);
    }
    base::Random random(5);
    for (int p = 0; p < 8; ++p) {
      ControlPoint point;
      point.label = "P" + std::to_string(p);
      const double up = random.Uniform(-2.0, 2.0), north = random.Uniform(0.0, 24.0), east = random.Uniform(0.0, 45.0);
      for (const survey::ColmapImage& image : model.images) {
        const auto pixel = model.cameras[1].ImgFromCam(image.cam_from_world * Vector3d(east, north, up));
        const double noise_x = random.Normal(), noise_y = random.Normal();
        if (!pixel || pixel->x() < 20.0 || pixel->y() < 20.0 || pixel->x() > 1580.0 || pixel->y() > 1180.0) continue;
        point.marks.push_back({image.name, *pixel + Eigen::Vector2d(noise_x, noise_y), 1});
      }
      control.points.push_back(point);
    }
  }
  // Opens the marks in every `every`-th photo; `upright`: they were made in upright photos.
  void Turn(int orientation, size_t every, bool upright) {
    for (ControlPoint& point : control.points) {
      for (ControlMark& mark : point.marks) {
        const size_t photo = std::stoul(mark.photo.substr(6));
        if (photo % every != 0) continue;
        const Eigen::Vector2d stored = mark.pixel;
        if (upright) mark.pixel = survey::UprightFromStored(stored, kPhotoSize, orientation);
        mark.if_upright = survey::StoredFromUpright(mark.pixel, kPhotoSize, orientation);
      }
    }
  }
  ReadingVotes Votes() { return CountReadings({.model = model, .observations = no_ties, .photos = photos, .control = control}); }
};

double FarthestFrom(const ControlPoints& a, const ControlPoints& b) {
  double farthest = 0.0;
  for (size_t i = 0; i < a.points.size(); ++i) {
    for (size_t k = 0; k < a.points[i].marks.size(); ++k) {
      farthest = std::max(farthest, (a.points[i].marks[k].pixel - b.points[i].marks[k].pixel).norm());
    }
  }
  return farthest;
}

// Marks of photos straight down that are turned by 180 degrees meet in points above the cameras: they must not count as agreeing.
TEST(MarkReading, TellsMarksOfUprightPhotosFromThoseOfStoredOnes) {
  for (const int orientation : {2, kTurnedBy180, 4}) {
    for (const size_t every : {1U, 2U}) {
      for (const bool upright : {false, true}) {
        Nadir made;
        const ControlPoints truth = made.control;
        made.Turn(orientation, every, upright);
        const ReadingVotes votes = made.Votes();
        EXPECT_GT(votes.n_open, 10U);
        EXPECT_EQ(votes.Reading(), upright ? MarkReading::kUpright : MarkReading::kStored)
            << orientation << " " << every << ": " << votes.n_stored << " " << votes.n_upright;
        Settle(votes.Reading(), made.control);
        EXPECT_LT(FarthestFrom(made.control, truth), 1e-9);
        for (const ControlPoint& point : made.control.points) {
          for (const ControlMark& mark : point.marks) EXPECT_FALSE(mark.if_upright);
        }
      }
    }
  }
}

TEST(MarkReading, IsUndecidedWithoutPosesAndKeepsTheMarks) {
  Nadir made;
  made.Turn(kTurnedBy180, 1, true);
  const ControlPoints written = made.control;
  made.photos.clear();
  const ReadingVotes votes = made.Votes();
  EXPECT_EQ(votes.n_stored, 0U);
  EXPECT_EQ(votes.n_upright, 0U);
  EXPECT_EQ(votes.Reading(), MarkReading::kUndecided);
  Settle(votes.Reading(), made.control);
  EXPECT_EQ(FarthestFrom(made.control, written), 0.0);
}

TEST(MarkReading, HasNothingToDecideWithoutTurnedPhotos) {
  Nadir made;
  EXPECT_EQ(made.Votes().n_open, 0U);
}

}  // namespace
}  // namespace skyquilt::prepare::control
