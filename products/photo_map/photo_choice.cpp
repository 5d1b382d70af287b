#include "products/photo_map/photo_choice.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/base/cancel.h"

namespace skyquilt::products {
namespace {

constexpr double kNearShare = 0.05;
constexpr double kSteepEnough = 0.5;  // tan^2, 35 degrees: such views count when photos are left out
constexpr double kAgain = 0.25;       // what one more view of a place is worth, of the view before

bool IsInFrame(const survey::Survey& survey, const survey::Photo& photo, const Eigen::Vector3d& place_enu) {
  const camera::Camera& camera = survey.cameras[static_cast<size_t>(photo.camera)];
  const std::optional<Eigen::Vector2d> pixel = camera.ImgFromCam(photo.cam_from_enu * place_enu);
  return pixel && pixel->x() >= 0.0 && pixel->y() >= 0.0 && pixel->x() <= camera.width && pixel->y() <= camera.height;
}

std::vector<Eigen::Vector3d> EyesOf(const survey::Survey& survey) {
  std::vector<Eigen::Vector3d> eyes;
  eyes.reserve(survey.photos.size());
  for (const survey::Photo& photo : survey.photos) eyes.push_back(photo.cam_from_enu.OriginInSource());
  return eyes;
}

}  // namespace

double ViewCost(const Eigen::Vector3d& place_enu, const Eigen::Vector3d& eye_enu, double typical_height_m) {
  const Eigen::Vector3d to_eye = eye_enu - place_enu;
  const double oblique = to_eye.head<2>().squaredNorm() / (to_eye.z() * to_eye.z());
  if (!(to_eye.z() > 0.0) || !(oblique <= kMostOblique)) return std::numeric_limits<double>::infinity();
  return oblique + kNearShare * to_eye.squaredNorm() / (typical_height_m * typical_height_m);
}

std::vector<char> ChooseFewPhotos(const survey::Survey& survey, std::span<const Eigen::Vector3d> places_enu, double max_pixels,
                                  double typical_height_m, base::ThreadPool& threads) {
  const size_t n = survey.photos.size();
  std::vector<double> pixels(n);
  double all = 0.0;
  for (size_t photo = 0; photo < n; ++photo) {
    const camera::Camera& camera = survey.cameras[static_cast<size_t>(survey.photos[photo].camera)];
    all += pixels[photo] = static_cast<double>(camera.width) * camera.height;
  }
  std::vector<char> chosen(n, all <= max_pixels ? 1 : 0);
  if (all <= max_pixels) return chosen;
  const std::vector<Eigen::Vector3d> eyes = EyesOf(survey);
  std::vector<std::vector<uint32_t>> seen(n);  // places of each photo
  threads.ParallelFor(static_cast<int64_t>(n), [&](int64_t task, int /*thread*/) {
    base::ThrowIfCancelled();
    const auto photo = static_cast<size_t>(task);
    for (size_t place = 0; place < places_enu.size(); ++place) {
      if (!(ViewCost(places_enu[place], eyes[photo], typical_height_m) <= kSteepEnough)) continue;
      if (IsInFrame(survey, survey.photos[photo], places_enu[place])) seen[photo].push_back(static_cast<uint32_t>(place));
    }
  });
  // Greedily: always the photo that adds most, where a place counts less with each photo that sees it already.
  std::vector<double> worth(places_enu.size(), 1.0);
  double left = max_pixels;
  for (;;) {
    size_t best = n;
    double most = 0.0;
    for (size_t photo = 0; photo < n; ++photo) {
      if (chosen[photo] != 0) continue;
      double gain = 1e-12;  // photos that add nothing come last
      for (const uint32_t place : seen[photo]) gain += worth[place];
      if (gain > most) {
        most = gain;
        best = photo;
      }
    }
    if (best == n || (left < max_pixels && pixels[best] > left)) return chosen;
    chosen[best] = 1;
    left -= pixels[best];
    for (const uint32_t place : seen[best]) worth[place] *= kAgain;
  }
}

}  // namespace skyquilt::products
