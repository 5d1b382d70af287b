#include "tour/pictures/estimate_seconds.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <vector>

namespace skyquilt::tour {
namespace {

constexpr int kRuns = 32;
constexpr int64_t kRunRays = 1024;  // neighbours, because single rays would find nothing in cache

}  // namespace

double EstimateSeconds(std::span<const PictureRequest> requests, const PictureField& field) {
  int64_t total = 0;
  for (const PictureRequest& request : requests) total += request.Rays();
  if (total == 0) return 0.0;
  // Where in the sequence of all rays a run begins. Even distances could meet the sky only, or the ground, since pictures are rendered tile by tile.
  std::vector<int64_t> begins;
  for (int run = 0; run < kRuns; ++run) {
    const double share = std::fmod((run + 0.5) * (std::numbers::phi - 1.0), 1.0);
    begins.push_back(static_cast<int64_t>(share * static_cast<double>(total)));
  }
  std::sort(begins.begin(), begins.end());
  std::map<std::string, std::vector<render::Ray>> rays;  // per exposure
  int64_t taken = 0, before = 0;
  auto begin = begins.begin();
  for (const PictureRequest& request : requests) {
    const int64_t end = before + request.Rays();
    if (begin != begins.end() && *begin < end) {
      const PictureRays picture_rays(request, field.cones);
      const std::vector<size_t> order = PixelsInOrder(request);
      for (; begin != begins.end() && *begin < end; ++begin) {
        const auto first = static_cast<size_t>(*begin - before);
        const std::span<const size_t> run = std::span(order).subspan(first, std::min(static_cast<size_t>(kRunRays), order.size() - first));
        std::vector<render::Ray>& some = rays[request.exposure];
        some.resize(some.size() + run.size());
        picture_rays.Make(run, std::span(some).last(run.size()));
        taken += static_cast<int64_t>(run.size());
      }
    }
    before = end;
  }
  double seconds = 0.0;
  for (const auto& [exposure, some] : rays) {
    const products::RayCaster caster = field.caster(exposure);
    std::vector<render::RayColor> colors(some.size());
    const auto start = std::chrono::steady_clock::now();
    caster(some, colors);
    seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }
  return seconds * static_cast<double>(total) / static_cast<double>(taken);
}

}  // namespace skyquilt::tour
