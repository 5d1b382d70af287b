#include "tour/ways/film.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <string>

#include "tour/ways/route.h"

namespace skyquilt::tour {
namespace {

constexpr double kShortestStay_s = 2.0, kLongestStay_s = 10.0;

std::optional<size_t> IndexOf(const Tour& tour, const std::string& id) {
  const auto found = std::find_if(tour.stops.begin(), tour.stops.end(), [&](const Stop& stop) { return stop.id == id; });
  return found == tour.stops.end() ? std::nullopt : std::optional(static_cast<size_t>(found - tour.stops.begin()));
}

std::optional<size_t> AfterStop(const Tour& tour, size_t stop) {
  const std::optional<Next>& next = tour.stops[stop].next;
  if (!next) return {};
  if (next->to) return IndexOf(tour, *next->to);
  return stop + 1 < tour.stops.size() ? std::optional(stop + 1) : std::nullopt;
}

}  // namespace

std::vector<FilmFrame> FilmOf(const Tour& tour, const Heights* heights, int fps) {
  std::vector<FilmFrame> frames;
  if (tour.stops.empty()) return frames;
  size_t now = tour.start ? IndexOf(tour, *tour.start).value_or(0) : 0;
  std::set<size_t> shown;
  for (;;) {
    const Stop& stop = tour.stops[now];
    const int stay = static_cast<int>(std::lround(std::clamp(stop.pause_s, kShortestStay_s, kLongestStay_s) * fps));
    frames.insert(frames.end(), static_cast<size_t>(stay), {stop.pose, now});
    if (!shown.insert(now).second) return frames;
    const std::optional<size_t> next = AfterStop(tour, now);
    if (!next || *next == now) return frames;
    const Route route(stop.pose, tour.stops[*next].pose, stop.next->path, heights);
    const int steps = static_cast<int>(std::ceil(route.duration_s() * fps));
    for (int k = 1; k < steps; ++k) frames.push_back({route.At(static_cast<double>(k) / fps), 2 * k < steps ? now : *next});
    now = *next;
  }
}

}  // namespace skyquilt::tour
