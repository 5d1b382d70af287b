// The mean absolute difference between held-out photos and the field, laid on the ground: each pixel of a photo counts where its ray meets the
// surface. Photos are compared in their display values, reduced to about 250 pixels of width as `evaluate` reduces them; pixels that their mask
// ignores and pixels without a surface are left out.
#include <algorithm>
#include <cmath>
#include <optional>

#include "core/base/cancel.h"
#include "core/image/image.h"
#include "core/scene/camera_rays.h"
#include "viewer/protocol/replies.h"
#include "viewer/queries/field_rays.h"
#include "viewer/queries/mean_map.h"
#include "viewer/queries/photo_reader.h"

namespace skyquilt::viewer {
namespace {

constexpr size_t kMaxPhotos = 200;
constexpr int kPhotoWidth = 250;
constexpr double kScaleShare = 0.95;
constexpr double kSmallestScale = 0.02;
constexpr std::chrono::milliseconds kPatience(1);  // of a step, for a photo that is being read

// A photo that is being compared.
struct Comparison {
  SmallPhoto photo;
  scene::CameraRays rays;
  std::vector<size_t> pixels;  // that count, in the order of rendering
  size_t done = 0;
};

class ErrorMapQuery : public Query {
 public:
  ErrorMapQuery(const ErrorMapRequest& request, std::shared_ptr<const survey::Survey> survey, PhotoCaster photo_caster, PublishPicture publish)
      : request_(request), survey_(std::move(survey)), caster_(std::move(photo_caster)), publish_(std::move(publish)) {
    std::vector<int> held_out;
    for (size_t i = 0; i < survey_->photos.size(); ++i) {
      if (survey_->photos[i].is_test) held_out.push_back(static_cast<int>(i));
    }
    if (held_out.empty()) throw BadMessage("this survey has no held-out photos, so its error is not known");
    result_.of_photos = static_cast<int>(held_out.size());
    const size_t n = std::min(kMaxPhotos, held_out.size());
    // The middle one of each of n equal parts.
    for (size_t i = 0; i < n; ++i) photos_.push_back(held_out[(2 * i + 1) * held_out.size() / (2 * n)]);
    RequestNext();
  }

  bool Step(const FieldAccess& access) override {
    if (!map_) Plan(access);
    if (!comparison_) {
      if (next_ == photos_.size()) {
        Finish();
        return true;
      }
      base::ThrowIfCancelled();
      if (!reading_->WaitFor(kPatience)) return false;
      Begin(reading_->Take());
      if (!comparison_) return false;
    }
    Compare(access.batch);
    return false;
  }
  double fraction() const override {
    double done = static_cast<double>(next_);
    if (comparison_) {
      const auto pixels = std::max<size_t>(1, comparison_->pixels.size());
      done += static_cast<double>(comparison_->done) / static_cast<double>(pixels) - 1.0;
    }
    return done / static_cast<double>(photos_.size());
  }
  std::string Reply() const override { return ErrorMapText(request_.id, result_); }

 private:
  const survey::Photo& PhotoAt(size_t index) const { return survey_->photos[static_cast<size_t>(photos_[index])]; }

  camera::Camera CameraAt(size_t index) const {
    const camera::Camera& camera = survey_->cameras.at(static_cast<size_t>(PhotoAt(index).camera));
    const int width = std::min(kPhotoWidth, camera.width);
    return camera.Resized(width, image::ScaledHeight(camera.width, camera.height, width));
  }

  // One photo is read while the one before is rendered.
  void RequestNext() {
    if (next_ == photos_.size()) return;
    const survey::Photo& photo = PhotoAt(next_);
    const camera::Camera camera = CameraAt(next_);
    reading_ = PhotoReader::Instance().Read(survey_->photo_root / photo.name, photo.mask, camera.width, camera.height);
  }

