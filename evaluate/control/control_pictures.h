// Pictures of the marks of control and check points: the photo around each mark, and the scene as that camera would see it.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/scene/scene.h"
#include "core/survey/survey.h"

namespace skyquilt::evaluate::control {

inline constexpr int kMarkPicture_px = 64;  // width and height of a picture: pixels of the photo at its full size

struct MarkPicture {
  size_t point = 0, mark = 0;                                  // indices into ControlFit::points and its marks
  std::string photo, render;                                   // files relative to the page; no render where the photo has no pose
  int width = kMarkPicture_px, height = kMarkPicture_px;       // smaller only in smaller photos
  Eigen::Vector2d marked_px = Eigen::Vector2d::Zero();         // in the picture, whose corner is (0, 0)
  std::optional<Eigen::Vector2d> projected_px = std::nullopt;  // of the estimated point; nothing where that is unknown
};

// The part of an image of this size to show around a pixel; inside the image where that is large enough.
struct PictureWindow {
  int left = 0, top = 0, width = 0, height = 0;
};
PictureWindow WindowAround(const Eigen::Vector2d& pixel, int image_width, int image_height);

// Writes images/control_<point>_<mark>_photo.png and _render.png under report_folder, of every mark whose photo can be read; each photo is read once.
// Without a scene there are no renderings. Renderings are at normal brightness. Throws base::InputError when a file cannot be written.
std::vector<MarkPicture> WriteMarkPictures(const survey::Survey& survey, const scene::Scene* scene, const std::filesystem::path& report_folder,
                                           base::ThreadPool& threads);

}  // namespace skyquilt::evaluate::control
