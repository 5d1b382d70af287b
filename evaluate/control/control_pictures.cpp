#include "evaluate/control/control_pictures.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/image/image.h"
#include "core/scene/camera_rays.h"
#include "evaluate/photos/picture_of_colors.h"

namespace skyquilt::evaluate::control {

namespace {

using MarkIndex = std::pair<size_t, size_t>;  // point and mark

image::Image8 Cut(const image::Image8& picture, const PictureWindow& window) {
  image::Image8 cut(window.width, window.height, 3);
  for (int y = 0; y < window.height; ++y) {
    std::copy_n(picture.At(window.left, window.top + y), 3 * static_cast<size_t>(window.width), cut.At(0, y));
  }
  return cut;
}

image::Image8 Rendered(const scene::Scene& scene, const camera::Camera& camera, const geo::Rigid3d& cam_from_enu, const PictureWindow& window,
                       base::ThreadPool& threads) {
  std::vector<size_t> pixels;
  for (int y = window.top; y < window.top + window.height; ++y) {
    const size_t row = static_cast<size_t>(y) * static_cast<size_t>(camera.width);
    for (int x = window.left; x < window.left + window.width; ++x) pixels.push_back(row + static_cast<size_t>(x));
  }
  std::vector<render::Ray> rays(pixels.size());
  scene::CameraRays(camera, cam_from_enu, true).Make(pixels, rays);
  std::vector<render::RayColor> colors(pixels.size());
  scene.RenderRaysOverBackground(rays, colors, scene::Appearance{}, threads);
  return photos::PictureOf(colors, window.width, window.height);
}

// The photos with marks, by name, so that each is read once.
std::map<std::string, std::vector<MarkIndex>> MarksByPhoto(const survey::ControlFit& fit) {
  std::map<std::string, std::vector<MarkIndex>> marks;
  for (size_t point = 0; point < fit.points.size(); ++point) {
    for (size_t mark = 0; mark < fit.points[point].marks.size(); ++mark) marks[fit.points[point].marks[mark].photo].emplace_back(point, mark);
  }
  return marks;
}

// Nothing when it cannot be read: photos may have been moved since they were prepared.
std::optional<image::Image8> ReadPhoto(const std::filesystem::path& file) {
  try {
    return image::LoadRgb8(file);
  } catch (const base::InputError& error) {
    base::LogWarning("the report lacks pictures of control points: {}", error.what());
    return std::nullopt;
  }
}

const survey::Photo* PhotoNamed(const survey::Survey& survey, const std::string& name) {
  const auto found = std::find_if(survey.photos.begin(), survey.photos.end(), [&](const survey::Photo& photo) { return photo.name == name; });
  return found == survey.photos.end() ? nullptr : &*found;
}

}  // namespace

PictureWindow WindowAround(const Eigen::Vector2d& pixel, int image_width, int image_height) {
  PictureWindow window{0, 0, std::min(kMarkPicture_px, image_width), std::min(kMarkPicture_px, image_height)};
  const auto begin = [](double centre, int size, int image_size) {
    return static_cast<int>(std::clamp(std::floor(centre) - size / 2, 0.0, static_cast<double>(image_size - size)));
  };
  window.left = begin(pixel.x(), window.width, image_width);
  window.top = begin(pixel.y(), window.height, image_height);
  return window;
}

std::vector<MarkPicture> WriteMarkPictures(const survey::Survey& survey, const scene::Scene* scene, const std::filesystem::path& report_folder,
                                           base::ThreadPool& threads) {
  std::vector<MarkPicture> pictures;
  for (const auto& [name, marks] : MarksByPhoto(survey.control)) {
    base::ThrowIfCancelled();
    const std::optional<image::Image8> photo = ReadPhoto(survey.photo_root / name);
    if (!photo) continue;
    const survey::Photo* const posed = PhotoNamed(survey, name);
    std::optional<camera::Camera> camera;
    if (posed != nullptr) camera = survey.cameras[static_cast<size_t>(posed->camera)].Resized(photo->width, photo->height);
    for (const auto& [point_index, mark_index] : marks) {
      const survey::ControlPointFit& point = survey.control.points[point_index];
      const Eigen::Vector2d& marked = point.marks[mark_index].pixel;
      const PictureWindow window = WindowAround(marked, photo->width, photo->height);
      const Eigen::Vector2d corner(window.left, window.top);
      const std::string stem = fmt::format("images/control_{}_{}", point_index, mark_index);
      MarkPicture& picture = pictures.emplace_back();
      picture = {point_index, mark_index, stem + "_photo.png", "", window.width, window.height, marked - corner, std::nullopt};
      image::SavePng(Cut(*photo, window), report_folder / picture.photo);
      if (!camera) continue;
      const Eigen::Vector3d estimated = point.given_in_enu + point.error_m;
      if (estimated.allFinite()) {
        if (const auto pixel = camera->ImgFromCam(posed->cam_from_enu * estimated)) picture.projected_px = *pixel - corner;
      }
      if (scene == nullptr) continue;
      picture.render = stem + "_render.png";
      image::SavePng(Rendered(*scene, *camera, posed->cam_from_enu, window, threads), report_folder / picture.render);
    }
  }
  std::sort(pictures.begin(), pictures.end(),
            [](const MarkPicture& a, const MarkPicture& b) { return std::pair(a.point, a.mark) < std::pair(b.point, b.mark); });
  return pictures;
}

}  // namespace skyquilt::evaluate::control