  void Plan(const FieldAccess& access) {
    const Eigen::Vector2d low = access.min_enu.head<2>(), high = access.max_enu.head<2>();
    if (!low.allFinite() || !high.allFinite() || !(high.array() > low.array()).all()) throw BadMessage("the size of this scene is not known");
    // Cells that are finer than the reduced photos' pixels would often get none.
    double reduction = 1.0;
    for (size_t i = 0; i < photos_.size(); ++i) {
      const camera::Camera& camera = survey_->cameras.at(static_cast<size_t>(PhotoAt(i).camera));
      reduction = std::max(reduction, static_cast<double>(camera.width) / kPhotoWidth);
    }
    map_.emplace(low, high, reduction * GsdOf(access));
  }

  void Begin(SmallPhoto photo) {
    const size_t index = next_++;
    RequestNext();
    if (photo.rgb.Empty()) {
      if (problem_.empty()) problem_ = photo.problem;
      return;
    }
    const camera::Camera camera = CameraAt(index);
    std::vector<size_t> pixels;
    scene::AppendTilePixels(camera.width, camera.height, 0, scene::TileCount(camera.width, camera.height), &pixels);
    if (!photo.mask.Empty()) std::erase_if(pixels, [&](size_t pixel) { return photo.mask.data[pixel] == 0; });
    ++result_.photos;
    if (pixels.empty()) return;
    comparison_.emplace(Comparison{std::move(photo), scene::CameraRays(camera, PhotoAt(index).cam_from_enu, true), std::move(pixels), 0});
  }

  void Compare(size_t batch) {
    Comparison& c = *comparison_;
    const size_t count = std::min(std::max<size_t>(1, batch), c.pixels.size() - c.done);
    const std::span<const size_t> pixels = std::span<const size_t>(c.pixels).subspan(c.done, count);
    std::vector<render::Ray> rays(count);
    std::vector<render::RayColor> colors(count);
    c.rays.Make(pixels, rays);
    caster_(photos_[next_ - 1], rays, colors);
    for (size_t i = 0; i < count; ++i) {
      const auto depth = static_cast<double>(colors[i].depth_median);
      if (!std::isfinite(depth)) continue;
      const Eigen::Vector3d point = rays[i].origin_enu + depth * rays[i].direction_enu;
      const uint8_t* taken = &c.photo.rgb.data[3 * pixels[i]];
      double error = 0.0;
      for (size_t channel = 0; channel < 3; ++channel) {
        const double shown = std::clamp(static_cast<double>(colors[i].rgb_srgb[channel]), 0.0, 1.0);
        error += std::abs(shown - taken[channel] / 255.0) / 3.0;
      }
      if (std::isfinite(error)) map_->Add(point.head<2>(), error);
    }
    c.done += count;
    if (c.done == c.pixels.size()) comparison_.reset();
  }

  void Finish() {
    if (result_.photos == 0) {
      throw BadMessage("none of the " + std::to_string(photos_.size()) + " held-out photos can be read: " + problem_);
    }
    if (map_->Empty()) throw BadMessage("the held-out photos show no surface of this scene");
    result_.min_enu = map_->grid().origin;
    result_.max_enu = map_->grid().max();
    result_.scale = std::max(kSmallestScale, map_->Quantile(kScaleShare));
    result_.url = publish_(map_->Picture(result_.scale));
  }

  const ErrorMapRequest request_;
  const std::shared_ptr<const survey::Survey> survey_;
  const PhotoCaster caster_;
  const PublishPicture publish_;
  std::vector<int> photos_;  // that are compared: indices into the survey's photos
  size_t next_ = 0;          // of photos_: the one that is being read
  std::shared_ptr<PhotoToRead> reading_;
  std::optional<Comparison> comparison_;
  std::optional<MeanMap> map_;
  std::string problem_;  // the first
  ErrorMapResult result_;
};

}  // namespace

std::unique_ptr<Query> MakeErrorMap(const ErrorMapRequest& request, std::shared_ptr<const survey::Survey> survey, PhotoCaster photo_caster,
                                    PublishPicture publish) {
  if (survey == nullptr) throw BadMessage("the survey of this project cannot be read, so its photos are not known");
  if (!photo_caster || !publish) throw BadMessage("the trained scene of this project is not loaded, so its error is not known");
  return std::make_unique<ErrorMapQuery>(request, std::move(survey), std::move(photo_caster), std::move(publish));
}

}  // namespace skyquilt::viewer
