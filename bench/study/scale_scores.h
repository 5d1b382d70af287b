// Scores of a scene from far away: its held-out photos rendered at 1, 1/2, 1/4 and 1/8 of their width with one ray per pixel.
// Truth: the photo in linear light at the scene's brightness (divided by the gain and vignetting that evaluation gives it), averaged over the area of
// each pixel, as display values. Beside it the rendering at full width, averaged in the same way: k x k rays a pixel. PSNR per photo over the full
// frame, mean over photos; photos' masks hold.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/camera/camera.h"
#include "core/image/image.h"
#include "core/image/pixel_cache.h"
#include "core/scene/scene.h"
#include "core/survey/survey.h"
#include "evaluate/evaluate_options.h"
#include "evaluate/photos/apply_response.h"
#include "evaluate/photos/photo_scorer.h"

namespace skyquilt::bench {

// The horizontal rectangle that is scored, ENU metres.
struct GroundArea {
  Eigen::Vector2d min_enu, max_enu;
  bool Contains(const Eigen::Vector3d& point_enu) const;
};

struct ScaleOptions {
  std::vector<int> divisors = {1, 2, 4, 8};  // of the width; 1 is first
  // Held-out photos are scored in groups by the beginning of their names, each by its own; without groups all together.
  std::vector<std::string> groups;
  // Only pixels whose true surface point is in it, for simulated surveys; photos without true depth are then not scored. Empty: the full frame.
  std::optional<GroundArea> area;

  // Differs when scores may differ.
  std::string Identity() const;
};

struct ScaleScore {
  std::string group = {};  // empty: all held-out photos
  int divisor = 1;         // of the width
  bool averaged = false;   // the rendering at full width, averaged
  int photos = 0;          // scored
  int width = 0;           // of the first photo's reduced image, pixels
  double psnr_db = std::numeric_limits<double>::quiet_NaN();
  double render_seconds = 0.0;                                      // of all these photos
  double frame_seconds = std::numeric_limits<double>::quiet_NaN();  // median over them, which a busy machine disturbs less
};

// One photo to compare with.
struct TrueView {
  camera::Camera camera;  // at full width
  image::ImageF light;    // linear light at the scene's brightness
  image::Image8 used;     // one channel, 0 = not scored; empty: every pixel counts
};
// used: as in TrueView. Divides out the recording, which ApplyResponse would apply to a rendering.
TrueView SceneLight(const evaluate::photos::HeldOutPhoto& photo, const evaluate::photos::PhotoResponse& recording);
// Unsets the pixels whose true surface point is outside the area, or unknown.
void KeepArea(const evaluate::photos::HeldOutPhoto& photo, const GroundArea& area, TrueView* view);

struct ScaledPhoto {
  int divisor = 1;
  bool averaged = false;
  image::ImageF truth, rendering;  // display values, 0 to 1
  double psnr_db = std::numeric_limits<double>::quiet_NaN();
  double render_seconds = 0.0;
};
// Display values at the scene's brightness, one ray per pixel of the camera.
using FrameRenderer = std::function<image::ImageF(const camera::Camera&)>;
// For each divisor one ray per pixel, then (but for 1) the average of the full frame.
std::vector<ScaledPhoto> ScoreAtScales(const TrueView& view, const std::vector<int>& divisors, const FrameRenderer& render);

struct ScaleInput {
  const scene::Scene* scene = nullptr;
  const survey::Survey* survey = nullptr;
  const image::PixelCache* pixels = nullptr;  // entry i belongs to survey->photos[i]
  evaluate::EvaluateOptions evaluate;         // width, brightness, number of photos
};
// Scores groups x divisors x {one ray, averaged}. Of the middle photo of each group it writes pictures into the folder: <group>one_4.png,
// averaged_4.png and truth_4.png. Throws base::InputError.
std::vector<ScaleScore> ScoreScales(const ScaleInput& input, const ScaleOptions& options, const std::filesystem::path& pictures,
                                    base::ThreadPool& threads);
// Name of such a picture. kind: one, averaged or truth.
std::string ScalePicture(const std::string& group, const std::string& kind, int divisor);

}  // namespace skyquilt::bench
