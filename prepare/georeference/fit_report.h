// Turns the result of the adjustment into what a survey stores: accuracy, evidence, corrections.
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "core/geo/place_accuracy.h"
#include "core/survey/geo_fit.h"
#include "prepare/georeference/georeference.h"
#include "prepare/georeference/place_adjustment.h"

namespace skyquilt::prepare::georeference {

// `vertical_span_m`: range of the height errors that were found.
geo::PlaceAccuracy AccuracyOf(const Adjustment& adjustment, const std::vector<Tag>& tags, HeightTags heights, double vertical_span_m);
// The evidence for gravity with its share of the information on the final tilt; `tags_share` is that of the tags. The heights of the tags are not in
// it.
std::vector<survey::GravityEvidence> ShownEvidence(const Gravity& gravity, const Eigen::Quaterniond& enu_from_model, double tags_share);
// The heights of the tags as evidence; `n` tags.
survey::GravityEvidence HeightEvidence(const Adjustment& adjustment, int n, double tags_share);
// Offset and drift per flight; `flight` is that of each photo. 0 for flights without tags.
void ReportBias(const std::vector<int>& flight, const std::vector<Tag>& tags, const Adjustment& adjustment, survey::GeoFit& fit);

// Tags that disagree with the result by about the same horizontal shift, as after a jump of the receiver.
struct SecondGroup {
  int n = 0;
  double distance_m = 0.0;
};
// At least a fifth of the tags, and four; `noise_m`: standard deviation of the tags per axis.
SecondGroup FindSecondGroup(const std::vector<Tag>& tags, const Georeference& result, double noise_m);

}  // namespace skyquilt::prepare::georeference
