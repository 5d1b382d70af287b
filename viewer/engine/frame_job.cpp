#include "viewer/engine/frame_job.h"

#include <algorithm>
#include <cstring>

#include "core/base/errors.h"
#include "products/render_views.h"

namespace skyquilt::viewer {
namespace {

constexpr int kMaxPhotoHeight = 4096;  // of a view of an upright photo, pixels

template <typename T>
void AppendBytes(const T& value, std::string* out) {
  char bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof(T));
  out->append(bytes, sizeof(T));
}

}  // namespace

struct FrameJob::Pass {
  PassRays rays;
  std::vector<size_t> pixels;  // in the order of rendering
  size_t done = 0;
  std::vector<uint8_t> rgb;
  std::vector<float> depth_m;
  // Of one batch.
  std::vector<render::Ray> batch;
  std::vector<render::RayColor> colors;
};

FrameJob::FrameJob(const ViewRequest& view, const Renderer& renderer) : view_(view) {
  if (renderer.Frame(view.project) == nullptr) throw BadMessage(renderer.WhyNot(view.project));
  if (view.photo < 0) {
    sizes_ = PassSizes(view.width, view.height);
    return;
  }
  if (view.project != Which::kMain) throw BadMessage("photo: only photos of the main project can be shown");
  products::View photo = renderer.PhotoView(view.photo, view.width);
  if (photo.camera.height > kMaxPhotoHeight) {
    view_.width = std::max(1, view.width * kMaxPhotoHeight / photo.camera.height);
    photo = renderer.PhotoView(view.photo, view_.width);
  }
  view_.height = photo.camera.height;
  sizes_ = PassSizes(view_.width, view_.height);
}

std::string FrameJob::Key(int pass) const {
  std::string key;
  AppendBytes(view_.project, &key);
  AppendBytes(view_.photo, &key);
  if (view_.photo < 0) {
    for (int axis = 0; axis < 3; ++axis) AppendBytes(view_.eye_enu[axis], &key);
    for (const double value : {view_.cam_from_enu.w(), view_.cam_from_enu.x(), view_.cam_from_enu.y(), view_.cam_from_enu.z()}) {
      AppendBytes(value, &key);
    }
    AppendBytes(view_.orthographic, &key);
    AppendBytes(view_.orthographic ? view_.view_height_m : view_.fovy_deg, &key);
  }
  AppendBytes(view_.width, &key);
  AppendBytes(view_.height, &key);
  AppendBytes(pass, &key);
  return key;
}

void FrameJob::Begin(const Renderer& renderer) {
  const SceneFrame* scene = renderer.Frame(view_.project);
  if (scene == nullptr) throw BadMessage(renderer.WhyNot(view_.project));
  const PassSize size = sizes_[static_cast<size_t>(pass_)];
  PassRays rays = view_.photo < 0 ? PassRays(view_, size, *scene) : PassRays(renderer.PhotoView(view_.photo, size.width), *scene);
  current_ = std::make_shared<Pass>(Pass{.rays = std::move(rays), .pixels = {}, .rgb = {}, .depth_m = {}, .batch = {}, .colors = {}});
  const auto [width, height] = current_->rays.size();
  const size_t n = static_cast<size_t>(width) * static_cast<size_t>(height);
  current_->pixels.reserve(n);
  scene::AppendTilePixels(width, height, 0, scene::TileCount(width, height), &current_->pixels);
  current_->rgb.resize(3 * n);
  current_->depth_m.resize(n);
}

std::optional<RenderedPass> FrameJob::Step(Renderer& renderer) {
  SKYQUILT_CHECK(!Done(), "a finished job");
  if (!current_) Begin(renderer);
  Pass& pass = *current_;
  const size_t count = std::min(std::max<size_t>(1, renderer.Batch(view_.project)), pass.pixels.size() - pass.done);
  const std::span<const size_t> pixels = std::span<const size_t>(pass.pixels).subspan(pass.done, count);
  pass.batch.resize(count);
  pass.colors.assign(count, render::RayColor{});
  pass.rays.Make(pixels, pass.batch);
  renderer.Render(view_.project, pass.batch, pass.colors);
  const image::Image8 colors = products::ColorImage(pass.colors, static_cast<int>(count), 1);
  for (size_t i = 0; i < count; ++i) {
    std::copy_n(&colors.data[3 * i], 3, &pass.rgb[3 * pixels[i]]);
    pass.depth_m[pixels[i]] = pass.rays.Depth(pass.batch[i], pass.colors[i]);
  }
  pass.done += count;
  if (pass.done < pass.pixels.size()) return {};
  RenderedPass finished;
  FrameHeader& header = finished.header;
  header.seq = view_.seq;
  header.pass = pass_;
  header.passes = passes();
  header.format = pass_ + 1 == passes() ? ColorFormat::kPng : ColorFormat::kJpeg;
  header.before = view_.project == Which::kBefore;
  header.photo = view_.photo >= 0;
  header.orthographic = view_.orthographic && !header.photo;
  header.width = header.w = pass.rays.size().width;
  header.height = header.h = pass.rays.size().height;
  header.eye_enu = pass.rays.eye_enu();
  header.cam_from_enu = pass.rays.cam_from_enu();
  header.fovy_deg_or_height_m = pass.rays.fovy_deg_or_height_m();
  finished.rgb = std::move(pass.rgb);
  finished.depth_m = std::move(pass.depth_m);
  SkipTo(pass_ + 1);
  return finished;
}

void FrameJob::SkipTo(int pass) {
  pass_ = pass;
  current_.reset();
}

}  // namespace skyquilt::viewer
