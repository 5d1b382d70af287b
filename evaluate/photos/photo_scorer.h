// Compares one rendered held-out photo with the real one, pixel by pixel: coverage, squared errors per group, SSIM, FLIP, depth.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/brightness/response.h"
#include "core/camera/camera.h"
#include "core/geo/block_box.h"
#include "core/geo/transform.h"
#include "core/image/image.h"
#include "core/scene/scene.h"
#include "core/survey/survey.h"
#include "evaluate/photos/coverage.h"
#include "evaluate/photos/photo_score.h"
#include "evaluate/photos/pixel_groups.h"
#include "evaluate/photos/seam_errors.h"

namespace skyquilt::evaluate::photos {

struct HeldOutPhoto {
  camera::Camera camera;  // at the scored size
  geo::Rigid3d cam_from_enu;
  image::Image8 photo;        // RGB, width * height of the camera
  std::vector<uint8_t> mask;  // per pixel, 0 = ignored; empty: every pixel counts
  // Of the true surface, any size; empty: unknown.
  image::ImageF true_depth;    // metres along z of the camera, NaN = none
  image::ImageF true_normals;  // three channels: unit vectors in ENU, NaN = none
  image::Image8 true_class;    // survey::SurfaceClass

  image::Image8 UsedPixels() const;  // the mask as an image of one channel; empty: every pixel counts
};

// The shading that is fitted to held-out photos (tile_fit.h).
struct FittedShading {
  brightness::ShadingGrid grid = {8, 6};
  float sigma = 0.35F;

  // As the scene was trained with; the above where it has none.
  static FittedShading Of(const brightness::Response& response) {
    return response.shading_grid.On() ? FittedShading{response.shading_grid, response.shading_sigma} : FittedShading();
  }
};

struct SceneArea {
  std::vector<geo::BlockBox> boxes;  // of the blocks
  HeightRange heights;               // of the whole scene
  // Of the survey: rays above them that meet nothing below the highest of the heights show the sky, which is not covered. Empty where photos look
  // down.
  std::span<const survey::SparsePoint> points = {};
  FittedShading shading = {};
};

struct PhotoResult {
  PhotoScore score;  // sizes, pixel counts, PSNR, SSIM, FLIP and depth; the caller fills the rest
  SeamErrors seams;
  std::vector<skyquilt::metrics::SquaredError> per_block;  // one per box of the area, covered pixels
  image::Image8 scored;                                    // one channel, 1 = unmasked and covered
  image::Image8 render;                                    // the rendering, as shown in the report
  image::ImageF z_depth;                                   // metres along z of the camera, NaN where the render has none
  // The true surface at the scored size (nearest pixel), and the normals of z_depth to compare with; empty when unknown.
  image::ImageF true_depth;
  image::ImageF true_normals;
  image::Image8 true_class;
  image::ImageF normals;  // three channels: unit vectors in ENU, NaN where the depth has none
  // The same of the density's gradient and of the normal heads; empty unless the caller rendered and set them.
  image::ImageF density_normals;
  image::ImageF head_normals;
};

// rendered: row-major, one per pixel of the camera. The same result for any number of threads.
PhotoResult ScorePhoto(const HeldOutPhoto& task, std::span<const render::RayColor> rendered, const TrainingViews& views, const SceneArea& area,
                       base::ThreadPool& threads);

}  // namespace skyquilt::evaluate::photos
