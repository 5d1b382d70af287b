#include "evaluate/photos/scored_pixels.h"

#include <cmath>

#include "core/base/file.h"

namespace skyquilt::evaluate::photos {
namespace {

constexpr double kErrorSteps = 254.0;

}  // namespace

image::Image8 ScoredPixels(const image::Image8& photo, const image::Image8& render, const image::Image8& scored) {
  image::Image8 values(scored.width, scored.height, 1);
  for (size_t i = 0; i < scored.data.size(); ++i) {
    if (scored.data[i] == 0) continue;
    double sum = 0.0;
    for (size_t c = 0; c < 3; ++c) {
      const double difference = (static_cast<double>(photo.data[3 * i + c]) - static_cast<double>(render.data[3 * i + c])) / 255.0;
      sum += difference * difference;
    }
    values.data[i] = static_cast<uint8_t>(1 + std::lround(kErrorSteps * std::pow(sum / 3.0, 0.25)));
  }
  return values;
}

double SquaredErrorOf(uint8_t value) {
  return std::pow((value - 1) / kErrorSteps, 4.0);
}

std::filesystem::path ScoredPixelsFile(const std::filesystem::path& folder, const std::string& photo) {
  return folder / (photo + ".png");
}

void WriteScoredPixels(const ScoredPhoto& scored, const std::filesystem::path& folder) {
  const std::filesystem::path file = ScoredPixelsFile(folder, scored.findings.score.name);
  base::RequireWritableFolder(file.parent_path());
  image::SavePng(ScoredPixels(scored.task.photo, scored.findings.render, scored.findings.scored), file);
}

}  // namespace skyquilt::evaluate::photos
