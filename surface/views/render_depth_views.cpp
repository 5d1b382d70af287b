#include "surface/views/render_depth_views.h"

#include <algorithm>
#include <chrono>
#include <optional>
#include <span>
#include <system_error>
#include <type_traits>
#include <utility>

#include "core/base/amounts.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/order_statistics.h"
#include "core/base/progress.h"
#include "core/survey/view_kind.h"
#include "surface/views/view_files.h"
#include "surface/views/view_gaps.h"
#include "surface/views/view_poses.h"
#include "surface/views/view_rendering.h"

namespace skyquilt::surface {
namespace {

constexpr double kCoarseBytes = 64e6;                                // of the pictures that are kept for the search for gaps
constexpr double kVirtualShare = 1.0, kVirtualShareImproved = 0.25;  // rays of virtual views, in rays of photo views
// Pixels across a picture of depth: in smaller ones, what is compared around a pixel is as large as a house.
constexpr double kLeastImprovedWidth = 640.0;
// Of virtual views beside improved ones: where photos agree on the surface, they must not blur it.
constexpr uint8_t kVirtualWeight = 16;

int64_t RaysOf(std::span<const ViewPose> poses) {
  int64_t rays = 0;
  for (const ViewPose& pose : poses) rays += static_cast<int64_t>(pose.width) * pose.height;
  return rays;
}

bool AreWideEnough(std::span<const ViewPose> poses) {
  std::vector<double> widths;
  for (const ViewPose& pose : poses) widths.push_back(std::max(pose.width, pose.height));
  return !widths.empty() && base::UpperMedian(widths) >= kLeastImprovedWidth;
}

// Of everything that the pictures depend on, so that those of other options or of another scene are not taken for these.
std::string KeyOf(const SurfaceInput& input, const PhotoPlaces& places, double voxel_m, bool improved) {
  std::string text;
  const auto add = [&text](const auto& value) {
    static_assert(std::is_arithmetic_v<std::decay_t<decltype(value)>>);
    text.append(reinterpret_cast<const char*>(&value), sizeof(value));
  };
  const auto add_pose = [&add](const ViewPose& pose) {
    for (const int value : {pose.photo, pose.width, pose.height}) add(value);
    for (const double value : {pose.focal_px, pose.cx, pose.cy}) add(value);
    for (const double value : pose.cam_from_enu.rotation.coeffs()) add(value);
    for (const double value : pose.cam_from_enu.translation) add(value);
  };
  const SurfaceOptions& options = input.options;
  for (const double value : {voxel_m, options.min_opacity, options.max_spread_voxels, kMaxAngle_deg, places.agl_m}) add(value);
  add(options.virtual_views);
  add(options.min_views);
  for (const double value : input.info->min_enu) add(value);
  for (const double value : input.info->max_enu) add(value);
  add(input.info->parameters);
  text.append(input.info->config);
  for (const ViewPose& pose : places.training) add_pose(pose);
  if (const double free_opacity = LimitsOf(input, voxel_m).max_free_opacity; free_opacity >= 0.0) add(free_opacity);
  if (LimitsOf(input, voxel_m).spread_across) add(true);
  if (improved) add(improved);
  return base::HashHex(text);
}

// The views of an earlier run, if they are whole and were made from the same.
std::optional<DepthViews> OpenFinished(const std::filesystem::path& file, const std::string& key) {
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) return std::nullopt;
  try {
    DepthViews views = DepthViews::Open(file);
    if (views.key() == key) return views;
    base::LogInfo("surface views: options or scene have changed; they are rendered again");
  } catch (const base::InputError& error) {
    base::LogWarning("surface views are rendered again: {}", error.what());
  }
  return std::nullopt;
}

// Renders lists of views, or loads those that an earlier run has finished.
class DepthViewRenderer {
 public:
  DepthViewRenderer(const SurfaceInput& input, double voxel_m, std::string key, std::filesystem::path folder, base::ThreadPool& threads)
      : input_(input), limits_(LimitsOf(input, voxel_m)), key_(std::move(key)), folder_(std::move(folder)), threads_(threads) {}

  void Make(std::span<const ViewPose> poses, const std::string& label) {
    if (poses.empty()) return;
    base::Progress progress(label, static_cast<double>(RaysOf(poses)), "rays");
    for (size_t i = 0; i < poses.size(); ++i) {
      MakeOne(poses[i], ViewFileName(poses_.size()), progress);
      poses_.push_back(poses[i]);
      progress.Advance(0.0, std::to_string(i + 1) + " of " + std::to_string(poses.size()) + " views");
    }
    progress.Finish();
  }

