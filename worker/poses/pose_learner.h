// Refines the poses of training photos by the gradient of a field's losses while it trains (Lin et al. 2021, BARF; Tancik et al. 2023, Nerfstudio,
// which refines poses in nerfacto).
//   Units: a pose is learned in whitened coordinates (pose_whitening.h), of which one is about a pixel of the photo as trained, so that one rate fits
//   rotation and translation of every camera.
//   Steps: Adam per photo. A photo makes a step when it has gradients of kRaysPerUpdate rays, however many photos the rays are divided among.
//   Course: begins when the field has rough surfaces, and first with the gradients of the encoding's coarse levels, whose slopes reach farther than
//   fine ones (BARF, section 3.3, where the levels themselves begin late); the rate then falls.
//   Prior: the loss gets kPriorLoss times the sum of the squares of the six numbers of an offset, each as the pixels by which it alone moves the
//   picture, over sigma^2. Turns and shifts that undo each other in the picture, as tilt and shift nearly do in photos that look down, stay small.
//   Gauge: after every step the similarity that is common to all poses is taken off (core/geo/pose_gauge.h), so that the survey stays in its place.
// Distances of samples along their rays, the lengths of their intervals and their footprints count as constant.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "core/checkpoint/archive.h"
#include "core/survey/refined_poses.h"
#include "core/survey/survey.h"
#include "worker/poses/pose_options.h"
#include "worker/poses/pose_whitening.h"
#include "worker/rays/ray_source.h"
#include "worker/step/ray_gradients.h"

namespace skyquilt::worker {

class PoseLearner {
 public:
  // Shares of the training's budget: before kBegin nothing is learned; from kAllLevels on all levels of the encoding count.
  static constexpr double kBegin = 0.1, kAllLevels = 0.5;
  static constexpr int64_t kRaysPerUpdate = 64;

  // survey: with the poses as given. source: whose rays are refined; must have the survey's photos.
  PoseLearner(const survey::Survey& survey, const RaySource& source, const PoseLearnerOptions& options);

  bool On() const { return options_.on; }
  bool ActiveAt(double progress) const { return On() && progress >= kBegin; }
  // Share, 0 to 1, of the gradient by position of each of `parts` parts of the encoding, coarse ones first.
  static std::vector<float> LevelShares(double progress, int parts);

  // Adds the gradient of a ray that the source gave, in a batch of 1 / ray_share rays. The sums depend on the order of the rays.
  void Add(const PixelRay& ray, const RayGradient& gradient, double ray_share);
  // Moves the poses of photos with enough rays, takes the common similarity off, and tells the source.
  void Step(double progress, RaySource& source);
  // Tells the source all poses; after the state was changed from outside.
  void Tell(RaySource& source) const;

  // All that a step changes.
  struct State {
    std::vector<double> offsets;                     // [photo][6]: survey::PoseOffset, rotation first
    std::vector<double> gradient, moment1, moment2;  // [photo][6], by whitened coordinates; the gradient summed since the photo's last step
    std::vector<int64_t> rays, steps;                // [photo]: rays in that sum; steps
    std::vector<double> moved_px;                    // [photo]: by which the offset moves places in the photo, root mean square
  };
  State& state() { return state_; }

  // Writes the state under "poses/", nothing when off; the arrays must not change until the writer's Commit.
  void Put(checkpoint::ArchiveWriter& writer) const;
  // Throws base::InputError when the file has none, or of another number of photos. Does nothing when off.
  void Get(const checkpoint::ArchiveReader& reader, const std::filesystem::path& file);

 private:
  void TakeGaugeOff();

  PoseLearnerOptions options_;
  std::vector<geo::Rigid3d> given_;       // enu_from_cam
  std::vector<PoseWhitening> whitening_;  // [photo]; of training photos
  double arm_m_ = 1.0;
  State state_;
};

// The result of a training that refined poses: the offsets of the photos that made a step.
survey::RefinedPoses RefinedPosesOf(const PoseLearner::State& state, const survey::Survey& survey);
// The same of the state that a checkpoint holds; nothing when it holds none. Throws base::InputError for another number of photos.
std::optional<survey::RefinedPoses> ReadRefinedPoses(const checkpoint::ArchiveReader& reader, const std::filesystem::path& file,
                                                     const survey::Survey& survey);

}  // namespace skyquilt::worker
