// Frames of a video, one after the other, as ffmpeg decodes them: nothing but the present one is in memory.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/child_process.h"
#include "core/image/image.h"

namespace skyquilt::prepare::video {

struct TimeSpan {
  double from_s = 0.0, to_s = 0.0;  // both included
};

struct FrameRequest {
  std::filesystem::path video;
  int width = 0, height = 0;         // of the frames that are given out; the video is scaled to it. Upright
  bool grey = false;                 // one channel instead of RGB
  bool deinterlace = false;          //
  bool key_frames_only = false;      // those that are decoded alone: about one per second, at a tenth of the time
  double step_s = 0.0;               // the first frame, and then the next that is this much later; 0: every frame
  std::vector<TimeSpan> spans = {};  // if not empty: only frames within these
  bool skip_to_spans = true;         // fast to the first of them; else all before it is decoded
};

struct VideoFrame {
  double time_s = 0.0;      // presentation time since the beginning of the file: frames need not be equally far apart
  bool interlaced = false;  // stored as two fields
  image::Image8 pixels;
};

class FrameStream {
 public:
  // Throws base::InputError when ffmpeg cannot be started.
  explicit FrameStream(const FrameRequest& request);

  // False at the end. Throws base::Interrupted when cancelled.
  bool Next(VideoFrame* frame);

  // After the end: what went wrong, in ffmpeg's words; empty when nothing did. A damaged video may have given frames before.
  const std::string& Problem() const { return problem_; }

 private:
  struct FrameNote {
    double time_s = 0.0;
    bool interlaced = false;
  };
  void ReadNotes();
  void ReadNote(const std::string& line);
  void End();

  FrameRequest request_;
  double offset_s_ = 0.0;  // added to the times that ffmpeg says
  base::ChildProcess ffmpeg_;
  std::string output_, messages_;
  std::vector<FrameNote> notes_;  // of frames to come
  double time_base_s_ = 0.0;
  std::string problem_;
  bool ended_ = false;
};

}  // namespace skyquilt::prepare::video
