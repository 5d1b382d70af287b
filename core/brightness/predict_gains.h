// Gains of photos that training never saw, from their tags and from the photos taken before and after them.
#pragma once

#include <vector>

#include "core/brightness/response.h"

namespace skyquilt::brightness {

struct CapturedPhoto {
  double order = 0.0;    // seconds of capture, or any number that rises with it
  int group = 0;         // flight and camera: light and settings of another say nothing
  bool learned = false;  // its log_gain is known
  bool tagged = true;    // its exif_gain says something
};

// How far tags explain the differences in brightness from one photo to the next: 1 fully, 0 not at all (the shutter followed the light, and
// the photos are equally bright). Least squares over tagged neighbours in time of one group; 1 where tags hardly change.
double TrustInTags(const Response& response, const std::vector<CapturedPhoto>& photos);

// Sets log_gain of the photos that are not learned: what remains beyond the trusted part of the tags, interpolated over time between the
// learned photos of the group, and drawn towards the mean as far as neighbours fail to predict learned photos. Tagged photos go by tagged ones
// alone; a photo without tags takes over all of the gain between its neighbours. Groups without learned photos keep theirs. One entry per photo of
// the response.
void PredictGains(const std::vector<CapturedPhoto>& photos, Response& response);

}  // namespace skyquilt::brightness
