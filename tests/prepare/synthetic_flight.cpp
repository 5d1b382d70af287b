#include "tests/prepare/synthetic_flight.h"

#include <cmath>

#include "core/geo/enu_frame.h"
#include "core/image/image.h"

namespace skyquilt::test {

Flight MakeFlight(const geo::Geodetic& origin) {
  Flight flight;
  flight.origin = origin;
  flight.model_from_enu = {0.07, Eigen::Quaterniond(0.6, -0.3, 0.5, 0.2).normalized(), Eigen::Vector3d(3.0, -2.0, 1.0)};
  flight.model.cameras[1] = {camera::CameraModel::kPinhole, 64, 48, {60.0, 60.0, 32.0, 24.0}};
  // Looking straight down with the upper edge to the north.
  const Eigen::Quaterniond cam_from_enu(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()));
  const Eigen::Quaterniond model_from_enu = flight.model_from_enu.rotation;
  for (int i = 0; i < 20; ++i) {
    FlightPhoto photo;
    const int row = i / 5;
    photo.name = "photo_" + std::string(i < 10 ? "0" : "") + std::to_string(i) + ".jpg";
    photo.centre_in_enu = Eigen::Vector3d(20.0 * (i % 5 - 2), 25.0 * (row - 1.5), kFlightHeight_m + 3.0 * std::sin(i));
    photo.tags.relative_altitude_m = kFlightHeight_m;
    photo.tags.capture_time_s = 1466699519.0 + 5.0 * i;
    photo.tags.exposure = {0.002, 2.8, 100.0};
    survey::ColmapImage image;
    image.id = static_cast<uint32_t>(i + 1);
    image.camera_id = 1;
    image.name = photo.name;
    image.cam_from_world.rotation = cam_from_enu * model_from_enu.conjugate();
    image.cam_from_world.translation = -(image.cam_from_world.rotation * (flight.model_from_enu * photo.centre_in_enu));
    flight.model.images.push_back(image);
    flight.photos.push_back(photo);
  }
  uint64_t id = 1;
  for (int x = -70; x <= 70; x += 4) {
    for (int y = -70; y <= 70; y += 4) {
      survey::ColmapPoint point;
      point.id = id++;
      point.x_in_world = flight.model_from_enu * Eigen::Vector3d(x, y, std::sin(0.1 * x));
      point.rgb = {90, 120, 60};
      point.error_px = 0.4;
      point.image_ids = {1, 2, 3};
      flight.model.points.push_back(point);
    }
  }
  SetTags(flight, [](size_t, const Eigen::Vector3d& centre) { return centre; });
  return flight;
}

void SetTags(Flight& flight, const std::function<Eigen::Vector3d(size_t, const Eigen::Vector3d&)>& tag) {
  const geo::EnuFrame frame(flight.origin);
  for (size_t i = 0; i < flight.photos.size(); ++i) {
    FlightPhoto& photo = flight.photos[i];
    photo.tags.gps = frame.GeodeticFromEnu(tag(i, photo.centre_in_enu));
    photo.tags.absolute_altitude_m = photo.tags.gps->height_m;
  }
}

void WriteFlight(const Flight& flight, const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder / "images");
  const image::Image8 pixels(64, 48, 3, 100);
  for (const FlightPhoto& photo : flight.photos) {
    const std::filesystem::path file = folder / "images" / photo.name;
    std::filesystem::create_directories(file.parent_path());
    image::SaveJpeg(pixels, file, 90);
    survey::WritePhotoTags(photo.tags, file);
  }
  survey::WriteColmapText(flight.model, folder / "sparse" / "0");
}

}  // namespace skyquilt::test
