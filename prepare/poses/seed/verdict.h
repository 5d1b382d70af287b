// Judges the poses by the matches: which photos keep theirs, and whether the whole can be trusted.
#pragma once

#include <optional>
#include <string>

#include "prepare/bundle/bundle_problem.h"

namespace skyquilt::prepare::poses {

// Takes the pose from photos with fewer than kLeastObservations agreeing entries or with less than kLeastShare of those that should agree, and from
// those that share points only with few others: the largest group that is tied together by at least kLeastShared common points each remains. With
// `height_m`, the height above ground, so does every other group that shows other ground, or from other sides, and whose tags hold it: at least
// kLeastOfPart photos have them, and angles, or they are on no line. Returns the number of photos that lost their pose. Entries must be up to date
// (Triangulate).
size_t RemoveContradicted(bundle::BundleProblem& bundle, std::optional<double> height_m = {});
constexpr double kLeastShare = 0.25;
constexpr size_t kLeastShared = 10;
constexpr size_t kLeastOfPart = 8;

// A photo without a pose is a stranger when it has fewer tracks than this in common with each placed photo, and fewer than this share of what placed
// photos have with the one that is most like them. Photos of another place have 17 to 30 matches by chance that agree with one geometry.
constexpr size_t kStrangersMatches = 40;
constexpr double kStrangersShare = 0.25;
// More than this share of all photos are no strangers, but a part of the survey that lacks a connection.
constexpr double kMaxStrangers = 0.1;

struct Verdict {
  bool good = false;
  std::string reason;           // why not
  size_t n_matched = 0;         // photos with at least kLeastObservations entries that are no strangers
  size_t n_placed = 0;          // photos with a pose
  double median_error = 0.0;    // of agreeing entries, units
  double share_agreeing = 0.0;  // of the entries of placed photos that could agree
  double median_gps_m = 0.0;    // horizontal distance to the tags; 0 without tags
};

// `height_m` is the height above ground: tags that are off by a good part of it contradict the matches.
Verdict Judge(const bundle::BundleProblem& bundle, double height_m);

}  // namespace skyquilt::prepare::poses
