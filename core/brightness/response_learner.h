// Exposure tags do not explain all differences in brightness: clouds pass and white balance changes. The learner fits a gain per photo and colour
// while the field trains, so that the field does not have to explain these differences.
// Adam on the logarithm of the gains; photos without a gradient in a step keep their gains and moments.
// Gains and the field's colours are determined only up to a common factor. When every training photo learns, the mean log gain is therefore
// subtracted after every step. This is a projection and not a penalty: with a penalty, field and gains would drift into opposite colour casts.
// Vignetting is not learned this way: an unfinished field has larger errors in the corners of photos, where fewer photos overlap, and that looks
// like vignetting (worker/start/tie_point_gains.h solves for it instead).
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/brightness/response.h"
#include "core/brightness/shading_learner.h"
#include "core/checkpoint/archive.h"

namespace skyquilt::brightness {

struct LearnerOptions {
  std::vector<uint8_t> learns_gain;  // per photo: 1 learns its gain, 0 keeps it
  // Per photo, >= 0: strength of a quadratic prior that keeps log_gain near 0, that is, the total gain near what the tags say. 1 counts as much as
  // the pixels of the photo themselves. At a weight of about 0.01 differences between overlapping photos still win over the prior, but a slow drift
  // over the whole survey, such as light on water, does not. Empty: no prior.
  std::vector<float> tag_weight;
  bool anchored = false;        // some training photos keep their gains and fix the common factor: the mean is not subtracted
  bool vignetting = false;      // also solve for the cameras' vignetting, from tie points only
  size_t held_vignetting = 0;   // of so many first cameras it is known and stays
  ShadingOptions shading = {};  // of the photos, from tie points and then while the field trains

  // Whether any photo learns its gain.
  bool Gains() const { return std::find(learns_gain.begin(), learns_gain.end(), uint8_t{1}) != learns_gain.end(); }
};

class ResponseLearner {
 public:
  // Writes into `response`, which must outlive it.
  ResponseLearner(Response& response, const LearnerOptions& options);

  // Whether gains or shading are learned while the field trains.
  bool active() const { return LearnsGains() || shading_.Learns(); }
  bool LearnsGains() const { return active_ && !frozen_; }
  // Gradients of shading are added to it.
  ShadingLearner& shading() { return shading_; }
  // Adds the gradient of one pixel: d loss / d log gain per colour. weight: the pixel's share of the loss, 1 / rays of the batch.
  void Add(size_t photo, const float gradient[3], float weight);
  // One Adam step with the gradients added since the last step. progress: of the training, 0..1, sets the learning rate. Photos whose gradient is not
  // finite keep their gains.
  void Step(double progress);
  // Freezes the gains: call it when tie points have given better gains than an unfinished field could. Shading is frozen by itself.
  void Freeze() { frozen_ = true; }

  // Adam's state.
  struct Moments {
    std::vector<float> first, second;  // [photo][colour]
    std::vector<int64_t> steps;        // number of updates per photo
    ShadingLearner::Moments shading;
  };
  // Together with the response they are all that a step changes: whoever keeps both can go back to them.
  Moments& moments() { return moments_; }

  // Writes moments and counts under "learner/". Together with the response they are the complete state.
  void Put(checkpoint::ArchiveWriter& writer) const;
  // Throws base::InputError when the file has another number of photos.
  void Get(const checkpoint::ArchiveReader& reader, const std::filesystem::path& file);

 private:
  void Update(float rate);
  void SubtractMean();

  Response& response_;
  LearnerOptions options_;
  ShadingLearner shading_;
  bool active_ = false, frozen_ = false;
  Moments moments_;
  std::vector<double> gradient_;  // of this step
  std::vector<uint8_t> touched_;  // per photo: has a gradient in this step
  std::vector<double> weight_;    // per photo: sum of the weights of this step's pixels
};

}  // namespace skyquilt::brightness
