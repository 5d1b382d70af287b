// A handful of photos from straight above, made of any pixels, on disk as a survey: to see what training makes of them.
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
    worker::TrainResult context, block;  // of so many steps each; the block only when the context is good
    bool finite = false;                 // all parameters and moments in the checkpoints
  };
  // response: of kPhotos photos and one camera.
  Outcome Train(const brightness::Response& response, int steps, base::ThreadPool& threads) const;

 private:
  worker::TrainJob Job(const std::string& name, const brightness::Response& response, int steps) const;

  std::filesystem::path folder_;
  survey::Survey survey_;
  image::PixelCache pixels_;
};

}  // namespace skyquilt::bench
