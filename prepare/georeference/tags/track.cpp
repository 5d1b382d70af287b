#include "prepare/georeference/tags/track.h"

#include <algorithm>
#include <numeric>

namespace skyquilt::prepare::georeference {

Track::Track(const std::vector<input::PreparedPhoto>& photos, const std::vector<int>& flight) : flight_(flight), order_(photos.size()) {
  size_t n_timed = 0;
  for (const input::PreparedPhoto& photo : photos) {
    centre_.push_back(photo.cam_from_model.OriginInSource());
    time_s_.push_back(photo.file.tags.capture_time_s);
    n_timed += photo.file.tags.capture_time_s ? 1 : 0;
  }
  std::iota(order_.begin(), order_.end(), size_t{0});
  std::stable_sort(order_.begin(), order_.end(), [&](size_t a, size_t b) {
    if (flight_[a] != flight_[b]) return flight_[a] < flight_[b];
    if (time_s_[a].has_value() != time_s_[b].has_value()) return time_s_[a].has_value();
    return time_s_[a] && *time_s_[a] < *time_s_[b];
  });
  nodes_.resize(static_cast<size_t>(input::CountFlights(flight_)));
  std::vector<std::vector<size_t>> members(nodes_.size());
  size_t n_moving = 0;
  for (const size_t i : order_) {
    const auto f = static_cast<size_t>(flight_[i]);
    members[f].push_back(i);
    if (!time_s_[i]) continue;
    std::vector<Node>& nodes = nodes_[f];
    // Photos of the same second share a node; the first one's place is as good as any.
    if (!nodes.empty() && !(*time_s_[i] > nodes.back().time_s)) continue;
    if (!nodes.empty() && (centre_[i] - nodes.back().position).norm() > 0.0) ++n_moving;
    nodes.push_back({*time_s_[i], centre_[i]});
  }
  timed_ = 5 * n_timed >= 4 * photos.size() && 2 * n_moving >= n_timed && n_moving >= 2;
  phase_.resize(photos.size(), 0.0);
  for (size_t f = 0; f < members.size(); ++f) {
    const std::vector<Node>& nodes = nodes_[f];
    const bool by_time = nodes.size() >= 2;
    const double span_s = by_time ? nodes.back().time_s - nodes.front().time_s : 0.0;
    for (size_t k = 0; k < members[f].size(); ++k) {
      const size_t i = members[f][k];
      if (by_time) {
        phase_[i] = time_s_[i] ? (*time_s_[i] - nodes.front().time_s) / span_s - 0.5 : 0.0;
      } else if (members[f].size() > 1) {
        phase_[i] = static_cast<double>(k) / static_cast<double>(members[f].size() - 1) - 0.5;
      }
    }
  }
}

TrackPoint Track::Before(size_t i, double lag_s) const {
  const std::vector<Node>& nodes = nodes_[static_cast<size_t>(flight_[i])];
  if (!time_s_[i] || nodes.size() < 2) return {centre_[i], Eigen::Vector3d::Zero()};
  const double time_s = *time_s_[i] - lag_s;
  // The line that ends at the first node at or after that time; for no lag the one just flown.
  auto end = std::lower_bound(nodes.begin(), nodes.end(), time_s, [](const Node& node, double t) { return node.time_s < t; });
  end = std::clamp(end, nodes.begin() + 1, nodes.end() - 1);
  const Node& a = *(end - 1);
  const Node& b = *end;
  const Eigen::Vector3d velocity = (b.position - a.position) / (b.time_s - a.time_s);
  // Relative to the photo's own place, so that no lag gives exactly that place even where photos share a second.
  if (lag_s == 0.0) return {centre_[i], velocity};
  return {a.position + (time_s - a.time_s) * velocity, velocity};
}

}  // namespace skyquilt::prepare::georeference
