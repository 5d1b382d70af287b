#include "prepare/poses/seed/point_colors.h"

#include <algorithm>
#include <array>
#include <mutex>
#include <unordered_map>
#include <vector>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/base/progress.h"
#include "core/image/image.h"

namespace skyquilt::prepare::poses {

void ColorPoints(survey::ColmapModel& model, const survey::ColmapObservations& observations, const std::filesystem::path& photo_root,
                 base::ThreadPool& threads) {
  std::unordered_map<uint64_t, size_t> index;
  for (size_t k = 0; k < model.points.size(); ++k) index.emplace(model.points[k].id, k);
  // Whole numbers, whose sums do not depend on the order of the photos.
  std::vector<std::array<uint32_t, 4>> sums(model.points.size());
  std::mutex mutex;
  base::Progress progress("color points", static_cast<double>(model.images.size()), "photos");
  threads.ParallelFor(static_cast<int64_t>(model.images.size()), [&](int64_t task, int) {
    base::ThrowIfCancelled();
    const survey::ColmapImage& photo = model.images[static_cast<size_t>(task)];
    const auto list = observations.find(photo.id);
    if (list == observations.end() || list->second.empty()) return;
    const camera::Camera& camera = model.cameras.at(photo.camera_id);
    image::Image8 pixels;
    try {
      pixels = image::LoadReducedRgb8(photo_root / photo.name, std::max(1, camera.width / 4));
    } catch (const base::InputError& error) {
      base::LogWarning("{}; its points get their colors from other photos", error.what());
      return;
    }
    const double scale_x = static_cast<double>(pixels.width) / camera.width, scale_y = static_cast<double>(pixels.height) / camera.height;
    const std::lock_guard lock(mutex);
    for (const survey::ColmapObservation& observation : list->second) {
      const auto found = index.find(observation.point_id);
      if (found == index.end()) continue;
      const int x = std::clamp(static_cast<int>(observation.pixel.x() * scale_x), 0, pixels.width - 1);
      const int y = std::clamp(static_cast<int>(observation.pixel.y() * scale_y), 0, pixels.height - 1);
      std::array<uint32_t, 4>& sum = sums[found->second];
      for (size_t c = 0; c < 3; ++c) sum[c] += pixels.At(x, y)[c];
      ++sum[3];
    }
    progress.Advance();
  });
  progress.Finish();
  for (size_t k = 0; k < sums.size(); ++k) {
    if (sums[k][3] == 0) continue;
    for (size_t c = 0; c < 3; ++c) model.points[k].rgb[c] = static_cast<uint8_t>((sums[k][c] + sums[k][3] / 2) / sums[k][3]);
  }
}

}  // namespace skyquilt::prepare::poses
