#include "prepare/georeference/place_problems.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "core/base/text.h"
#include "prepare/georeference/georeference.h"
#include "prepare/georeference/tags/photo_column.h"

namespace skyquilt::prepare::georeference {
namespace {

using survey::Problem;

constexpr double kWarnDrift_m = 5.0;
constexpr double kWarnGround_deg = 5.0;
constexpr const char* kNoScale = "a levelled local frame of unknown scale, and lengths are not metres";
constexpr const char* kRestart = "then run the same command with --restart";

std::string Names(const std::vector<std::string>& names) {
  constexpr size_t kShown = 8;
  const std::string text = base::Join(std::span(names).first(std::min(names.size(), kShown)));
  return names.size() > kShown ? text + fmt::format(" and {} more", names.size() - kShown) : text;
}

const survey::GravityEvidence* Find(const survey::GeoFit& fit, const std::string& kind) {
  for (const survey::GravityEvidence& evidence : fit.gravity) {
    if (evidence.kind == kind) return &evidence;
  }
  return nullptr;
}

// What the direction of gravity rests on.
std::string GravityWords(const PlaceFindings& findings) {
  if (Find(findings.fit, "stated") != nullptr) return "prepare.up";
  return findings.gimbal_used ? "the gimbal angles in the tags" : "the camera axes and the plane of the ground, since the tags have no gimbal angles";
}

void AboutTags(const PlaceFindings& findings, std::vector<Problem>* problems) {
  const survey::GeoFit& fit = findings.fit;
  if (findings.second_group > 0) {
    problems->push_back(
        {"two_groups",
         fmt::format("The GPS tags form two groups {:.0f} m apart: {} tags agree with the place found, and {} others agree with each "
                     "other. The receiver jumped, or flights disagree; tags alone cannot tell which group is right",
                     findings.second_group_m, fit.n_inliers, findings.second_group),
         "Compare the map with a known point on the ground. Remove or re-tag the photos of the wrong group, then run the same command "
         "with --restart",
         true});
  }
  const size_t n = findings.disagreeing.size();
  if (2 * fit.n_inliers < fit.n_matches) {
    problems->push_back({"few_tags_agree",
                         fmt::format("Only {} of {} GPS tags agree with the camera positions found; the place on Earth rests on these few",
                                     fit.n_inliers, fit.n_matches),
                         fmt::format("Look at the residuals under Geo-reference. If most arrows are about equally long, raise "
                                     "prepare.ransac_threshold_m; if the tags are wrong, tag the photos again from the flight log; {}",
                                     kRestart),
                         true});
  } else if (n > 0) {
    problems->push_back(
        {"tags_disagree",
         fmt::format("The GPS {} of {} {} not agree with the camera positions found and {} not used: {}", n == 1 ? "tag" : "tags",
                     n == 1 ? "one photo" : fmt::format("{} photos", n), n == 1 ? "does" : "do", n == 1 ? "is" : "are", Names(findings.disagreeing)),
         "A few bad tags do no harm; compare the residuals under Geo-reference (or in survey/geo_residuals.csv). If good tags are "
         "left out, raise prepare.ransac_threshold_m and run the same command with --restart",
         false});
  }
}

void AboutGravity(const PlaceFindings& findings, std::vector<Problem>* problems) {
  const survey::GeoFit& fit = findings.fit;
  const double allowed_deg = std::max(kWarnConflict_deg, 2.0 * std::hypot(findings.tags_alone_sigma_deg, findings.gravity_sigma_deg));
  if (fit.tags_alone_tilt_deg > allowed_deg) {
    problems->push_back(
        {"gravity_conflict",
         fmt::format(
             "The tagged positions alone would tilt the survey by {:.1f}\xC2\xB0 against gravity. Their heights are taken to be wrong, and the "
             "survey is levelled by {}",
             fit.tags_alone_tilt_deg, GravityWords(findings)),
         "Check the heights of the tags under Geo-reference. Heights of the map refer to the middle of the flight; for exact ones use tags with RTK "
         "or known points on the ground",
         true});
  }
  const survey::GravityEvidence* ground = Find(fit, "ground");
  const double lean_deg = ground == nullptr ? 0.0 : std::hypot(ground->lean_east_deg, ground->lean_north_deg);
  if (!findings.gimbal_used && lean_deg > kWarnGround_deg) {
    constexpr double kCertain_deg = 1.0;
    problems->push_back({"ground_leans",
                         fmt::format("The ground leans by {:.1f}\xC2\xB0 against the result, and the tags have no gimbal angles to tell a slope from "
                                     "tilted cameras. It is mostly taken for a slope; the stated accuracy of the tilt is {:.1f}\xC2\xB0",
                                     lean_deg, fit.accuracy.tilt_deg),
                         "If the ground is known to be level, or heights matter, use photos that keep the drone's gimbal angles (XMP tags survive in "
                         "unedited files), or tags with RTK heights",
                         fit.accuracy.tilt_deg > kCertain_deg});
  }
  if (findings.one_line) {
    problems->push_back({"one_line",
                         fmt::format("All photos lie on about one straight line. Positions on a line leave the tilt across it open: it rests on {}, "
                                     "and is known to {:.1f}\xC2\xB0; a lag of the tags along the line cannot be seen",
                                     GravityWords(findings), fit.accuracy.tilt_deg),
                         "Fly at least one line across, or two parallel ones in opposite directions", true});
  }
}

void AboutHeights(const PlaceFindings& findings, std::vector<Problem>* problems) {
  if (findings.heights != HeightTags::kTagged) {
    const bool relative = findings.heights == HeightTags::kRelative;
    problems->push_back({"no_heights",
                         fmt::format("The GPS tags have no usable heights (none, or all the same). {}, so the height of the survey above the "
                                     "ellipsoid is unknown",
                                     relative ? "Heights above take-off (RelativeAltitude) are used instead" : "Heights are relative to the cameras"),
                         "Use photos with altitude tags. Otherwise shift the heights of the products by a known height on the ground", true});
  } else if (findings.vertical_span_m > kWarnDrift_m) {
    problems->push_back({"height_drift",
                         fmt::format("The tagged heights drift or jump by {:.0f} m against the reconstruction. The survey is level, but its height "
                                     "is only known to {:.0f} m",
                                     findings.vertical_span_m, findings.fit.accuracy.vertical_m),
                         "Shift the heights of the products by a known height on the ground, or use tags with RTK", true});
  }
}

}  // namespace

std::vector<Problem> PlaceProblems(const PlaceFindings& findings) {
  std::vector<Problem> problems;
  AboutGravity(findings, &problems);
  const survey::GeoFit& fit = findings.fit;
  if (fit.accuracy.scale_percent > kWarnScale_percent) {
    problems.push_back(ScaleUncertain(fit.accuracy.scale_percent));
  }
  AboutHeights(findings, &problems);
  AboutTags(findings, &problems);
  std::stable_sort(problems.begin(), problems.end(), [](const Problem& a, const Problem& b) { return a.about_place && !b.about_place; });
  return problems;
}

Problem ScaleUncertain(double scale_percent) {
  return {kScaleUncertain,
          fmt::format("The scale is uncertain by {:.1f} %: a length of 100 m may be off by {:.0f} m", scale_percent, std::max(1.0, scale_percent)),
          "More photos with good tags, spread over a larger area, or tags with RTK make it certain", true};
}

Problem NoPlace(const std::string& code, const std::string& reason, const std::string& advice) {
  return {code, fmt::format("No place on Earth: {}. The survey has {}", reason, kNoScale), advice, true};
}

void SayLengthsAreMetres(std::vector<Problem>* problems) {
  const std::string no_scale = kNoScale;
  for (Problem& problem : *problems) {
    if (const size_t at = problem.finding.find(no_scale); at != std::string::npos) {
      problem.finding.replace(at, no_scale.size(), "a levelled local frame, whose lengths are metres by the scale bars");
    }
  }
}

Problem ColumnProblem() {
  return NoPlace("one_column", "all photos were taken above one another, which leaves the direction of north open",
                 "Add photos that were taken several metres to the side, such as a second column, then run the same command with --restart");
}

Problem OnePlaceProblem(const std::vector<input::PreparedPhoto>& photos, const Eigen::Vector3d& up) {
  const bool equal = AllTagsEqual(photos);
  // Where the tags' heights say nothing, the cameras decide: in a column even right tags would lie at one place.
  const bool same_height = equal && JudgeHeights(photos) != HeightTags::kUnknown;
  if (!same_height && CamerasAboveOneAnother(photos, up)) return ColumnProblem();
  return NoPlace("equal_tags",
                 equal ? "all GPS tags are at one place"
                       : "all GPS tags have one latitude and longitude and differ in height alone, though the cameras were not above one another",
                 "The tags were copied from one photo, or the receiver had no fix. Tag the photos from the flight log, then run the same command "
                 "with --restart");
}

std::vector<Problem> TooUncertain(const survey::GeoFit& fit, bool one_line) {
  const std::string advice =
      fmt::format("Look at survey/geo_residuals.csv: which tags are wrong? Use photos with good GPS tags from several lines, {}", kRestart);
  std::vector<Problem> problems;
  const char* agree_advice =
      "If the tags are less accurate than prepare.ransac_threshold_m, raise it; otherwise tag the photos again from the flight log, then run the "
      "same "
      "command with --restart";
  if (fit.n_inliers < kMinAgreeing) {
    const std::string reason = fmt::format("only {} of {} GPS tags agree, {} are needed", fit.n_inliers, fit.n_matches, kMinAgreeing);
    problems.push_back(NoPlace("too_few_agree", reason, agree_advice));
  } else if (one_line && 2 * fit.n_inliers < fit.n_matches) {
    const std::string reason = fmt::format("the photos lie on one line, and only {} of {} GPS tags agree", fit.n_inliers, fit.n_matches);
    problems.push_back(NoPlace("too_few_agree", reason, agree_advice));
  } else if (!(fit.accuracy.scale_percent <= kMaxScaleSigma_percent)) {
    problems.push_back(NoPlace("scale_unknown", fmt::format("the tags leave the scale uncertain by {:.0f} %", fit.accuracy.scale_percent), advice));
  } else if (!(fit.accuracy.tilt_deg <= kMaxTiltSigma_deg)) {
    problems.push_back(NoPlace("tilt_unknown", fmt::format("the evidence leaves the tilt uncertain by {:.0f}\xC2\xB0", fit.accuracy.tilt_deg),
                               "Use photos that keep the drone's gimbal angles, or with good GPS heights; then run the same command with --restart"));
  }
  return problems;
}

}  // namespace skyquilt::prepare::georeference
