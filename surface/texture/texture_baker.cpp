#include "surface/texture/texture_baker.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/brightness/unshade.h"
#include "surface/texture/bake_tile.h"
#include "surface/texture/view_choice.h"

namespace skyquilt::surface {
namespace {

// Middle and half diagonal of the box around the vertices; a radius below 0 when there are none.
struct BoundingBall {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double radius_m = -1.0;
};

BoundingBall BallOf(const Mesh& mesh) {
  Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector3d high = -low;
  for (const Eigen::Vector3d& x : mesh.position) {
    if (!x.allFinite()) continue;
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  if (!low.allFinite()) return {};
  return {0.5 * (low + high), 0.5 * (high - low).norm()};
}

constexpr double kMostPictureBytes = 1073741824.0, kShareForPictures = 0.125;

// A photo with `scale` times the pixels that it was trained with along each axis, but never enlarged.
survey::PhotoPicture PictureAt(const SurfaceInput& input, size_t photo, double scale) {
  const camera::Camera& camera = input.survey->cameras[static_cast<size_t>(input.survey->photos[photo].camera)];
  const int trained = input.photos->Width(photo);
  const int width = std::clamp(static_cast<int>(std::lround(scale * trained)), 1, camera.width);
  if (width > trained) return survey::ReadPhotoPicture(*input.survey, photo, width);
  image::PixelCache::Photo pixels = input.photos->Copy(photo);
  survey::PhotoPicture picture;
  picture.rgb = image::Image8(trained, input.photos->Height(photo), 3);
  picture.rgb.data = std::move(pixels.rgb);
  if (!pixels.mask.empty()) {
    picture.mask = image::Image8(trained, input.photos->Height(photo), 1);
    picture.mask.data = std::move(pixels.mask);
  }
  if (width < trained) {
    const int height = image::ScaledHeight(camera.width, camera.height, width);
    picture.rgb = image::Resize(picture.rgb, width, height);
    if (!picture.mask.Empty()) picture.mask = image::ResizeMask(picture.mask, width, height);
  }
  picture.camera = camera.Resized(picture.rgb.width, picture.rgb.height);
  return picture;
}

}  // namespace

TextureBaker::TextureBaker(const SurfaceInput& input, const DepthViews& views, double voxel_m) : input_(input), views_(views), voxel_m_(voxel_m) {}

survey::PhotoPictures* TextureBaker::PhotosFor(double texel_m) {
  if (input_.photos == nullptr || !input_.options.photo_texture) return nullptr;
  if (photos_ && photo_texel_m_ == texel_m) return photos_.get();
  failures_ = Failures();
  photo_texel_m_ = texel_m;
  const auto read = [&input = input_, scale = input_.info->gsd_m / texel_m,
                     shading = brightness::PhotoShading::Of(input_.info->response)](size_t photo) {
    survey::PhotoPicture picture = PictureAt(input, photo, scale);
    brightness::DivideByShading(shading, photo, picture.rgb);
    return picture;
  };
  const double budget = std::min(kMostPictureBytes, kShareForPictures * input_.memory_bytes);
  photos_ = std::make_unique<survey::PhotoPictures>(input_.survey->photos.size(), read, static_cast<size_t>(budget));
  return photos_.get();
}

std::set<std::string> TextureBaker::Failures() const {
  std::set<std::string> all = failures_;
  if (photos_) {
    for (const std::string& failure : photos_->Failures()) all.insert(failure);
  }
  return all;
}

BakedTile TextureBaker::Bake(const MeshTile& mesh, const BakeOptions& options, base::ThreadPool& threads) {
  std::vector<DepthView> near;
  const BoundingBall ball = BallOf(mesh.mesh);
  for (size_t v = 0; v < views_.size() && ball.radius_m >= 0.0; ++v) {
    if (MayShow(views_.pose(v), ball.centre, ball.radius_m)) near.push_back(views_[v]);
  }
  return BakeTile(mesh, near, {input_.caster, voxel_m_, input_.survey, PhotosFor(options.texel_m)}, options, threads);
}

}  // namespace skyquilt::surface
