#include "bench/study/scale_scores.h"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/progress.h"
#include "core/camera/corner_radius.h"
#include "core/image/area_mean.h"
#include "core/image/srgb.h"
#include "core/metrics/psnr.h"
#include "evaluate/photos/choose_photos.h"
#include "evaluate/photos/load_held_out_photo.h"
#include "evaluate/photos/photo_response.h"

namespace skyquilt::bench {
namespace {

using Clock = std::chrono::steady_clock;

image::ImageF LightOf(image::ImageF display) {
  for (float& value : display.data) value = image::LinearFromSrgb(value);
  return display;
}

// As an image file stores it.
image::ImageF DisplayOf(image::ImageF light) {
  for (float& value : light.data) value = std::clamp(image::SrgbFromLinear(value), 0.0F, 1.0F);
  return light;
}

camera::Camera Reduced(const camera::Camera& camera, int divisor) {
  const int width = std::max(1, camera.width / divisor);
  return camera.Resized(width, std::min(camera.height, image::ScaledHeight(camera.width, camera.height, width)));
}

image::ImageF FrameOf(const scene::Scene& scene, const camera::Camera& camera, const geo::Rigid3d& cam_from_enu, base::ThreadPool& threads) {
  const std::vector<render::RayColor> colors = scene.RenderCamera(camera, cam_from_enu, {scene::Rendition::kRecorded, {}}, threads);
  image::ImageF frame(camera.width, camera.height, 3);
  for (size_t i = 0; i < colors.size(); ++i) {
    for (size_t c = 0; c < 3; ++c) {
      const float value = colors[i].rgb_srgb[c];
      frame.data[3 * i + c] = std::isfinite(value) ? std::max(value, 0.0F) : 0.0F;
    }
  }
  return frame;
}

evaluate::photos::PhotoResponse RecordingOf(const ScaleInput& input, int photo) {
  const brightness::Response& response = input.scene->info().response;
  const survey::Photo& taken = input.survey->photos[static_cast<size_t>(photo)];
  const double gain = evaluate::photos::TaggedGain(taken, response.reference_exposure, input.evaluate.exif_gain);
  const evaluate::photos::PhotoResponse recording = evaluate::photos::TaggedResponse(response, taken.camera, gain);
  return input.evaluate.predicted_gain ? evaluate::photos::PredictedResponse(response, static_cast<size_t>(photo), recording) : recording;
}

// Held-out photos whose names begin with `prefix`.
std::vector<int> PhotosOfGroup(const survey::Survey& survey, const std::string& prefix, int at_most) {
  std::vector<int> photos = evaluate::photos::HeldOutPhotos(survey);
  std::erase_if(photos, [&](int photo) { return !survey.photos[static_cast<size_t>(photo)].name.starts_with(prefix); });
  return evaluate::photos::SelectEvenly(photos, at_most);
}

void WritePictures(const std::vector<ScaledPhoto>& scaled, const std::string& group, const std::filesystem::path& folder) {
  base::RequireWritableFolder(folder);
  for (const ScaledPhoto& s : scaled) {
    image::SavePng(image::ToImage8(s.rendering), folder / ScalePicture(group, s.averaged ? "averaged" : "one", s.divisor));
    if (!s.averaged) image::SavePng(image::ToImage8(s.truth), folder / ScalePicture(group, "truth", s.divisor));
  }
}

std::vector<ScaleScore> ScoreGroup(const ScaleInput& input, const ScaleOptions& options, const std::string& group,
                                   const std::filesystem::path& pictures, base::Progress& progress, base::ThreadPool& threads) {
  const std::vector<int> photos = PhotosOfGroup(*input.survey, group, input.evaluate.max_photos);
  std::vector<ScaleScore> scores;
  std::vector<std::vector<double>> psnr_db, seconds;
  for (size_t i = 0; i < photos.size(); ++i) {
    base::ThrowIfCancelled();
    const evaluate::photos::HeldOutPhoto photo =
        evaluate::photos::LoadHeldOutPhoto(*input.survey, *input.pixels, photos[i], input.evaluate.image_width);
    TrueView view = SceneLight(photo, RecordingOf(input, photos[i]));
    if (options.area) KeepArea(photo, *options.area, &view);
    const FrameRenderer render = [&](const camera::Camera& camera) { return FrameOf(*input.scene, camera, photo.cam_from_enu, threads); };
    if (i == 0) render(Reduced(view.camera, options.divisors.back()));  // loads fields, which is not part of the first photo's time
    const std::vector<ScaledPhoto> scaled = ScoreAtScales(view, options.divisors, render);
    if (i == photos.size() / 2) WritePictures(scaled, group, pictures);
    scores.resize(scaled.size(), {.group = group});
    psnr_db.resize(scaled.size());
    seconds.resize(scaled.size());
    for (size_t k = 0; k < scaled.size(); ++k) {
      ScaleScore& score = scores[k];
      score.divisor = scaled[k].divisor;
      score.averaged = scaled[k].averaged;
      if (i == 0) score.width = scaled[k].truth.width;
      if (std::isnan(scaled[k].psnr_db)) continue;
      score.render_seconds += scaled[k].render_seconds;
      ++score.photos;
      psnr_db[k].push_back(scaled[k].psnr_db);
      seconds[k].push_back(scaled[k].render_seconds);
    }
    progress.Advance(1.0, input.survey->photos[static_cast<size_t>(photos[i])].name);
  }
  for (size_t k = 0; k < scores.size(); ++k) {
    scores[k].psnr_db = evaluate::MeanOfMeasured(psnr_db[k]);
    scores[k].frame_seconds = evaluate::MedianOfMeasured(seconds[k]);
  }
  return scores;
}

}  // namespace

bool GroundArea::Contains(const Eigen::Vector3d& point_enu) const {
  const Eigen::Vector2d point = point_enu.head<2>();
  return (point.array() >= min_enu.array()).all() && (point.array() <= max_enu.array()).all();
}

std::string ScaleOptions::Identity() const {
  std::string text = fmt::format("scales {} {}", fmt::join(divisors, ","), fmt::join(groups, ","));
  if (area) text += fmt::format(" {:.3f} {:.3f} {:.3f} {:.3f}", area->min_enu.x(), area->min_enu.y(), area->max_enu.x(), area->max_enu.y());
  return text;
}

TrueView SceneLight(const evaluate::photos::HeldOutPhoto& photo, const evaluate::photos::PhotoResponse& recording) {
  TrueView view{.camera = photo.camera, .light = LightOf(image::ToImageF(photo.photo)), .used = photo.UsedPixels()};
  brightness::Response one = brightness::Response::Neutral(1, 1);
  one.log_gain.assign(recording.log_gain.begin(), recording.log_gain.end());
  one.vignetting.assign(recording.vignetting.begin(), recording.vignetting.end());
  const camera::CornerRadius radius(photo.camera);
  for (int y = 0; y < view.light.height; ++y) {
    for (int x = 0; x < view.light.width; ++x) {
      const std::array<float, 3> log_gain = one.LogGain(0, radius.Squared({x + 0.5, y + 0.5}));
      for (size_t c = 0; c < 3; ++c) view.light.At(x, y)[c] *= std::exp(-log_gain[c]);
    }
  }
  return view;
}

void KeepArea(const evaluate::photos::HeldOutPhoto& photo, const GroundArea& area, TrueView* view) {
  if (view->used.Empty()) view->used = image::Image8(view->light.width, view->light.height, 1, 255);
  const geo::Rigid3d enu_from_cam = photo.cam_from_enu.Inverse();
  const image::ImageF& depth = photo.true_depth;
  for (int y = 0; y < view->used.height; ++y) {
    for (int x = 0; x < view->used.width; ++x) {
      float z = std::numeric_limits<float>::quiet_NaN();
      if (!depth.Empty()) z = *depth.At(x * depth.width / view->used.width, y * depth.height / view->used.height);
      const Eigen::Vector3d ray = photo.camera.RayFromImg({x + 0.5, y + 0.5});
      const bool inside =
          std::isfinite(z) && ray.z() > 0.0 && area.Contains(enu_from_cam * Eigen::Vector3d(ray * (static_cast<double>(z) / ray.z())));
      if (!inside) *view->used.At(x, y) = 0;
    }
  }
}

std::vector<ScaledPhoto> ScoreAtScales(const TrueView& view, const std::vector<int>& divisors, const FrameRenderer& render) {
  std::vector<ScaledPhoto> scaled;
  scaled.reserve(2 * divisors.size());
  image::ImageF full_light;
  double full_seconds = 0.0;
  for (const int divisor : divisors) {
    const camera::Camera camera = Reduced(view.camera, divisor);
    const auto reduce = [&camera](const image::ImageF& light) { return DisplayOf(image::AreaMean(light, camera.width, camera.height)); };
    const image::Image8 used = view.used.Empty() ? view.used : image::ResizeMask(view.used, camera.width, camera.height);
    const auto score = [&used](ScaledPhoto& s) { s.psnr_db = metrics::Psnr(s.rendering, s.truth, used.Empty() ? nullptr : &used); };
    const Clock::time_point start = Clock::now();
    image::ImageF frame = render(camera);
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    ScaledPhoto one{.divisor = divisor, .averaged = false, .truth = reduce(view.light), .rendering = frame, .render_seconds = seconds};
    for (float& value : one.rendering.data) value = std::clamp(value, 0.0F, 1.0F);
    score(one);
    if (divisor == 1) {
      full_light = LightOf(std::move(frame));
      full_seconds = seconds;
    }
    scaled.push_back(std::move(one));
    if (divisor == 1 || full_light.Empty()) continue;
    ScaledPhoto average{
        .divisor = divisor, .averaged = true, .truth = scaled.back().truth, .rendering = reduce(full_light), .render_seconds = full_seconds};
    score(average);
    scaled.push_back(std::move(average));
  }
  return scaled;
}

std::vector<ScaleScore> ScoreScales(const ScaleInput& input, const ScaleOptions& options, const std::filesystem::path& pictures,
                                    base::ThreadPool& threads) {
  SKYQUILT_CHECK(!options.divisors.empty() && options.divisors.front() == 1, "the full width comes first");
  const std::vector<std::string> groups = options.groups.empty() ? std::vector<std::string>{""} : options.groups;
  size_t photos = 0;
  for (const std::string& group : groups) photos += PhotosOfGroup(*input.survey, group, input.evaluate.max_photos).size();
  base::Progress progress("scales", static_cast<double>(photos), "photos");
  std::vector<ScaleScore> scores;
  for (const std::string& group : groups) {
    std::vector<ScaleScore> own = ScoreGroup(input, options, group, pictures, progress, threads);
    std::move(own.begin(), own.end(), std::back_inserter(scores));
  }
  progress.Finish(fmt::format("{} photos", photos));
  return scores;
}

std::string ScalePicture(const std::string& group, const std::string& kind, int divisor) {
  return fmt::format("{}{}_{}.png", group, kind, divisor);
}

}  // namespace skyquilt::bench
