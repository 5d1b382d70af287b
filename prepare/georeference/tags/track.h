// The path of the camera over time, to find where it was when a lagging receiver took a tag's position.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "prepare/input/prepared_photo.h"

namespace skyquilt::prepare::georeference {

struct TrackPoint {
  Eigen::Vector3d position;  // in the model's frame
  Eigen::Vector3d velocity;  // model units per second; zero where unknown
};

// Straight lines between the photos of a flight, in the order of time.
class Track {
 public:
  // `flight` is the flight of each photo.
  Track(const std::vector<input::PreparedPhoto>& photos, const std::vector<int>& flight);

  // Most photos have a time, and the camera moves between them: a lag of the tags can be estimated.
  bool timed() const { return timed_; }
  // Where the camera of photo i was `lag_s` before it was taken. Beyond the ends of a flight its first or last line is extended. Photos without time
  // do not move.
  TrackPoint Before(size_t i, double lag_s) const;
  // Photos in the order of time within flights; those without time follow in name order.
  const std::vector<size_t>& order() const { return order_; }
  // Position of a photo in its flight, -0.5 for the first to 0.5 for the last, by time or, for flights without times, by name.
  double Phase(size_t i) const { return phase_[i]; }

 private:
  struct Node {
    double time_s;
    Eigen::Vector3d position;
  };
  std::vector<Eigen::Vector3d> centre_;
  std::vector<std::vector<Node>> nodes_;  // per flight, times strictly increasing
  std::vector<int> flight_;
  std::vector<std::optional<double>> time_s_;
  std::vector<size_t> order_;
  std::vector<double> phase_;
  bool timed_ = false;
};

}  // namespace skyquilt::prepare::georeference
