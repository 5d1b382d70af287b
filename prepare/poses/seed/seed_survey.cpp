#include "prepare/poses/seed/seed_survey.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/order_statistics.h"
#include "core/geo/ecef.h"
#include "core/geo/enu_frame.h"
#include "prepare/poses/seed/footprint.h"
#include "prepare/poses/seed/seed_rotation.h"

namespace skyquilt::prepare::poses {
namespace {

// However accurate a tag, the camera is not where the antenna is, and a receiver lags.
constexpr double kLeastHorizontal_m = 1.0, kLeastVertical_m = 2.0;
constexpr double kUnknownHeight_m = 30.0;
constexpr double kMinAgreeingPairs = 0.7;

std::string CountOf(size_t n, size_t of) {
  return std::to_string(n) + " of " + std::to_string(of);
}

std::string PercentOf(double share) {
  return std::to_string(static_cast<int>(std::lround(100.0 * share))) + " %";
}

bool IsFinite(const std::optional<double>& value) {
  return value && std::isfinite(*value);
}

bool HasAngles(const SeedPhoto& photo) {
  return IsFinite(photo.yaw_deg) && IsFinite(photo.pitch_deg);
}

// Tag with height 0 when it has none; nothing when it is not on Earth.
std::optional<geo::Geodetic> UsableTag(const SeedPhoto& photo) {
  if (!photo.gps) return std::nullopt;
  geo::Geodetic tag = *photo.gps;
  if (!std::isfinite(tag.height_m)) tag.height_m = 0.0;
  return geo::IsValid(tag) ? std::optional(tag) : std::nullopt;
}

// The tag nearest to the median of all, so that one wrong tag does not take the frame elsewhere.
geo::Geodetic MiddleTag(const std::vector<geo::Geodetic>& tags) {
  std::array<std::vector<double>, 3> ecef;
  for (const geo::Geodetic& tag : tags) {
    const Eigen::Vector3d x = geo::EcefFromGeodetic(tag);
    for (size_t axis = 0; axis < 3; ++axis) ecef[axis].push_back(x[static_cast<Eigen::Index>(axis)]);
  }
  const Eigen::Vector3d median(base::Median(ecef[0]), base::Median(ecef[1]), base::Median(ecef[2]));
  return *std::min_element(tags.begin(), tags.end(), [&](const geo::Geodetic& a, const geo::Geodetic& b) {
    return (geo::EcefFromGeodetic(a) - median).squaredNorm() < (geo::EcefFromGeodetic(b) - median).squaredNorm();
  });
}

void SetPlaces(const SeedInput& input, const std::vector<geo::Geodetic>& tags, std::vector<bundle::BundlePhoto>* photos) {
  const geo::EnuFrame frame(MiddleTag(tags));
  std::vector<double> heights;
  std::vector<char> has_height(input.photos.size(), 0);
  for (size_t i = 0; i < input.photos.size(); ++i) {
    const auto tag = UsableTag(input.photos[i]);
    if (!tag) continue;
    bundle::BundlePhoto& photo = (*photos)[i];
    photo.gps = frame.EnuFromGeodetic(*tag);
    const double horizontal_m = std::max(input.photos[i].horizontal_sigma_m, kLeastHorizontal_m);
    photo.gps_sigma = Eigen::Vector3d(horizontal_m, horizontal_m, std::max(input.photos[i].vertical_sigma_m, kLeastVertical_m));
    has_height[i] = std::isfinite(input.photos[i].gps->height_m) ? 1 : 0;
    if (has_height[i] != 0) heights.push_back(photo.gps->z());
  }
  const double usual = heights.empty() ? 0.0 : base::Median(heights);
  for (size_t i = 0; i < photos->size(); ++i) {
    bundle::BundlePhoto& photo = (*photos)[i];
    if (!photo.gps || has_height[i] != 0) continue;
    photo.gps->z() = usual;
    photo.gps_sigma.z() = kUnknownHeight_m;
  }
}

std::vector<Eigen::Vector3d> RaysOf(const SeedSurvey& survey, const SeedPair& pair, size_t side, size_t step) {
  const uint32_t photo = side == 0 ? pair.a : pair.b;
  const bundle::BundleLens& lens = survey.lenses[static_cast<size_t>(survey.photos[photo].lens)];
  std::vector<Eigen::Vector3d> rays;
  rays.reserve(pair.features.size() / step + 1);
  for (size_t k = 0; k < pair.features.size(); k += step) {
    rays.push_back(lens.camera.RayFromImg(survey.input->photos[photo].features[pair.features[k][side]].cast<double>()));
  }
  return rays;
}

struct Tried {
  SeedStart start;
  GroundCheck check;
  size_t n_known = 0;
  bool Agrees() const { return check.height_m > 0.0 && 2 * check.n_pairs >= n_known && check.share_agreeing >= kMinAgreeingPairs; }
};

Tried Try(const SeedSurvey& survey, std::vector<SeedView> views, bool by_gimbal) {
  Tried tried;
  tried.check = CheckGround(survey.rays, views);
  for (SeedView& view : views) {
    if (view.known) view.cam_from_enu = Turned(view.cam_from_enu, tried.check.turn_rad);
    tried.n_known += view.known ? 1 : 0;
  }
  tried.start = {by_gimbal, std::move(views), tried.check.height_m};
  return tried;
}

// Per pair: whether its matches are by chance, as few are between photos that show different ground by their tags. Enough of them bend a survey
// whose parts have no others in common.
std::vector<char> FindWrongPairs(const SeedSurvey& survey, const SeedStart& start) {
  std::vector<char> wrong = FindChancePairs(survey.rays, survey.photos.size());
  const auto footprint = [&](uint32_t i) {
    const SeedView& view = start.views[i];
    return FootprintOf(survey.lenses[static_cast<size_t>(survey.photos[i].lens)].camera, view.cam_from_enu, view.centre, start.height_m);
  };
  for (size_t k = 0; k < wrong.size(); ++k) {
    const SeedPair& pair = survey.pairs[k];
    const bool known = start.views[pair.a].known && start.views[pair.b].known;
    if (!known || !footprint(pair.a).IsFarFrom(footprint(pair.b))) wrong[k] = 0;
  }
  return wrong;
}

}  // namespace

bool MakeSeedSurvey(const SeedInput& input, SeedSurvey* survey, std::string* reason) {
  survey->input = &input;
  const size_t n = input.photos.size();
  std::vector<geo::Geodetic> tags;
  for (const SeedPhoto& photo : input.photos) {
    if (const auto tag = UsableTag(photo)) tags.push_back(*tag);
  }
  if (tags.size() < 3 || static_cast<double>(tags.size()) < kMinTagged * static_cast<double>(n)) {
    *reason = "only " + CountOf(tags.size(), n) + " photos have a GPS tag";
    return false;
  }
  std::map<uint32_t, int> lens_of;
  for (const auto& [id, seed] : input.cameras) {
    const auto numbers = bundle::LensOf(seed.camera);
    if (!numbers || !seed.camera.Problem().empty()) {
      *reason = "camera model " + camera::ModelName(seed.camera.model) + " is left to the mapper";
      return false;
    }
    lens_of.emplace(id, static_cast<int>(survey->lenses.size()));
    survey->lenses.push_back({*numbers, *numbers, seed.camera, seed.focal_is_known ? seed.focal_sigma : kGuessedFocalSigma,
                              std::max(seed.camera.width, seed.camera.height) / bundle::kUnitWidth_px});
    survey->lenses.back().exact = seed.exact;
  }
  std::map<uint32_t, uint32_t> index;
  survey->photos.resize(n);
  for (uint32_t i = 0; i < n; ++i) {
    const SeedPhoto& photo = input.photos[i];
    const bool is_new = index.emplace(photo.image_id, i).second;
    SKYQUILT_CHECK(is_new, "image " + std::to_string(photo.image_id) + " twice");
    const auto lens = lens_of.find(photo.camera_id);
    SKYQUILT_CHECK(lens != lens_of.end(), "no camera " + std::to_string(photo.camera_id));
    survey->photos[i].lens = lens->second;
    survey->photos[i].shot = photo.shot;
    survey->photos[i].cam_from_rig = photo.cam_from_rig;
  }
  SetPlaces(input, tags, &survey->photos);
  for (const PairMatches& matches : input.pairs) {
    const auto a = index.find(matches.image_a), b = index.find(matches.image_b);
    SKYQUILT_CHECK(a != index.end() && b != index.end(), "pair of unknown images");
    if (a->second == b->second || matches.features.size() < kLeastPairMatches) continue;
    for (const auto& [feature_a, feature_b] : matches.features) {
      SKYQUILT_CHECK(feature_a < input.photos[a->second].features.size() && feature_b < input.photos[b->second].features.size(), "unknown feature");
    }
    survey->pairs.push_back({a->second, b->second, matches.features});
  }
  if (survey->pairs.empty()) {
    *reason = "no two photos have enough matches";
    return false;
  }
  for (const SeedPair& pair : survey->pairs) {
    const size_t step = std::max<size_t>(1, (pair.features.size() + kMaxRays - 1) / kMaxRays);
    survey->rays.push_back({pair.a, pair.b, RaysOf(*survey, pair, 0, step), RaysOf(*survey, pair, 1, step), pair.features.size()});
  }
  return true;
}

std::vector<SeedStart> FindStarts(const SeedSurvey& survey, std::string* reason) {
  const std::vector<SeedPhoto>& photos = survey.input->photos;
  size_t n_angles = 0, n_oblique = 0;
  std::vector<SeedView> by_gimbal(photos.size()), looking_down(photos.size());
  for (size_t i = 0; i < photos.size(); ++i) {
    const SeedPhoto& photo = photos[i];
    if (!survey.photos[i].gps) continue;
    looking_down[i] = {true, Eigen::Quaterniond::Identity(), *survey.photos[i].gps};
    if (!HasAngles(photo)) continue;
    ++n_angles;
    const double roll_deg = IsFinite(photo.roll_deg) ? *photo.roll_deg : 0.0;
    by_gimbal[i] = {true, RotationFromAngles(*photo.yaw_deg, *photo.pitch_deg, roll_deg), *survey.photos[i].gps};
    constexpr double kMaxOffNadir_deg = 25.0;
    n_oblique += std::abs(*photo.pitch_deg + 90.0) > kMaxOffNadir_deg ? 1 : 0;
  }
  std::vector<SeedStart> starts;
  *reason = "only " + CountOf(n_angles, photos.size()) + " photos have gimbal angles";
  if (static_cast<double>(n_angles) >= kMinTagged * static_cast<double>(photos.size())) {
    Tried tried = Try(survey, std::move(by_gimbal), true);
    if (tried.Agrees()) {
      starts.push_back(std::move(tried.start));
    } else {
      *reason = "gimbal angles and positions agree with only " + PercentOf(tried.check.share_agreeing) + " of " +
                std::to_string(tried.check.n_pairs) + " pairs of matched photos";
    }
  }
  if (4 * n_oblique > photos.size()) {
    *reason += ", and the photos do not look straight down";
    return starts;
  }
  const auto rotations = RotationsLookingDown(survey.rays, looking_down);
  for (size_t i = 0; i < photos.size(); ++i) {
    looking_down[i].known = rotations[i].has_value();
    if (rotations[i]) looking_down[i].cam_from_enu = *rotations[i];
  }
  Tried tried = Try(survey, std::move(looking_down), false);
  if (tried.Agrees()) {
    starts.push_back(std::move(tried.start));
  } else {
    *reason += "; cameras that look straight down would agree with only " + PercentOf(tried.check.share_agreeing) + " of " +
               std::to_string(tried.check.n_pairs) + " pairs";
  }
  return starts;
}

bundle::BundleProblem MakeBundle(const SeedSurvey& survey, const SeedStart& start, base::ThreadPool& threads) {
  bundle::BundleProblem bundle;
  bundle.photos = survey.photos;
  bundle.lenses = survey.lenses;
  for (size_t i = 0; i < bundle.photos.size(); ++i) {
    const SeedView& view = start.views[i];
    if (!view.known) continue;
    bundle::BundlePhoto& photo = bundle.photos[i];
    photo.placed = true;
    photo.cam_from_enu = view.cam_from_enu;
    photo.centre = view.centre;
    photo.tagged_rotation = view.cam_from_enu;
  }
  const std::vector<char> wrong = FindWrongPairs(survey, start);
  std::vector<bundle::IndexedPair> pairs(survey.pairs.size());
  threads.ParallelFor(static_cast<int64_t>(pairs.size()), [&](int64_t k, int) {
    base::ThrowIfCancelled();
    const SeedPair& pair = survey.pairs[static_cast<size_t>(k)];
    const PairRays rays{pair.a, pair.b, RaysOf(survey, pair, 0, 1), RaysOf(survey, pair, 1, 1), pair.features.size()};
    const std::vector<char> like = MovesLikeOthers(rays, start.views);
    bundle::IndexedPair& kept = pairs[static_cast<size_t>(k)];
    kept.a = pair.a;
    kept.b = pair.b;
    if (wrong[static_cast<size_t>(k)] != 0) return;
    for (size_t m = 0; m < pair.features.size(); ++m) {
      if (like[m] != 0) kept.features.push_back(pair.features[m]);
    }
  });
  std::vector<size_t> n_features;
  for (const SeedPhoto& photo : survey.input->photos) n_features.push_back(photo.features.size());
  bundle.tracks = bundle::JoinMatches(pairs, n_features);
  bundle.pixel.reserve(bundle.tracks.entries.size());
  for (const bundle::TrackEntry& entry : bundle.tracks.entries)
    bundle.pixel.push_back(survey.input->photos[entry.photo].features[entry.feature].cast<double>());
  bundle.point.assign(bundle.tracks.size(), Eigen::Vector3d::Zero());
  bundle.has_point.assign(bundle.tracks.size(), 0);
  bundle.agrees.assign(bundle.tracks.entries.size(), 0);
  return bundle;
}

}  // namespace skyquilt::prepare::poses
