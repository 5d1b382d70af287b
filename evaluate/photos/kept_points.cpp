#include "evaluate/photos/kept_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/base/errors.h"
#include "core/base/order_statistics.h"
#include "core/base/random.h"
#include "core/camera/pixel_pitch.h"
#include "evaluate/photos/choose_photos.h"
#include "evaluate/photos/pixel_groups.h"

namespace skyquilt::evaluate::photos {
namespace {

constexpr double kFarGsd = 10.0;

// Held-out photos first, because they were not used either, then training photos.
std::vector<int> ChooseObservers(const survey::Survey& survey, std::span<const int32_t> observers) {
  std::vector<int> held_out, trained;
  for (const int32_t photo : observers) (survey.photos[static_cast<size_t>(photo)].is_test ? held_out : trained).push_back(photo);
  std::vector<int> chosen = SelectEvenly(held_out, kRaysPerKeptPoint);
  const int left = kRaysPerKeptPoint - static_cast<int>(chosen.size());
  if (left == 0) return chosen;  // SelectEvenly would take all
  for (const int photo : SelectEvenly(trained, left)) chosen.push_back(photo);
  return chosen;
}

// Indices of the points that can be compared, in the order of a hash.
std::vector<size_t> ComparablePoints(const survey::Survey& survey, std::span<const geo::BlockBox> boxes) {
  std::vector<size_t> points;
  for (size_t i = 0; i < survey.kept_points.size(); ++i) {
    const std::span<const int32_t> observers = survey.kept_tracks.PhotosOf(i);
    const auto trained =
        std::count_if(observers.begin(), observers.end(), [&](int32_t photo) { return !survey.photos[static_cast<size_t>(photo)].is_test; });
    if (trained >= 2 && BlockAt(survey.kept_points[i].x_in_enu, boxes) >= 0) points.push_back(i);
  }
  std::sort(points.begin(), points.end(), [](size_t a, size_t b) { return base::MixBits(a) < base::MixBits(b); });
  return points;
}

// Median, median of the absolute values, and NMAD. Errors may be infinite; a median that is infinite is not measured.
std::array<double, 3> Robust(const std::vector<double>& errors) {
  const auto finite = [](double value) { return std::isfinite(value) ? value : kNotMeasured; };
  std::vector<double> sizes, values = errors;
  sizes.reserve(errors.size());
  for (const double error : errors) sizes.push_back(std::abs(error));
  const double median = base::UpperMedian(values);
  const double median_abs = base::UpperMedian(sizes);
  if (!std::isfinite(median)) return {kNotMeasured, finite(median_abs), kNotMeasured};
  for (size_t i = 0; i < errors.size(); ++i) sizes[i] = std::abs(errors[i] - median);
  return {median, finite(median_abs), finite(base::kMadToSigma * base::UpperMedian(sizes))};
}

}  // namespace

std::vector<KeptRay> KeptRays(const survey::Survey& survey, std::span<const int> widths, std::span<const geo::BlockBox> boxes, size_t most) {
  SKYQUILT_CHECK(widths.size() == survey.photos.size(), "one width per photo");
  std::vector<camera::PixelPitch> pitches;
  for (const camera::Camera& camera : survey.cameras) pitches.emplace_back(camera);
  std::vector<KeptRay> rays;
  for (const size_t i : ComparablePoints(survey, boxes)) {
    const Eigen::Vector3d& x_in_enu = survey.kept_points[i].x_in_enu;
    const std::vector<int> observers = ChooseObservers(survey, survey.kept_tracks.PhotosOf(i));
    if (rays.size() + observers.size() > most) break;
    for (const int index : observers) {
      const survey::Photo& photo = survey.photos[static_cast<size_t>(index)];
      const auto camera_index = static_cast<size_t>(photo.camera);
      const camera::Camera& camera = survey.cameras[camera_index];
      const auto pixel = camera.ImgFromCam(photo.cam_from_enu * x_in_enu);
      if (!pixel) continue;  // the model contradicts itself here
      KeptRay kept{.point = i, .photo = index};
      kept.ray.origin_enu = photo.cam_from_enu.OriginInSource();
      const Eigen::Vector3d offset = x_in_enu - kept.ray.origin_enu;
      kept.true_m = offset.norm();
      kept.ray.direction_enu = offset / kept.true_m;
      const double pitch = pitches[camera_index].At(*pixel);
      kept.ray.pixel_pitch = static_cast<float>(pitch * camera.width / widths[static_cast<size_t>(index)]);
      kept.gsd_m = pitch * kept.true_m;
      rays.push_back(kept);
    }
  }
  return rays;
}

KeptPointErrors CompareKeptRays(std::span<const KeptRay> rays, std::span<const render::RayColor> rendered, bool georeferenced) {
  SKYQUILT_CHECK(rays.size() == rendered.size(), "one rendered ray per ray");
  KeptPointErrors result;
  if (rays.empty()) return result;
  std::vector<size_t> points;
  std::vector<double> metres, gsd;
  for (size_t i = 0; i < rays.size(); ++i) {
    const auto depth_m = static_cast<double>(rendered[i].depth_median);
    const double error_m = std::isfinite(depth_m) ? depth_m - rays[i].true_m : std::numeric_limits<double>::infinity();
    points.push_back(rays[i].point);
    metres.push_back(error_m);
    gsd.push_back(error_m / rays[i].gsd_m);
  }
  std::sort(points.begin(), points.end());
  result.points = std::unique(points.begin(), points.end()) - points.begin();
  result.rays = static_cast<int64_t>(rays.size());
  if (georeferenced) {
    const auto [median, median_abs, nmad] = Robust(metres);
    result.median_m = median;
    result.median_abs_m = median_abs;
    result.nmad_m = nmad;
  }
  const auto [median, median_abs, nmad] = Robust(gsd);
  result.median_gsd = median;
  result.median_abs_gsd = median_abs;
  result.nmad_gsd = nmad;
  const auto far = std::count_if(gsd.begin(), gsd.end(), [](double error) { return std::abs(error) > kFarGsd; });
  result.share_beyond_10_gsd = static_cast<double>(far) / static_cast<double>(gsd.size());
  return result;
}

KeptPointErrors MeasureKeptPoints(const scene::Scene& scene, const survey::Survey& survey, const image::PixelCache& pixels,
                                  std::span<const geo::BlockBox> boxes, base::ThreadPool& threads) {
  if (survey.kept_points.empty() || survey.kept_tracks.Empty()) return {};
  std::vector<int> widths;
  for (size_t i = 0; i < survey.photos.size(); ++i) widths.push_back(pixels.Width(i));
  const std::vector<KeptRay> kept = KeptRays(survey, widths, boxes, kMostKeptRays);
  std::vector<render::Ray> rays;
  for (const KeptRay& ray : kept) rays.push_back(ray.ray);
  std::vector<render::RayColor> rendered(rays.size());
  scene.RenderRays(rays, rendered, {}, threads);
  return CompareKeptRays(kept, rendered, survey.georeferenced);
}

}  // namespace skyquilt::evaluate::photos
