#include "prepare/poses/join_parts.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <unordered_map>
#include <unordered_set>

#include "core/base/log.h"
#include "core/base/order_statistics.h"
#include "core/geo/enu_frame.h"
#include "core/linear/linear.h"
#include "prepare/poses/loose_photos.h"
#include "prepare/poses/seed/footprint.h"
#include "prepare/poses/seed/seed_rotation.h"
#include "prepare/poses/seed/verdict.h"

namespace skyquilt::prepare::poses {
namespace {

constexpr double kLeastAgreeing = 0.7;  // of the tags
constexpr double kFewLike = 0.1;        // of a part's photos, for parts that show other ground

struct TaggedPose {
  Eigen::Vector3d centre;                                 // in the model
  Eigen::Vector3d place;                                  // ENU metres
  std::optional<Eigen::Quaterniond> enu_from_model = {};  // by gimbal angles
};

bool IsFinite(const std::optional<double>& value) {
  return value && std::isfinite(*value);
}

std::optional<geo::Geodetic> PlaceOf(const survey::PhotoTags& tags) {
  if (!tags.gps) return std::nullopt;
  geo::Geodetic place = *tags.gps;
  if (!std::isfinite(place.height_m)) place.height_m = IsFinite(tags.relative_altitude_m) ? *tags.relative_altitude_m : 0.0;
  return geo::IsValid(place) ? std::optional(place) : std::nullopt;
}

std::vector<TaggedPose> TaggedPosesOf(const survey::ColmapModel& model, const std::vector<input::PhotoFile>& photos,
                                      const std::optional<geo::Geodetic>& about) {
  std::unordered_map<std::string, const survey::PhotoTags*> tags_of;
  std::optional<geo::EnuFrame> frame;
  if (about) frame.emplace(*about);
  for (const input::PhotoFile& photo : photos) {
    const auto place = PlaceOf(photo.tags);
    if (!place) continue;
    if (!frame) frame.emplace(*place);
    tags_of.emplace(photo.name, &photo.tags);
  }
  std::vector<TaggedPose> poses;
  for (const survey::ColmapImage& image : model.images) {
    const auto found = tags_of.find(image.name);
    if (found == tags_of.end()) continue;
    const survey::PhotoTags& tags = *found->second;
    TaggedPose& pose = poses.emplace_back();
    pose.centre = image.cam_from_world.OriginInSource();
    pose.place = frame->EnuFromGeodetic(*PlaceOf(tags));
    if (!IsFinite(tags.gimbal_yaw_deg) || !IsFinite(tags.gimbal_pitch_deg)) continue;
    const double roll_deg = IsFinite(tags.gimbal_roll_deg) ? *tags.gimbal_roll_deg : 0.0;
    pose.enu_from_model =
        (RotationFromAngles(*tags.gimbal_yaw_deg, *tags.gimbal_pitch_deg, roll_deg).conjugate() * image.cam_from_world.rotation).normalized();
  }
  return poses;
}

// The one that most others are near to, averaged with these. Nothing when angles are missing or contradict each other.
std::optional<Eigen::Quaterniond> RotationByAngles(const std::vector<TaggedPose>& poses) {
  constexpr double kNear_rad = 10.0 * std::numbers::pi / 180.0;
  std::vector<Eigen::Quaterniond> turns;
  for (const TaggedPose& pose : poses) {
    if (pose.enu_from_model) turns.push_back(*pose.enu_from_model);
  }
  if (turns.size() < kLeastOfPart) return std::nullopt;
  constexpr size_t kMostTried = 200;
  const size_t step = (turns.size() + kMostTried - 1) / kMostTried;
  size_t best = 0, most = 0;
  for (size_t i = 0; i < turns.size(); i += step) {
    const auto n = static_cast<size_t>(
        std::count_if(turns.begin(), turns.end(), [&](const Eigen::Quaterniond& turn) { return turn.angularDistance(turns[i]) < kNear_rad; }));
    if (n > most) {
      most = n;
      best = i;
    }
  }
  if (static_cast<double>(most) < kLeastAgreeing * static_cast<double>(poses.size())) return std::nullopt;
  Eigen::Vector4d sum = Eigen::Vector4d::Zero();
  for (const Eigen::Quaterniond& turn : turns) {
    if (turn.angularDistance(turns[best]) < kNear_rad) sum += turn.dot(turns[best]) < 0.0 ? -turn.coeffs() : turn.coeffs();
  }
  return Eigen::Quaterniond(Eigen::Vector4d(sum.normalized()));
}

// Scale, yaw and position for a level frame.
geo::Similarity3d FitLevelled(const std::vector<TaggedPose>& poses, const std::vector<char>& used, const Eigen::Quaterniond& level) {
  using Complex = std::complex<double>;
  Eigen::Vector3d from = Eigen::Vector3d::Zero(), to = from;
  double n = 0.0;
  for (size_t i = 0; i < poses.size(); ++i) {
    if (used[i] == 0) continue;
    from += level * poses[i].centre;
    to += poses[i].place;
    n += 1.0;
  }
  from /= n;
  to /= n;
  Complex product;
  double square = 0.0;
  for (size_t i = 0; i < poses.size(); ++i) {
    if (used[i] == 0) continue;
    const Eigen::Vector3d a = level * poses[i].centre - from, b = poses[i].place - to;
    product += Complex(b.x(), b.y()) * std::conj(Complex(a.x(), a.y()));
    square += a.head<2>().squaredNorm();
  }
  const Complex factor = product / square;
  geo::Similarity3d map;
  map.scale = std::abs(factor);
  map.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(std::arg(factor), Eigen::Vector3d::UnitZ())) * level;
  map.translation = to - map.scale * (map.rotation * (level.conjugate() * from));
  return map;
}

geo::Similarity3d FitFree(const std::vector<TaggedPose>& poses, const std::vector<char>& used) {
  const auto n = std::count(used.begin(), used.end(), 1);
  Eigen::Matrix3Xd from(3, n), to(3, n);
  Eigen::Index column = 0;
  for (size_t i = 0; i < poses.size(); ++i) {
    if (used[i] == 0) continue;
    from.col(column) = poses[i].centre;
    to.col(column++) = poses[i].place;
  }
  const Eigen::Matrix4d map = linear::Similarity(from, to);
  const Eigen::Matrix3d turn = map.topLeftCorner<3, 3>();
  const double scale = std::cbrt(turn.determinant());
  return {scale, Eigen::Quaterniond(Eigen::Matrix3d(turn / scale)), map.topRightCorner<3, 1>()};
}

}  // namespace

