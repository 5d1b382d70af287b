// A small survey of nadir photos with pixels from a formula, to test the whole training with unusual photos: black, white, one pixel, ...
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "core/base/thread_pool.h"
#include "core/image/pixel_cache.h"
#include "core/survey/survey.h"
#include "worker/trainer.h"

namespace skyquilt::bench {

using PixelFormula = std::function<std::array<uint8_t, 3>(int photo, int x, int y)>;

class EdgeSurvey {
 public:
  static constexpr int kPhotos = 9;

  // Writes the photos into the folder, which is emptied first.
  EdgeSurvey(const std::filesystem::path& folder, int width, int height, const PixelFormula& pixels);

  struct Outcome {
    worker::TrainResult context, block;  // the block is trained only when the context succeeded
    bool finite = false;                 // whether all parameters and moments in the checkpoints are finite
  };
  // Trains context and block for `steps` each. response: for kPhotos photos and one camera.
  Outcome Train(const brightness::Response& response, int steps, base::ThreadPool& threads) const;

 private:
  worker::TrainJob Job(const std::string& name, const brightness::Response& response, int steps) const;

  std::filesystem::path folder_;
  survey::Survey survey_;
  image::PixelCache pixels_;
};

}  // namespace skyquilt::bench
