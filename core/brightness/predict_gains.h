// Held-out photos must be rendered at their own brightness before they can be scored, but their gains were never learned. They are predicted from
// the photos' tags and from the learned gains of photos taken before and after them.
#pragma once

#include <vector>

#include "core/brightness/response.h"

namespace skyquilt::brightness {

struct CapturedPhoto {
  double order = 0.0;    // capture time in seconds, or any number that rises with it
  int group = 0;         // one number per flight and camera: gains are interpolated within a group only
  bool learned = false;  // its log_gain is known
  bool tagged = true;    // its exif_gain comes from tags
};

// How far the tags explain the differences in brightness between successive photos: 1 fully, 0 not at all (automatic exposure followed the light,
// and the photos are equally bright). Least squares over successive tagged, learned photos of each group; 1 when the tags hardly change.
double TagReliability(const Response& response, const std::vector<CapturedPhoto>& photos);

// Sets log_gain of the photos that are not learned; `photos` has one entry per photo of the response.
// The part of the gain that the trusted tags do not explain is interpolated over time between the learned photos of the group. It is then shrunk
// towards the mean: the less, the better such interpolation predicts the learned photos themselves. A tagged photo is predicted from tagged photos
// only. For a photo without tags the whole gain is interpolated. Photos of groups without learned photos keep their log_gain.
void PredictGains(const std::vector<CapturedPhoto>& photos, Response& response);

}  // namespace skyquilt::brightness