void Transform(const geo::Similarity3d& map, survey::ColmapModel& model) {
  for (survey::ColmapImage& image : model.images) image.cam_from_world = geo::TransformCameraWorld(image.cam_from_world, map);
  for (survey::ColmapPoint& point : model.points) point.x_in_world = map * point.x_in_world;
}

namespace {

// Of a model in ENU metres.
std::vector<Footprint> FootprintsOf(const survey::ColmapModel& model) {
  std::vector<double> ground, cameras;
  for (const survey::ColmapPoint& point : model.points) ground.push_back(point.x_in_world.z());
  for (const survey::ColmapImage& image : model.images) cameras.push_back(image.cam_from_world.OriginInSource().z());
  if (ground.empty()) return {};
  const double height_m = std::max(base::Median(std::move(cameras)) - base::Median(std::move(ground)), 1.0);
  std::vector<Footprint> footprints;
  for (const survey::ColmapImage& image : model.images) {
    const geo::Rigid3d& pose = image.cam_from_world;
    footprints.push_back(FootprintOf(model.cameras.at(image.camera_id), pose.rotation, pose.OriginInSource(), height_m));
  }
  return footprints;
}

bool AreApart(const std::vector<Footprint>& part, const std::vector<Footprint>& others) {
  const auto n_like = std::count_if(part.begin(), part.end(), [&](const Footprint& one) {
    return std::any_of(others.begin(), others.end(), [&](const Footprint& other) { return one.IsLike(other); });
  });
  return static_cast<double>(n_like) <= kFewLike * static_cast<double>(part.size());
}

// Without images that the whole has already.
void Append(Part part, Part& whole) {
  std::unordered_set<uint32_t> known;
  uint32_t next_camera = 1;
  uint64_t next_point = 1;
  for (const survey::ColmapImage& image : whole.model.images) known.insert(image.id);
  for (const auto& [id, camera] : whole.model.cameras) next_camera = std::max(next_camera, id + 1);
  for (const auto& [id, camera] : part.model.cameras) next_camera = std::max(next_camera, id + 1);
  for (const survey::ColmapPoint& point : whole.model.points) next_point = std::max(next_point, point.id + 1);
  RemovePhotos([&](const survey::ColmapImage& image) { return known.contains(image.id); }, part.model);
  std::map<uint32_t, uint32_t> camera_of;
  for (survey::ColmapImage& image : part.model.images) {
    const auto [camera, is_new] = camera_of.emplace(image.camera_id, next_camera);
    if (is_new) whole.model.cameras.emplace(next_camera++, part.model.cameras.at(image.camera_id));
    image.camera_id = camera->second;
    whole.model.images.push_back(image);
  }
  std::unordered_map<uint64_t, uint64_t> point_of;
  for (survey::ColmapPoint& point : part.model.points) {
    point_of.emplace(point.id, next_point);
    point.id = next_point++;
    whole.model.points.push_back(std::move(point));
  }
  for (auto& [id, seen] : part.observations) {
    if (known.contains(id)) continue;
    std::vector<survey::ColmapObservation>& kept = whole.observations[id];
    for (survey::ColmapObservation one : seen) {
      const auto point = point_of.find(one.point_id);
      if (point == point_of.end()) continue;
      one.point_id = point->second;
      kept.push_back(one);
    }
  }
}

}  // namespace

