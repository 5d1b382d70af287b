// Which photos see a point. First all photos are projected, which is cheap; then, for the finest of them, a ray from the photo to the point shows
// whether something stands between.
//
// When the photo's ray meets a surface at depth d and the point is at distance D, the point is visible if d >= D - tolerance, where
//   tolerance = max(3 GSD, min(3 spread, D / 100)),
// GSD being the photo's there and spread the standard deviation of d. The photo's own surface differs from the one that was clicked by both; a
// surface without a sharp place, such as a tree, must not make everything behind it visible, hence the limit.
#include <algorithm>
#include <cmath>

#include "viewer/protocol/replies.h"
#include "viewer/queries/field_rays.h"

namespace skyquilt::viewer {
namespace {

constexpr size_t kMaxSights = 500;
constexpr size_t kPhotosPerStep = 1000;  // projected; about 5 ms
constexpr double kGsdTolerance = 3.0, kSpreadTolerance = 3.0, kDistanceTolerance = 0.01;
constexpr double kNearest_m = 0.01;
constexpr double kBeyond = 1.02;  // rays go on behind the point, so that its own surface is complete

// Square root of the solid angle of the pixel around a place of the picture, radians. camera::PixelPitch would cost a lattice for every camera, and
// there may be as many cameras as photos.
double PitchAt(const camera::Camera& camera, const Eigen::Vector2d& pixel) {
  const Eigen::Vector2d dx(0.5, 0.0), dy(0.0, 0.5);
  const Eigen::Vector3d across = camera.RayFromImg(pixel + dx) - camera.RayFromImg(pixel - dx);
  const Eigen::Vector3d down = camera.RayFromImg(pixel + dy) - camera.RayFromImg(pixel - dy);
  return std::sqrt(across.cross(down).norm());
}

class PhotosAtQuery : public Query {
 public:
  PhotosAtQuery(const PhotosAtRequest& request, std::shared_ptr<const survey::Survey> survey) : request_(request), survey_(std::move(survey)) {}

  bool Step(const FieldAccess& access) override {
    if (projected_ < survey_->photos.size()) {
      const size_t end = std::min(survey_->photos.size(), projected_ + kPhotosPerStep);
      for (; projected_ < end; ++projected_) Project(projected_);
      if (projected_ < survey_->photos.size()) return false;
      KeepFinest();
    }
    if (!access.main) {
      for (PhotoSight& sight : sights_) sight.visible = true;
      done_ = true;
      return true;
    }
    checked_ = true;
    tested_ = CastSome(
        access.main, access.batch, tested_, sights_.size(), [&](size_t i) { return RayTo(sights_[i]); },
        [&](size_t i, const render::RayColor& color) { sights_[i].visible = Reaches(sights_[i], color); });
    done_ = tested_ == sights_.size();
    return done_;
  }
  double fraction() const override {
    if (done_) return 1.0;
    const double projected = static_cast<double>(projected_) / std::max(1.0, static_cast<double>(survey_->photos.size()));
    return 0.5 * (projected + static_cast<double>(tested_) / std::max(1.0, static_cast<double>(sights_.size())));
  }
  std::string Reply() const override { return PhotosText(request_.id, checked_, sights_); }

 private:
  void Project(size_t index) {
    const survey::Photo& photo = survey_->photos[index];
    if (photo.camera < 0 || static_cast<size_t>(photo.camera) >= survey_->cameras.size()) return;
    const camera::Camera& camera = survey_->cameras[static_cast<size_t>(photo.camera)];
    const Eigen::Vector3d x_in_cam = photo.cam_from_enu * request_.point_enu;
    const double distance = x_in_cam.norm();
    if (!(distance > kNearest_m)) return;
    const std::optional<Eigen::Vector2d> pixel = camera.ImgFromCam(x_in_cam);
    if (!pixel || !(pixel->x() >= 0.0 && pixel->y() >= 0.0 && pixel->x() < camera.width && pixel->y() < camera.height)) return;
    const double gsd = distance * PitchAt(camera, *pixel);
    if (!std::isfinite(gsd)) return;
    sights_.push_back({.photo = static_cast<int>(index), .pixel = *pixel, .distance_m = distance, .gsd_m = gsd, .visible = false});
  }

  void KeepFinest() {
    std::stable_sort(sights_.begin(), sights_.end(), [](const PhotoSight& a, const PhotoSight& b) { return a.gsd_m < b.gsd_m; });
    if (sights_.size() > kMaxSights) sights_.resize(kMaxSights);
  }

  render::Ray RayTo(const PhotoSight& sight) const {
    const Eigen::Vector3d eye = survey_->photos[static_cast<size_t>(sight.photo)].cam_from_enu.OriginInSource();
    return {.origin_enu = eye,
            .direction_enu = (request_.point_enu - eye).normalized(),
            .t_far = kBeyond * sight.distance_m + kGsdTolerance * sight.gsd_m,
            .pixel_pitch = static_cast<float>(sight.gsd_m / sight.distance_m)};
  }

  static bool Reaches(const PhotoSight& sight, const render::RayColor& color) {
    const auto depth = static_cast<double>(color.depth_median);
    if (!std::isfinite(depth)) return true;
    const double spread = DepthSpread(color);
    const double soft = std::isfinite(spread) ? std::min(kSpreadTolerance * spread, kDistanceTolerance * sight.distance_m) : 0.0;
    return depth >= sight.distance_m - std::max(kGsdTolerance * sight.gsd_m, soft);
  }

  const PhotosAtRequest request_;
  const std::shared_ptr<const survey::Survey> survey_;
  size_t projected_ = 0;
  bool checked_ = false;
  std::vector<PhotoSight> sights_;
  size_t tested_ = 0;
  bool done_ = false;
};

}  // namespace

std::unique_ptr<Query> MakePhotosAt(const PhotosAtRequest& request, std::shared_ptr<const survey::Survey> survey) {
  if (survey == nullptr) throw BadMessage("the survey of this project cannot be read, so its photos are not known");
  return std::make_unique<PhotosAtQuery>(request, std::move(survey));
}

}  // namespace skyquilt::viewer
