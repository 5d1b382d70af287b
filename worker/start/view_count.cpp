#include "worker/start/view_count.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "core/base/cancel.h"
#include "core/base/progress.h"
#include "worker/start/view_counter.h"

namespace skyquilt::worker {

std::vector<Tile> TilesWithEnoughViews(const RaySource& source, const survey::Survey& survey, const std::vector<int>& photos,
                                       const scene::HeightMap& surface, const PointRanges& ranges, int min_views, base::ThreadPool& threads) {
  std::vector<Tile> all = TrainingTiles(survey, photos);
  if ((surface.Empty() && ranges.Empty()) || min_views < 2) return all;
  const ViewCounter counter(survey, photos, [&source](int photo) -> const camera::Camera& { return source.CameraOf(photo); });
  std::vector<uint8_t> enough(all.size(), 0);
  constexpr size_t kManyPhotos = 1000;  // from which this takes seconds
  constexpr size_t kPart = 65'536;      // between parts, an interruption is noticed
  std::optional<base::Progress> progress;
  if (photos.size() >= kManyPhotos) progress.emplace("set-up: views of the photos", static_cast<double>(all.size()), "tiles");
  for (size_t begin = 0; begin < all.size(); begin += kPart) {
    base::ThrowIfCancelled();
    const size_t end = std::min(all.size(), begin + kPart);
    threads.ParallelFor(static_cast<int64_t>(end - begin), [&](int64_t k, int) {
      const size_t i = begin + static_cast<size_t>(k);
      Eigen::Vector3d origin, direction, x;
      source.RayThrough(all[i].photo, source.TileCentre(all[i]), &origin, &direction);
      if (ranges.Empty()) {
        enough[i] = !surface.Intersect(origin, direction, &x) || counter.Count(x, 0.0, min_views) >= min_views ? 1 : 0;
        return;
      }
      const PointRanges::Range& range = ranges.Of(all[i]);
      const double middle_m = std::sqrt(static_cast<double>(range.nearest) * static_cast<double>(range.farthest));
      x = origin + std::min(middle_m, static_cast<double>(range.plane)) * direction;
      const auto shows = [&](int photo) { return ranges.MayShow(photo, x, 0.0); };
      enough[i] = !range.Known() || counter.Count(x, 0.0, min_views, shows) >= min_views ? 1 : 0;
    });
    if (progress) progress->Update(static_cast<double>(end));
  }
  if (std::ranges::find(enough, 1) == enough.end()) return all;
  size_t kept = 0;
  for (size_t i = 0; i < all.size(); ++i) {
    if (enough[i] != 0) all[kept++] = all[i];
  }
  all.resize(kept);
  return all;
}

}  // namespace skyquilt::worker
