// Scores of a scene whose photos were taken under several lights (simulate/lights.h): held-out photos of each light against the scene in a look that
// stands for this light. Looks are mixed from the codes of those lights that were trained with (merge/look.h).
// Lights at odd places of the list are the ones between: how far shadows move from a light to the next is measured there, whether they were trained
// with or not, against their neighbours in the list.
#pragma once

#include <cstddef>
#include <filesystem>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/image/image.h"
#include "evaluate/evaluate_input.h"

namespace skyquilt::bench {

struct LightOptions {
  std::vector<std::string> lights;  // folders of the photos' names, by rising elevation or intensity, evenly spaced

  // Differs when scores may differ.
  std::string Identity() const;
};

// How a scene was given the look of a light: by the light's own code; by the codes of the trained lights below and above it, mixed by distance; by
// one of these alone; or not at all, when there are no codes.
inline constexpr const char* kOwnLook = "own";
inline constexpr const char* kBetweenLook = "between";
inline constexpr const char* kLowerLook = "lower";
inline constexpr const char* kUpperLook = "upper";
inline constexpr const char* kNoLook = "none";

struct LightScore {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  std::string light, look;
  int photos = 0;
  double psnr_db = kNone, ssim = kNone;  // means over the photos, covered pixels
  double stops = kNone;                  // brightness that the scene gave these photos by tags and learned gains, mean over photos and colours
  // Only of lights between; pooled over the photos, NaN without such pixels. Moved pixels: where the photo's brightness is not the mean of its
  // neighbours' (kMoved), as shadows came or went.
  double moved_share = kNone;    // of the covered pixels
  double moved_psnr_db = kNone;  // over them
  // How much of that difference the rendering shows: 0 where it shows the mean of the neighbours, a shadow that fades; 1 where it shows the photo.
  double followed = kNone;
};

// Difference in display values (0..1, mean of the colours).
inline constexpr double kMoved = 0.06;

// A look and which lights it is scored for.
struct LookPlan {
  std::string look;                                       // as merge.look
  std::vector<std::pair<size_t, std::string>> shown_for;  // index of a light, and how the look stands for it
};
// trained: per light. Lights beyond the trained ones get the look of the nearest. Without codes there is one look, the mean one, for all.
std::vector<LookPlan> PlanLooks(const std::vector<std::string>& lights, const std::vector<bool>& trained, bool codes);

// Sums of a photo of a light between and its rendering.
struct MovedSums {
  int64_t pixels = 0, moved = 0;
  double squared_error = 0.0;       // of the moved pixels, mean of the colours
  double along = 0.0, whole = 0.0;  // followed = along / whole
};
// below, above: photos of the same view under the neighbouring lights. All four are RGB of one size; scored: one channel, 0 is left out.
MovedSums CompareMoved(const image::Image8& below, const image::Image8& photo, const image::Image8& above, const image::Image8& render,
                       const image::Image8& scored);

// The scores of one scene that has the look. input: with survey, pixels and that scene. The middle held-out photo of every light and its rendering
// are written into `folder` (LightPicture). Throws base::InputError.
std::vector<LightScore> ScoreLook(const evaluate::EvaluateInput& input, const LightOptions& options, const LookPlan& plan,
                                  const std::filesystem::path& folder, base::ThreadPool& threads);

// Name of such a file. kind: "photo", or a look's.
std::string LightPicture(const std::string& light, const std::string& kind);

}  // namespace skyquilt::bench
