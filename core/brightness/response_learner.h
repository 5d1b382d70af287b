// Learns what tags do not tell about the photos' brightness, beside the field: gains per photo and colour. Adam in the logarithm of light; photos
// without a gradient in a step keep their gains and moments. Vignetting is not learned so: a field that is still learning is worse in the corners of
// photos, where fewer of them overlap, and that looks like vignetting.
// Gains and the field's colours are known up to a common factor only. Where every training photo learns, their mean logarithm is therefore
// taken off after every step: a projection, because a penalty would let field and gains drift apart into opposite casts.
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/brightness/response.h"
#include "core/checkpoint/archive.h"

namespace skyquilt::brightness {

struct LearnerOptions {
  std::vector<uint8_t> learns_gain;  // per photo
  // Per photo: tag weight: how strongly its gain is drawn to what its tags say, in pixels per pixel of it that training sees. What neighbouring
  // photos show outweighs a hundredth of that; what only drifts along over a whole survey, such as light on water, does not. Empty: none.
  std::vector<float> tag_weight;
  bool anchored = false;    // some training photos keep their gains, so the others have no common factor to drift by
  bool vignetting = false;  // of the cameras, from tie points alone

  bool Gains() const { return std::find(learns_gain.begin(), learns_gain.end(), uint8_t{1}) != learns_gain.end(); }
};

class ResponseLearner {
 public:
  // Writes into `response`, which must outlive it.
  ResponseLearner(Response& response, const LearnerOptions& options);

  bool active() const { return active_ && !resting_; }
  // One more pixel: d loss / d log gain per colour, and the pixel's share of the loss.
  void Add(size_t photo, const float gradient[3], float weight);
  // One step with what was added since the last; progress in [0, 1] of the training sets the rate. Not finite: nothing changes.
  void Step(double progress);
  // What is to be learned is known already, and better than a field that is still learning could tell: nothing changes any more.
  void Rest() { resting_ = true; }

  // Moments and counts under "learner/"; with the response they are all of the state.
  void Put(checkpoint::ArchiveWriter& writer) const;
  // Throws base::InputError when they belong to another number of photos.
  void Get(const checkpoint::ArchiveReader& reader, const std::filesystem::path& file);

 private:
  void Update(float rate);
  void TakeOffMean();

  Response& response_;
  LearnerOptions options_;
  bool active_ = false, resting_ = false;
  std::vector<float> moment1_, moment2_;  // [photo][colour]
  std::vector<int64_t> steps_;            // updates of each photo
  std::vector<double> gradient_;          // of this step
  std::vector<uint8_t> touched_;          // photos with a gradient
  std::vector<double> weight_;            // per photo, of this step's pixels
};

}  // namespace skyquilt::brightness
