// How far the picture moves from one frame of a video to a later one, by tracked corners in small grey frames.
#pragma once

#include <optional>
#include <vector>

#include "core/image/image.h"

namespace skyquilt::prepare::video {

// Where a point of one frame is in another: scaled, turned and shifted. In shares of the frame's width, from its middle, x right and y down.
struct FrameShift {
  double a = 1.0, b = 0.0;  // scale times cosine and sine of the turn
  double right = 0.0, down = 0.0;

  FrameShift Then(const FrameShift& next) const;  // of both, one after the other
  FrameShift Inverse() const;
};

// How much is new in a frame that shows the former like this: 0 for the same picture, 1 where it has moved by its whole width or height; more when it
// has moved on. For a shift along one side exactly the share of the frame that the former does not show; turns and changes of scale count by how far
// they move points half-way to the edges. aspect: height over width.
double NewShare(const FrameShift& shift, double aspect);

struct TrackedShift {
  FrameShift shift;
  int n_corners = 0;   // that were looked for
  int n_agreeing = 0;  // of them, those that moved like `shift`
};

// Tracks from frame to frame; keeps only the last one. Not thread-safe.
class FrameTracker {
 public:
  // Size that frames are tracked at: wide ones are made so small.
  static constexpr int kWidth = 192;

  // grey: one channel, of any size, the same for all frames. Returns the shift from the frame given before to this one; nothing for the first frame,
  // and where corners do not agree: after a cut, a jump of more than 40 % of the width, or where there are none (water, darkness, blur).
  std::optional<TrackedShift> Track(const image::Image8& grey);
  // Whether the frame given last has enough corners to be tracked.
  bool HasCorners() const { return static_cast<int>(corners_.size()) >= kFewestCorners; }

 private:
  static constexpr int kFewestCorners = 10;
  struct Point {
    float x = 0.0F, y = 0.0F;
  };
  image::Image8 before_;
  std::vector<Point> corners_;  // of before_
  FrameShift last_;             // frames that follow each other often move alike
};

// Variance of the Laplacian of a grey frame: of frames that show nearly the same, the sharper one has more. 0 for a frame of less than 3 x 3 pixels.
double SharpnessOf(const image::Image8& grey);

}  // namespace skyquilt::prepare::video
