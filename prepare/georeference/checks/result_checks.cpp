#include "prepare/georeference/checks/result_checks.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>
#include <numbers>

#include "core/base/log.h"
#include "core/base/order_statistics.h"
#include "prepare/georeference/place_problems.h"
#include "prepare/input/prepared_photo.h"
#include "prepare/poses/focal_check.h"
#include "prepare/poses/seed/seed_rotation.h"

namespace skyquilt::prepare::georeference {
namespace {

using Urgency = Contradiction::Urgency;

constexpr int kLeastCompared = 3;
constexpr double kStraightDown_deg = 25.0, kMostlyDown = 0.75;
constexpr double kFewPhotos = 0.1;  // share of photos whose angles may be wrong without a word
constexpr const char* kAgain = "then run the same command with --restart";

double ExcessOf(double ratio) {
  return std::max(ratio, 1.0 / ratio) - 1.0;
}

// Focal lengths of the result against the tags.
struct FocalFinding {
  int n_tagged = 0;  // photos
  int n_far = 0;     // of these
  // Of the camera with the most photos among those that are far off, else of the one with the most tagged ones, else of any.
  double found_px = 0.0, tagged_px = 0.0, longer_side_px = 0.0;
  bool Tagged(size_t n_photos) const { return 2 * static_cast<size_t>(n_tagged) > n_photos; }
  bool Far() const { return static_cast<double>(n_far) > poses::kMaxFarFocal * static_cast<double>(n_tagged); }
};

FocalFinding CompareFocals(const std::vector<CheckedPhoto>& photos) {
  struct Entry {
    std::vector<double> tagged_px;
    double found_px = 0.0, longer_side_px = 0.0;
    int n = 0;
  };
  std::map<int, Entry> entries;
  for (const CheckedPhoto& photo : photos) {
    Entry& entry = entries[photo.camera];
    entry.found_px = photo.focal_px;
    entry.longer_side_px = photo.longer_side_px;
    ++entry.n;
    if (photo.tagged_focal_px) entry.tagged_px.push_back(*photo.tagged_focal_px);
  }
  FocalFinding finding;
  int most = -1;
  bool most_is_far = false;
  for (const auto& [camera, entry] : entries) {
    const auto n_tagged = static_cast<int>(entry.tagged_px.size());
    const double tagged_px = entry.tagged_px.empty() ? 0.0 : base::Median(entry.tagged_px);
    const bool near = entry.found_px >= poses::kShortestFocal * tagged_px && entry.found_px <= poses::kLongestFocal * tagged_px;
    const bool far = n_tagged > 0 && !near;
    finding.n_tagged += n_tagged;
    finding.n_far += far ? n_tagged : 0;
    const int size = n_tagged > 0 ? n_tagged + entry.n : 0;
    if ((most_is_far && !far) || (most_is_far == far && size <= most)) continue;
    most = size;
    most_is_far = far;
    finding.found_px = entry.found_px;
    finding.tagged_px = tagged_px;
    finding.longer_side_px = entry.longer_side_px;
  }
  return finding;
}

double FilmFocal(double focal_px, double longer_side_px) {
  return longer_side_px > 0.0 ? poses::kFilmWidth_mm * focal_px / longer_side_px : 0.0;
}

poses::HeightAboveTakeOff HeightsOfPhotos(const CheckedResult& result) {
  if (!result.georeferenced) return {};
  std::vector<double> found, tagged;
  for (const CheckedPhoto& photo : result.photos) {
    found.push_back(photo.agl_m);
    tagged.push_back(photo.relative_altitude_m.value_or(std::numeric_limits<double>::quiet_NaN()));
  }
  return poses::CompareHeights(found, tagged);
}

bool LooksDown(const CheckedResult& result) {
  const double limit = std::cos(kStraightDown_deg * std::numbers::pi / 180.0);
  const auto n = std::count_if(result.photos.begin(), result.photos.end(),
                               [&](const CheckedPhoto& photo) { return -(photo.cam_from_enu.conjugate() * Eigen::Vector3d::UnitZ()).z() > limit; });
  return static_cast<double>(n) >= kMostlyDown * static_cast<double>(result.photos.size());
}

// Above ground, metres; 0 when none is known.
double MedianHeight(const CheckedResult& result) {
  std::vector<double> heights_m;
  for (const CheckedPhoto& photo : result.photos) {
    if (std::isfinite(photo.agl_m)) heights_m.push_back(photo.agl_m);
  }
  return heights_m.empty() ? 0.0 : base::Median(std::move(heights_m));
}

bool DiffersNotably(const FocalFinding& focal) {
  return focal.tagged_px > 0.0 && std::abs(focal.found_px / focal.tagged_px - 1.0) > poses::kUsualFocalError;
}

// Why the photos do not check the focal length of the tags, a sentence without its full stop. Empty when they do, when that is unknown, or when the
// lens may have been calibrated or control points decide.
std::string FocalDoubt(const CheckedResult& result) {
  if (!result.own_poses || result.by_control) return "";
  const double sigma = result.focal_sigma ? result.focal_sigma() : 0.0;
  // What the photos say should tell an unusual error by three standard deviations.
  if (3.0 * sigma > poses::kUsualFocalError) {
    constexpr double kTellsNothing = 0.5;
    return sigma < kTellsNothing ? fmt::format("The photos alone tell the focal length to {:.0f} % only", 100.0 * sigma)
                                 : "The photos alone do not tell the focal length";
  }
  if (result.scale_percent > kWarnScale_percent) {
    return fmt::format("Photos and GPS tags do not fit each other well (the scale is uncertain by {:.1f} %), as with a wrong focal length",
                       result.scale_percent);
  }
  return "";
}

std::string HeightText(const poses::HeightAboveTakeOff& height) {
  return fmt::format("the cameras are {:.0f} m above the ground, and RelativeAltitude says {:.0f} m", height.found_m, height.tagged_m);
}

void AboutFocal(const CheckedResult& result, const FocalFinding& focal, const poses::HeightAboveTakeOff& height, ResultChecks* checks) {
  if (!focal.Far()) return;
  const bool decides = result.georeferenced && !result.by_control;
  Contradiction found{.code = "focal_far",
                      .n_photos = focal.n_far,
                      .found = fmt::format("The focal length found is {:.0f} px", focal.found_px),
                      .tags = fmt::format("the tags of {} photos say {:.0f} px", focal.n_far, focal.tagged_px),
                      .cause = {},
                      .remedy = {},
                      .urgency = decides ? Urgency::kPlace : Urgency::kWarning};
  const std::string correct =
      fmt::format("correct the focal length of the tags (the one found is {:.0f} mm for a film of 35 mm; exiftool -FocalLengthIn35mmFormat=...), {}",
                  FilmFocal(focal.found_px, focal.longer_side_px), kAgain);
  if (height.Known() && !height.Notable()) {
    found.cause = fmt::format("The tagged focal length is probably wrong (cropped or enlarged photos, another lens), as {}", HeightText(height));
    found.remedy = "Compare with a known height. If the survey is right, " + correct;
    found.urgency = Urgency::kWarning;
  } else if (height.Known()) {
    found.cause = fmt::format("The one found is probably wrong, and heights by the same factor: {}", HeightText(height));
    found.remedy = fmt::format("Add photos at an angle or from another height, or give a model with a calibrated lens (--model), {}", kAgain);
  } else {
    found.cause = "One of both is wrong, and nothing else decides. If it is the one found, heights are wrong by the same factor";
    found.remedy = "Compare with a known height. If the survey is wrong, add photos at an angle or from another height; if it is right, " + correct;
    if (decides) {
      checks->scale_doubt = std::max(checks->scale_doubt, ExcessOf(focal.found_px / focal.tagged_px));
      checks->height_doubt_m = MedianHeight(result) * std::abs(1.0 - focal.tagged_px / focal.found_px);
    }
  }
  checks->contradictions.push_back(std::move(found));
}

void AboutHeight(const CheckedResult& result, const FocalFinding& focal, const poses::HeightAboveTakeOff& height, ResultChecks* checks) {
  if (!height.Notable()) return;
  const bool tagged = focal.Tagged(result.photos.size());
  const bool decides = !result.by_control;
  // Two tags that do not know each other say the same of the result.
  const bool both_differ = tagged && (height.ratio - 1.0) * (focal.found_px - focal.tagged_px) > 0.0 && DiffersNotably(focal);
  // Where the focal length is known, hills are the likeliest cause of a small difference.
  const bool small = tagged && !both_differ && !focal.Far() && !height.Differs() && FocalDoubt(result).empty();
  Contradiction found{.code = height.Contradicts() ? "height_contradicts" : "height_differs",
                      .n_photos = height.n,
                      .found = fmt::format("The cameras are {:.0f} m above the ground (median)", height.found_m),
                      .tags = fmt::format("the RelativeAltitude tags of {} photos say {:.0f} m above take-off", height.n, height.tagged_m),
                      .cause = {},
                      .remedy = {},
                      .urgency = decides && height.Contradicts() ? Urgency::kPlace
                                 : small                         ? Urgency::kNote
                                                                 : Urgency::kWarning};
  const double better_mm = FilmFocal(focal.found_px / height.ratio, focal.longer_side_px);
  const std::string take_off = fmt::format("take-off was {:.0f} m {} the ground of the survey", std::abs(height.found_m - height.tagged_m),
                                           height.found_m > height.tagged_m ? "above" : "below");
  const std::string tag_it = fmt::format(
      "If take-off was level with the ground, tag a focal length of about {:.1f} mm for a film of 35 mm (exiftool "
      "-FocalLengthIn35mmFormat=...), {}",
      better_mm, kAgain);
  if (result.by_control) {
    found.cause = fmt::format("Control points decide here: {}, or the tags are wrong", take_off);
    found.remedy = "Compare with a known height on the ground";
  } else if (focal.Far() || both_differ) {
    found.cause = fmt::format("The focal length contradicts its tags too: it is probably wrong, and heights by the same factor. Or {}", take_off);
    found.remedy = focal.Far()
                       ? "See what is said about the focal length"
                       : fmt::format("Add photos at an angle or from another height, or give a model with a calibrated lens (--model), {}", kAgain);
  } else if (!tagged) {
    found.cause = fmt::format(
        "There is no focal length tag (none, or 0), so the focal length of {:.0f} px rests on the photos alone, and photos that look straight down "
        "hardly tell it: it and all heights are probably wrong by the same factor. Or {}",
        focal.found_px, take_off);
    found.remedy = tag_it;
  } else {
    found.cause =
        fmt::format("Either {}, or the tagged focal length is wrong (cropped or enlarged photos, another lens), and heights with it", take_off);
    found.remedy = tag_it;
  }
  if (decides && (height.Contradicts() || !tagged || focal.Far() || both_differ)) {
    checks->scale_doubt = std::max(checks->scale_doubt, ExcessOf(height.ratio));
    checks->height_doubt_m = std::max(checks->height_doubt_m, std::abs(height.found_m - height.tagged_m));
  }
  checks->contradictions.push_back(std::move(found));
}

// Nothing to compare with.
void AboutWitnesses(const CheckedResult& result, const FocalFinding& focal, const poses::HeightAboveTakeOff& height, ResultChecks* checks) {
  if (height.Known() || !result.georeferenced || result.by_control || !result.own_poses || !LooksDown(result)) return;
  Contradiction found{.code = "height_unchecked",
                      .n_photos = static_cast<int>(result.photos.size()),
                      .found = "The photos look straight down",
                      .tags = "have no RelativeAltitude tags to compare the height above ground with",
                      .cause = "It follows the focal length of the tags: where that is wrong, heights are wrong by the same factor",
                      .remedy = "Compare with a known height, or add photos at an angle or from another height",
                      .urgency = Urgency::kNote};
  if (!focal.Tagged(result.photos.size())) {
    found.code = "focal_unknown";
    found.tags = "have neither focal length nor RelativeAltitude tags";
    found.cause = fmt::format(
        "The focal length of {:.0f} px rests on the photos alone, which hardly tell it: it and all heights may be far off by the "
        "same factor",
        focal.found_px);
    found.remedy =
        fmt::format("Tag the focal length (exiftool -FocalLengthIn35mmFormat=...), {}. Or add photos at an angle or from another height", kAgain);
    found.urgency = Urgency::kWarning;
    constexpr double kGuessed = 0.5;
    checks->height_doubt_m = std::max(checks->height_doubt_m, kGuessed * MedianHeight(result));
  } else if (!focal.Far() && DiffersNotably(focal)) {
    found.code = "focal_differs";
    found.cause = fmt::format(
        "The focal length found is {:.0f} px, and its tags say {:.0f} px: photos that look straight down hardly tell it, and heights are wrong by "
        "the "
        "same factor if the tags are right",
        focal.found_px, focal.tagged_px);
    found.urgency = Urgency::kWarning;
    checks->scale_doubt = std::max(checks->scale_doubt, ExcessOf(focal.found_px / focal.tagged_px));
  } else if (const std::string doubt = focal.Far() ? "" : FocalDoubt(result); !doubt.empty()) {
    found.cause = fmt::format(
        "{}. It follows the tags, which say {:.0f} mm for a film of 35 mm: where they are wrong (cropped or enlarged photos, another lens), heights "
        "are wrong by the same factor",
        doubt, FilmFocal(focal.tagged_px, focal.longer_side_px));
    found.remedy = fmt::format(
        "Compare the focal length with the data sheet of the drone's camera and correct the tags (exiftool -FocalLengthIn35mmFormat=...), {}. Or "
        "compare with a known height, or add photos at an angle or from another height",
        kAgain);
    found.urgency = Urgency::kWarning;
    checks->height_doubt_m = std::max(checks->height_doubt_m, poses::kUsualFocalError * MedianHeight(result));
  }
  checks->contradictions.push_back(std::move(found));
}

const char* FaultText(GimbalFault fault) {
  switch (fault) {
    case GimbalFault::kOppositePitch:
      return "The pitch has the opposite sign: it should be -90 for a camera that looks straight down";
    case GimbalFault::kFromStraightDown:
      return "The pitch is measured from straight down: it should be -90, not 0, for a camera that looks straight down";
    case GimbalFault::kAllZero:
      return "All angles are 0, which this drone or program writes for \"no value\"";
    default:
      return "The angles may be those of the aircraft or of another photo, or the photos were turned";
  }
}

void AboutGimbal(const CheckedResult& result, ResultChecks* checks) {
  std::map<GimbalFault, int> n_of;
  int n_with = 0, n_off = 0;
  for (const CheckedPhoto& photo : result.photos) {
    if (!photo.gimbal_pitch_deg) continue;
    ++n_with;
    const GimbalFault fault =
        FaultOfAngles(input::UpInCamera(*photo.gimbal_pitch_deg, photo.gimbal_roll_deg.value_or(0.0)), photo.cam_from_enu * Eigen::Vector3d::UnitZ());
    if (fault == GimbalFault::kNone) continue;
    ++n_off;
    ++n_of[fault];
  }
  const char* remedy =
      "Correct or remove the GimbalPitchDegree and GimbalRollDegree tags (exiftool -XMP-drone-dji:GimbalPitchDegree=... on the photos)";
  if (result.gimbal.use == GimbalUse::kDoubted) {
    checks->tilt_doubt_deg = result.gimbal.angle_deg;
    checks->contradictions.push_back({.code = "gimbal_doubted",
                                      .n_photos = n_with,
                                      .found = fmt::format("By the axes of the cameras, up is elsewhere by {:.0f}\xC2\xB0", result.gimbal.angle_deg),
                                      .tags = "the survey is levelled by the gimbal angles of the tags",
                                      .cause = "One of both is wrong, and neither the ground nor the GPS tags decide",
                                      .remedy = std::string(remedy) + ", if the survey stands on its side or is mirrored; " + kAgain,
                                      .urgency = Urgency::kPlace});
  }
  if (n_off < kLeastCompared || static_cast<double>(n_off) <= kFewPhotos * n_with) return;
  const GimbalFault usual = std::max_element(n_of.begin(), n_of.end(), [](const auto& a, const auto& b) { return a.second < b.second; })->first;
  const bool dropped = result.gimbal.use == GimbalUse::kDropped;
  checks->contradictions.push_back(
      {.code = "gimbal_contradicts",
       .n_photos = n_off,
       .found = fmt::format("The cameras look elsewhere than the gimbal angles of {} of {} photos say", n_off, n_with),
       .tags = dropped ? "photos and GPS tags agree with each other, so gimbal angles are not used" : "these angles have lost their weight",
       .cause = FaultText(usual),
       .remedy = std::string(remedy) + ", " + kAgain,
       .urgency = dropped || 2 * n_off > n_with ? Urgency::kPlace : Urgency::kWarning});
}

// Turn of the tagged directions about the vertical. The place does not depend on it, but the search for poses is slower with wrong ones.
void AboutYaw(const CheckedResult& result, ResultChecks* checks) {
  if (!result.georeferenced) return;
  constexpr double kTurned_deg = 45.0, kAlike = 0.9;
  std::complex<double> sum = 0.0;
  int n = 0;
  for (const CheckedPhoto& photo : result.photos) {
    if (!photo.gimbal_pitch_deg || !photo.gimbal_yaw_deg) continue;
    const Eigen::Quaterniond tagged = poses::RotationFromAngles(*photo.gimbal_yaw_deg, *photo.gimbal_pitch_deg, photo.gimbal_roll_deg.value_or(0.0));
    const Eigen::Matrix3d turn = (photo.cam_from_enu.conjugate() * tagged).toRotationMatrix();
    const std::complex<double> about_up(turn(0, 0) + turn(1, 1), turn(1, 0) - turn(0, 1));
    if (!(std::abs(about_up) > 1.0)) continue;  // up differs
    sum += about_up / std::abs(about_up);
    ++n;
  }
  if (n < kLeastCompared || std::abs(sum) < kAlike * n) return;
  const double turn_deg = std::arg(sum) * 180.0 / std::numbers::pi;
  if (!(std::abs(turn_deg) > kTurned_deg)) return;
  checks->contradictions.push_back(
      {.code = "gimbal_turned",
       .n_photos = n,
       .found = fmt::format("By the GPS tags the cameras are turned {:.0f}\xC2\xB0 to the {}", std::abs(turn_deg), turn_deg > 0.0 ? "left" : "right"),
       .tags = fmt::format("the gimbal yaw of {} photos does not say so", n),
       .cause = "The camera is mounted across, or the yaw is that of the aircraft or counted from another direction",
       .remedy = "The place does not depend on it. Correct the GimbalYawDegree tags if other programs need them",
       .urgency = Urgency::kWarning});
}

}  // namespace

survey::Problem Contradiction::ToProblem() const {
  return {code, fmt::format("{}, but {}. {}", found, tags, cause), remedy, urgency == Urgency::kPlace};
}

ResultChecks CheckResult(const CheckedResult& result) {
  ResultChecks checks;
  if (result.photos.empty()) return checks;
  checks.height = HeightsOfPhotos(result);
  const FocalFinding focal = CompareFocals(result.photos);
  AboutFocal(result, focal, checks.height, &checks);
  AboutHeight(result, focal, checks.height, &checks);
  AboutWitnesses(result, focal, checks.height, &checks);
  AboutGimbal(result, &checks);
  AboutYaw(result, &checks);
  return checks;
}

void ApplyChecks(const ResultChecks& checks, survey::Survey& survey) {
  geo::PlaceAccuracy& accuracy = survey.fit.accuracy;
  const double scale_percent = 100.0 * checks.scale_doubt;
  if (scale_percent > accuracy.scale_percent) {
    accuracy.scale_percent = scale_percent;
    // It would state the smaller number.
    std::erase_if(survey.problems, [](const survey::Problem& problem) { return problem.code == kScaleUncertain; });
    if (scale_percent > kWarnScale_percent) survey.problems.push_back(ScaleUncertain(scale_percent));
  }
  // An unknown height stays unknown.
  if (checks.height_doubt_m > accuracy.vertical_m) accuracy.vertical_m = checks.height_doubt_m;
  if (checks.tilt_doubt_deg > accuracy.tilt_deg) accuracy.tilt_deg = checks.tilt_doubt_deg;
  bool any = false;
  for (const Contradiction& contradiction : checks.contradictions) {
    if (contradiction.urgency == Urgency::kNote) {
      const survey::Problem note = contradiction.ToProblem();
      base::LogInfo("{}. {}", note.finding, note.advice);
      continue;
    }
    survey.problems.push_back(contradiction.ToProblem());
    any = true;
  }
  if (!any) return;
  std::stable_sort(survey.problems.begin(), survey.problems.end(),
                   [](const survey::Problem& a, const survey::Problem& b) { return a.about_place && !b.about_place; });
}

}  // namespace skyquilt::prepare::georeference
