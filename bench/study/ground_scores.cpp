#include "bench/study/ground_scores.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/base/order_statistics.h"
#include "core/image/image.h"
#include "core/metrics/psnr.h"
#include "evaluate/photos/scored_pixels.h"

namespace skyquilt::bench {
namespace {

double GroundBelow(const survey::Survey& survey, const survey::Photo& photo) {
  if (std::isfinite(photo.agl_m) && photo.agl_m > 0.0) return photo.cam_from_enu.OriginInSource().z() - photo.agl_m;
  std::vector<double> heights;
  heights.reserve(survey.points.size());
  for (const survey::SparsePoint& point : survey.points) heights.push_back(point.x_in_enu.z());
  return heights.empty() ? 0.0 : base::Median(std::move(heights));
}

// Index of the box that holds the ground that a pixel shows; -1: none.
int BoxAt(const std::vector<geo::BlockBox>& boxes, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double ground_z) {
  const double t = (ground_z - origin.z()) / direction.z();
  if (!(t > 0.0) || !std::isfinite(t)) return -1;
  const Eigen::Vector2d place = (origin + t * direction).head<2>();
  for (size_t i = 0; i < boxes.size(); ++i) {
    const bool inside = (place.array() >= boxes[i].min_enu.head<2>().array()).all() && (place.array() < boxes[i].max_enu.head<2>().array()).all();
    if (inside) return static_cast<int>(i);
  }
  return -1;
}

// The variant whose pictures a result has: of several seeds the first that succeeded.
std::filesystem::path CoveredFolder(const std::filesystem::path& folder, const VariantResult& result) {
  const VariantResult* training = &result;
  for (const VariantResult& seed : result.seeds) {
    if (!seed.failure.empty()) continue;
    training = &seed;
    break;
  }
  return folder / "runs" / training->name / "covered";
}

}  // namespace

std::vector<std::vector<double>> ScoreGround(const std::filesystem::path& folder, const survey::Survey& survey,
                                             const std::vector<geo::BlockBox>& boxes, const std::vector<const VariantResult*>& results) {
  std::vector<std::vector<metrics::SquaredError>> errors(results.size(), std::vector<metrics::SquaredError>(boxes.size()));
  for (const survey::Photo& photo : survey.photos) {
    if (!photo.is_test) continue;
    std::vector<image::Image8> pictures;
    std::vector<size_t> of;  // result of each picture
    for (size_t k = 0; k < results.size(); ++k) {
      const std::filesystem::path file = evaluate::photos::ScoredPixelsFile(CoveredFolder(folder, *results[k]), photo.name);
      if (!results[k]->failure.empty() || !std::filesystem::is_regular_file(file)) continue;
      image::Image8 picture = image::LoadLabels(file);
      if (!pictures.empty() && (picture.width != pictures.front().width || picture.height != pictures.front().height)) continue;
      pictures.push_back(std::move(picture));
      of.push_back(k);
    }
    if (pictures.empty()) continue;
    const camera::Camera camera = survey.cameras[static_cast<size_t>(photo.camera)].Resized(pictures.front().width, pictures.front().height);
    const Eigen::Vector3d origin = photo.cam_from_enu.OriginInSource();
    const Eigen::Quaterniond enu_from_cam = photo.cam_from_enu.rotation.conjugate();
    const double ground_z = GroundBelow(survey, photo);
    for (int y = 0; y < camera.height; ++y) {
      for (int x = 0; x < camera.width; ++x) {
        if (std::any_of(pictures.begin(), pictures.end(), [x, y](const image::Image8& picture) { return *picture.At(x, y) == 0; })) continue;
        const int box = BoxAt(boxes, origin, enu_from_cam * camera.RayFromImg({x + 0.5, y + 0.5}), ground_z);
        if (box < 0) continue;
        for (size_t k = 0; k < pictures.size(); ++k) {
          errors[of[k]][static_cast<size_t>(box)] += {evaluate::photos::SquaredErrorOf(*pictures[k].At(x, y)), 1};
        }
      }
    }
  }
  std::vector<std::vector<double>> psnr_db(results.size());
  for (size_t k = 0; k < results.size(); ++k) {
    for (const metrics::SquaredError& error : errors[k]) psnr_db[k].push_back(metrics::PsnrOf(error));
  }
  return psnr_db;
}

}  // namespace skyquilt::bench
