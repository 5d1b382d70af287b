// Turns videos into photos: chosen frames as JPEGs with the tags that a drone's photos have, so that all that follows works as with photos.
#pragma once

#include <filesystem>
#include <vector>

#include "core/survey/exif.h"
#include "prepare/video/track.h"

namespace skyquilt::prepare::video {

struct VideoOptions {
  double overlap = 0.75;        // share of a frame that the next chosen one shows too, 0 to below 1
  int limit = 500;              // most frames of all videos together; 0: any number
  int size = 0;                 // longer side of the frames in pixels where the video's is longer; 0: as the video
  double clock_offset_s = 0.0;  // what the videos' clock is behind UTC, for logs beside them
};

// Where the frames are: FOLDER/frames.
std::filesystem::path FramesFolder(const std::filesystem::path& folder);

// Writes to `folder`:
//   frames/VIDEO_00012345ms.jpg   the chosen frames, named by their time in the video; tags: place, heights, gimbal, exposure, focal length and time
//   as far
//                                 as files beside the video, or subtitles in it, tell them (find_tracks.h)
//   frames.csv                    a row for each with the reason why it was chosen; written last
//   frames.json                   the choice, so that a second call goes on where the first was interrupted
// Every file is complete or missing. A second call with the same videos and options finds the frames finished, one with others makes all anew.
// Throws base::InputError for videos that cannot be read, without ffmpeg, or when fewer than three frames are found; base::Interrupted.
void ProvideFrames(const std::vector<std::filesystem::path>& videos, const VideoOptions& options, const std::filesystem::path& folder);

// Tags of a frame at this state.
survey::PhotoTags TagsOf(const TrackPoint& state, double position_step_deg);

}  // namespace skyquilt::prepare::video