  // Of all depths that are rendered from now on.
  void SetWeight(uint8_t weight) { weight_ = weight; }
  const std::vector<ViewPose>& poses() const { return poses_; }
  int64_t rendered_rays() const { return rendered_rays_; }
  double seconds() const { return seconds_; }

 private:
  void MakeOne(const ViewPose& pose, const std::string& name, base::Progress& progress) {
    // Those that were improved stand in the place of rendered ones.
    if (LoadView(folder_ / kImprovedFolder / name, pose, key_) || LoadView(folder_ / name, pose, key_)) {
      progress.Advance(static_cast<double>(RaysOf({&pose, 1})));
      return;
    }
    const auto start = std::chrono::steady_clock::now();
    RenderedView view = RenderView(pose, input_.depth_caster ? input_.depth_caster : input_.caster, limits_, threads_,
                                   [&](int64_t pixels) { progress.Advance(static_cast<double>(pixels)); });
    seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    rendered_rays_ += RaysOf({&pose, 1});
    if (weight_ != kFullWeight) view.weight.assign(view.depth_m.size(), weight_);
    SaveView(view, key_, folder_ / name);
  }

  const SurfaceInput& input_;
  DepthLimits limits_;
  std::string key_;
  std::filesystem::path folder_;
  base::ThreadPool& threads_;
  std::vector<ViewPose> poses_;
  uint8_t weight_ = kFullWeight;
  int64_t rendered_rays_ = 0;
  double seconds_ = 0.0;
};

void Report(const DepthViewRenderer& renderer, size_t photos) {
  std::string rate;
  if (renderer.rendered_rays() > 0 && renderer.seconds() > 0.0) {
    rate = ", " + base::FormatCount(static_cast<double>(renderer.rendered_rays()) / renderer.seconds()) + " rays/s";
  }
  base::LogInfo("surface views: {} of photos, {} virtual, {} pixels{}", photos, renderer.poses().size() - photos,
                base::FormatCount(static_cast<double>(RaysOf(renderer.poses()))), rate);
}

}  // namespace

DepthViews RenderDepthViews(const SurfaceInput& input, double voxel_m, base::ThreadPool& threads, const ImprovePhotoViews& improve) {
  const PhotoPlaces places = PlacesOfPhotos(input);
  const bool level = survey::LooksLevel(*input.survey);
  const bool improved = improve && AreWideEnough(places.training);
  if (improve && !improved) {
    base::LogInfo(
        "surface: photos are not compared for their depths, as pictures of depth have fewer than {:g} pixels across; a larger "
        "run.image_width or a smaller surface.view_gsd gives more",
        kLeastImprovedWidth);
  }
  const std::string key = KeyOf(input, places, voxel_m, improved);
  const std::filesystem::path folder = input.work_folder / "views", joined = input.work_folder / "views.bin";
  std::error_code ignored;
  if (std::optional<DepthViews> finished = OpenFinished(joined, key)) {
    // Left over when a run was killed just after it had joined them.
    std::filesystem::remove_all(folder, ignored);
    return std::move(*finished);
  }

  base::RequireWritableFolder(folder);
  DepthViewRenderer renderer(input, voxel_m, key, folder, threads);
  renderer.Make(places.training, "surface views");
  std::vector<std::filesystem::path> files;  // of all views
  for (size_t i = 0; i < renderer.poses().size(); ++i) files.push_back(folder / ViewFileName(i));
  if (improved) improve(renderer.poses(), key, folder, &files);
  if (input.options.virtual_views) {
    CoarseDepths coarse(RaysOf(places.training), kCoarseBytes);
    for (size_t i = 0; i < files.size(); ++i) coarse.Add(RequireView(files[i], renderer.poses()[i], key).Get());
    const auto budget = static_cast<int64_t>((improved ? kVirtualShareImproved : kVirtualShare) * static_cast<double>(RaysOf(places.training)));
    const GapOptions gaps{voxel_m, input.options.min_views, places.agl_m, budget, level};
    renderer.SetWeight(improved ? kVirtualWeight : kFullWeight);
    renderer.Make(PlanGapViews(coarse, gaps, threads), "surface views of gaps");
    for (size_t i = files.size(); i < renderer.poses().size(); ++i) files.push_back(folder / ViewFileName(i));
  }
  JoinViews(renderer.poses(), key, files, joined);
  std::filesystem::remove_all(folder, ignored);
  Report(renderer, places.training.size());
  return DepthViews::Open(joined);
}

}  // namespace skyquilt::surface