std::optional<TaggedPlace> PlaceByTags(const survey::ColmapModel& model, const std::vector<input::PhotoFile>& photos,
                                       const std::optional<geo::Geodetic>& about) {
  const std::vector<TaggedPose> poses = TaggedPosesOf(model, photos, about);
  if (poses.size() < kLeastOfPart) return std::nullopt;
  const std::optional<Eigen::Quaterniond> level = RotationByAngles(poses);
  std::vector<char> used(poses.size(), 1);
  TaggedPlace place;
  std::vector<double> off_m(poses.size());
  double median_m = 0.0;
  // Tags that are far off show themselves one after the other.
  for (int round = 0; round < 10; ++round) {
    place.enu_from_model = level ? FitLevelled(poses, used, *level) : FitFree(poses, used);
    if (!(place.enu_from_model.scale > 0.0) || !std::isfinite(place.enu_from_model.scale)) return std::nullopt;
    for (size_t i = 0; i < poses.size(); ++i) off_m[i] = (place.enu_from_model * poses[i].centre - poses[i].place).head<2>().norm();
    median_m = base::Median(off_m);
    constexpr double kAlways_m = 1.0, kTimes = 3.0;
    std::vector<char> agrees(poses.size(), 0);
    for (size_t i = 0; i < poses.size(); ++i) agrees[i] = off_m[i] <= kAlways_m + kTimes * median_m ? 1 : 0;
    if (agrees == used) break;
    used = std::move(agrees);
  }
  const auto n_used = static_cast<double>(std::count(used.begin(), used.end(), 1));
  if (n_used < kLeastOfPart || n_used < kLeastAgreeing * static_cast<double>(poses.size())) return std::nullopt;
  // Positions far more apart than they are wrong, and without angles in two directions.
  constexpr double kLeastTimes = 3.0;
  std::vector<Eigen::Vector2d> places;
  for (size_t i = 0; i < poses.size(); ++i) {
    if (used[i] != 0) places.emplace_back(poses[i].place.head<2>());
  }
  const Spread spread = SpreadOf(places);
  if ((level ? spread.larger : spread.smaller) < kLeastTimes * median_m) return std::nullopt;
  place.median_m = median_m;
  return place;
}

std::optional<Part> JoinParts(const std::vector<Part>& parts, const std::vector<input::PhotoFile>& photos, bool only_apart) {
  if (parts.size() < 2) return std::nullopt;
  std::vector<Part> placed;
  std::vector<double> median_m;
  for (const Part& part : parts) {
    const std::optional<TaggedPlace> place = PlaceByTags(part.model, photos);
    if (!place && placed.empty()) return std::nullopt;
    if (!place) continue;
    Part moved = part;
    Transform(place->enu_from_model, moved.model);
    placed.push_back(std::move(moved));
    median_m.push_back(place->median_m);
  }
  Part whole = placed.front();
  std::vector<Footprint> shown = FootprintsOf(whole.model);
  std::string names = fmt::format("{} photos such as {}", whole.model.images.size(), whole.model.images.front().name);
  size_t n_joined = 0;
  for (size_t i = 1; i < placed.size(); ++i) {
    const std::vector<Footprint> footprints = FootprintsOf(placed[i].model);
    if (only_apart && !AreApart(footprints, shown)) continue;
    names +=
        fmt::format(", {} such as {} ({:.1f} m from their tags)", placed[i].model.images.size(), placed[i].model.images.front().name, median_m[i]);
    shown.insert(shown.end(), footprints.begin(), footprints.end());
    Append(std::move(placed[i]), whole);
    ++n_joined;
  }
  if (n_joined == 0) return std::nullopt;
  base::LogInfo("{} parts of the survey have no features in common and are placed by their tags: {}", n_joined + 1, names);
  return whole;
}

std::vector<std::vector<std::string>> PartsOf(const survey::ColmapModel& model) {
  std::vector<std::vector<std::string>> parts = TiedPhotos(model);
  std::erase_if(parts, [](const auto& part) { return part.size() < kLeastOfPart; });
  return parts;
}

}  // namespace skyquilt::prepare::poses
