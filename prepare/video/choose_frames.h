// Which frames of a video become photos: neighbours overlap as asked for, and of frames that would do the sharpest is taken.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "prepare/video/frame_motion.h"

namespace skyquilt::prepare::video {

struct Candidate {
  double time_s = 0.0;
  double sharpness = 0.0;  // SharpnessOf; only compared with others of the video
  FrameShift from_first;   // how the first frame of the section is shown in this one
  int section = 0;         // rising; the picture jumped between frames of different ones, and nothing relates them
};

enum class FrameReason {
  kFirst,    // of the video
  kJump,     // the first after a jump
  kOverlap,  // overlaps the chosen one before as asked for
  kSharper,  // overlaps it more, because those that overlap as asked for are blurred
  kFast,     // overlaps it less, because the picture moves too fast for the frames that there are
  kLast      // before a jump or the end: overlaps it more
};

struct ChosenFrame {
  size_t candidate = 0;  // index
  FrameReason reason = FrameReason::kFirst;
  double overlap = 0.0;   // share of the frame that the chosen one before shows too; below 0: none, and as far away. 0 without one before
  size_t n_compared = 1;  // candidates that would have done, of which this is the sharpest
};

// Frames whose overlap is within a fifth of the new share, 1 - overlap, and at most 0.05 of the one asked for. A camera that stands still gives one
// frame. aspect: height over width. overlap: 0 to below 1. The candidates are in order of time.
std::vector<ChosenFrame> ChooseFrames(std::span<const Candidate> candidates, double aspect, double overlap);

struct VideoCandidates {
  std::vector<Candidate> candidates;
  double aspect = 1.0;
};
struct FrameChoice {
  std::vector<std::vector<ChosenFrame>> frames;  // of each video
  double overlap = 0.0;                          // that was asked of them
  bool thinned = false;                          // even without overlap there were too many: evenly chosen ones of these
};
// Of several videos together at most `limit` frames (above 0; 0: any number): where there would be more, with less overlap.
FrameChoice ChooseFramesOfAll(const std::vector<VideoCandidates>& videos, double overlap, int limit);

}  // namespace skyquilt::prepare::video
