// Learns the shading of photos (shading.h) by Adam while a field trains, under a prior that keeps it small and smooth.
// Learning starts when the field's colours are roughly known: before that, whatever the field does not show yet would look like shading.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/brightness/response.h"
#include "core/brightness/shading.h"
#include "core/checkpoint/archive.h"

namespace skyquilt::brightness {

class ShadingLearner {
 public:
  // Adam's state; empty without shading. Together with the response it is all that a step changes.
  struct Moments {
    std::vector<float> first, second;  // [photo][knot]
    std::vector<int64_t> steps;        // number of updates per photo
  };

  // Writes into response.shading, which has the grid of the options. `response` must outlive it.
  ShadingLearner(Response& response, ShadingOptions options);

  bool On() const { return options_.On(); }
  bool Learns() const { return On() && !frozen_; }
  // From then on shading stays as it is: call it when tie points have given it.
  void Freeze() { frozen_ = true; }
  // Adds the gradient of one pixel: d loss / d log light, summed over its colours. weight: the pixel's share of the loss, 1 / rays of the batch.
  void Add(size_t photo, const PicturePlace& place, float gradient, float weight);
  // One step with the gradients added since the last one, and the projection after it. progress: of the training, 0..1. Photos without pixels in this
  // step, or with a gradient that is not finite, are only projected.
  void Step(double progress, Moments& moments);

  // Of the pixels since the last step, [photo][knot], without the prior.
  const std::vector<double>& gradient() const { return gradient_; }

  Moments EmptyMoments() const;
  // Writes the moments under "learner/"; nothing without shading.
  void Put(const Moments& moments, checkpoint::ArchiveWriter& writer) const;
  // Throws base::InputError when the file has other sizes.
  void Get(const checkpoint::ArchiveReader& reader, const std::filesystem::path& file, Moments& moments);

 private:
  void Update(size_t photo, float rate, Moments& moments);

  Response& response_;
  ShadingOptions options_;
  bool frozen_ = false;
  std::vector<double> gradient_;  // of this step, [photo][knot]
  std::vector<double> weight_;    // per photo: sum of the weights of this step's pixels
};

}  // namespace skyquilt::brightness
