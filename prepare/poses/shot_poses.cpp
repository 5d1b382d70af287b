#include "prepare/poses/shot_poses.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <set>
#include <unordered_map>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/base/order_statistics.h"
#include "prepare/bundle/adjust_rounds.h"
#include "prepare/bundle/shots.h"
#include "prepare/bundle/triangulate.h"
#include "prepare/poses/seed/bundle_model.h"
#include "prepare/poses/seed/point_colors.h"
#include "prepare/poses/seed/verdict.h"
#include "prepare/poses/seed_model.h"

namespace skyquilt::prepare::poses {
namespace {

namespace fs = std::filesystem;

camera::Camera ExactCamera(int width, int height, double focal_px) {
  return {camera::CameraModel::kPinhole, width, height, {focal_px, focal_px, 0.5 * width, 0.5 * height}};
}

// The photos of the database with the poses and lenses of the model, those of shots on their rigs. Nothing when there is a lens that the adjustment
// does not know.
std::optional<bundle::BundleProblem> BundleOf(const SeedInput& input, const survey::ColmapModel& model) {
  bundle::BundleProblem bundle;
  std::map<uint32_t, int> lens_of;
  for (const auto& [id, seed] : input.cameras) {
    const auto found = model.cameras.find(id);
    const camera::Camera& camera = found == model.cameras.end() || seed.exact ? seed.camera : found->second;
    const std::optional<bundle::Lens> numbers = bundle::LensOf(camera);
    if (!numbers) return std::nullopt;
    lens_of.emplace(id, static_cast<int>(bundle.lenses.size()));
    bundle::BundleLens& lens = bundle.lenses.emplace_back();
    lens.numbers = lens.initial = *numbers;
    lens.camera = camera;
    lens.unit_px = std::max(camera.width, camera.height) / bundle::kUnitWidth_px;
    lens.exact = seed.exact;
  }
  std::unordered_map<std::string, const survey::ColmapImage*> image_of;
  for (const survey::ColmapImage& image : model.images) image_of.emplace(image.name, &image);
  for (const SeedPhoto& photo : input.photos) {
    bundle::BundlePhoto& placed = bundle.photos.emplace_back();
    placed.lens = lens_of.at(photo.camera_id);
    placed.shot = photo.shot;
    placed.cam_from_rig = photo.cam_from_rig;
    const auto image = image_of.find(photo.name);
    if (image == image_of.end()) continue;
    placed.placed = true;
    placed.cam_from_enu = image->second->cam_from_world.rotation.normalized();
    placed.centre = image->second->cam_from_world.OriginInSource();
  }
  return bundle;
}

// Angles between the poses found and those of their rigs, for photos of shots with several poses.
std::vector<double> AnglesToRigs(const bundle::BundleProblem& bundle) {
  std::vector<double> angles_deg;
  for (const bundle::Shot& shot : bundle::PlacedShots(bundle)) {
    if (shot.photos.size() < 2) continue;
    for (const uint32_t photo : shot.photos) {
      bundle::BundlePhoto on_rig = bundle.photos[photo];
      bundle::PlaceByRig(shot.pose, on_rig);
      angles_deg.push_back(on_rig.cam_from_enu.angularDistance(bundle.photos[photo].cam_from_enu) * 180.0 / std::numbers::pi);
    }
  }
  return angles_deg;
}

void CheckRig(const std::vector<double>& angles_deg, const std::vector<input::PhotoFile>& photos) {
  const auto n_off = std::count_if(angles_deg.begin(), angles_deg.end(), [](double angle) { return angle > bundle::kShotAngle_deg; });
  if (2 * static_cast<size_t>(n_off) <= angles_deg.size()) return;
  const auto user = std::find_if(photos.begin(), photos.end(), [](const auto& photo) { return photo.rig.has_value(); });
  // The poses may be wrong as well: of more pairs they may be others.
  throw NoModelError(user->rig->rig,
                     fmt::format("contradicts the photos: {} of {} poses that were found are more than {:g} degrees off the rig's", n_off,
                                 angles_deg.size(), bundle::kShotAngle_deg),
                     "Rotations there are cam_from_rig, as w, x, y, z. Correct them, or set prepare.rig = none to find every photo by itself");
}

void Scale(double factor, bundle::BundleProblem& bundle) {
  for (bundle::BundlePhoto& photo : bundle.photos) photo.centre *= factor;
}

// Where photos are holds the frame, so loosely (the size of the whole) that it bends nothing.
void HoldFrame(bundle::BundleProblem& bundle) {
  Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (const bundle::BundlePhoto& photo : bundle.photos) {
    if (!photo.placed) continue;
    low = low.cwiseMin(photo.centre);
    high = high.cwiseMax(photo.centre);
  }
  const double size = (high - low).norm();
  if (!(size > 0.0)) return;
  for (bundle::BundlePhoto& photo : bundle.photos) {
    if (!photo.placed) continue;
    photo.gps = photo.centre;
    photo.gps_sigma = Eigen::Vector3d::Constant(size);
  }
}

// Takes the pose from single photos that contradict the matches, and from shots of which no photo agrees: one that shows only sky is where its rig
// is.
size_t RemoveLost(bundle::BundleProblem& bundle, base::ThreadPool& threads) {
  bundle::BundleProblem judged = bundle;
  if (RemoveContradicted(judged) == 0) return 0;
  std::set<int> good_shots;
  for (const bundle::BundlePhoto& photo : judged.photos) {
    if (photo.shot >= 0 && photo.placed) good_shots.insert(photo.shot);
  }
  size_t n_lost = 0;
  for (size_t i = 0; i < bundle.photos.size(); ++i) {
    bundle::BundlePhoto& photo = bundle.photos[i];
    const bool stays = photo.shot >= 0 ? good_shots.contains(photo.shot) : judged.photos[i].placed;
    n_lost += photo.placed && !stays ? 1 : 0;
    photo.placed = photo.placed && stays;
  }
  if (n_lost > 0) bundle::TriangulateAll(bundle, bundle::kFinalThreshold, threads);
  return n_lost;
}

// Without an adjustment: photos of shots at the mean of what was found for them.
void WriteMeans(const fs::path& from, const std::vector<input::PhotoFile>& photos, const fs::path& to) {
  survey::ColmapModel model = survey::ReadColmapModel(from);
  MarkShots(photos, model);
  bundle::BundleProblem bundle;
  for (const survey::ColmapImage& image : model.images) {
    bundle::BundlePhoto& photo = bundle.photos.emplace_back();
    photo.cam_from_enu = image.cam_from_world.rotation.normalized();
    photo.centre = image.cam_from_world.OriginInSource();
    photo.placed = true;
    photo.shot = image.shot;
    photo.cam_from_rig = image.cam_from_rig;
  }
  CheckRig(AnglesToRigs(bundle), photos);
  const double scale = bundle::RigScale(bundle);
  Scale(scale, bundle);
  bundle::PlaceShots(bundle);
  for (size_t i = 0; i < bundle.photos.size(); ++i) {
    const bundle::BundlePhoto& photo = bundle.photos[i];
    model.images[i].cam_from_world = {photo.cam_from_enu, -(photo.cam_from_enu * photo.centre)};
  }
  for (survey::ColmapPoint& point : model.points) point.x_in_world *= scale;
  survey::WriteColmapBinary(model, survey::ReadColmapObservations(from), to);
  base::LogInfo("rigs: a lens is one that the adjustment does not know, so photos are placed at the mean of what was found for their shots");
}

}  // namespace

bool AnyRig(const std::vector<input::PhotoFile>& photos) {
  return std::any_of(photos.begin(), photos.end(), [](const input::PhotoFile& photo) { return photo.rig.has_value(); });
}

bool AllExact(const std::vector<input::PhotoFile>& photos) {
  return std::all_of(photos.begin(), photos.end(), [](const input::PhotoFile& photo) { return photo.rig && photo.rig->exact_focal_px; });
}

std::string LensOfRig(const input::RigPlace& place) {
  return place.exact_focal_px ? fmt::format("exact {}", *place.exact_focal_px) : place.camera;
}

std::string RigInputs(const input::PhotoFile& photo) {
  if (!photo.rig) return "";
  const Eigen::Quaterniond& r = photo.rig->cam_from_rig.rotation;
  const Eigen::Vector3d& t = photo.rig->cam_from_rig.translation;
  return fmt::format("rig {} {} {} {} {} {} {} {} {}\n", photo.rig->shot, LensOfRig(*photo.rig), r.w(), r.x(), r.y(), r.z(), t.x(), t.y(), t.z());
}

void MarkShots(const std::vector<input::PhotoFile>& photos, survey::ColmapModel& model) {
  std::unordered_map<std::string, const input::PhotoFile*> photo_of;
  for (const input::PhotoFile& photo : photos) photo_of.emplace(photo.name, &photo);
  ShotNumbers shots;
  for (survey::ColmapImage& image : model.images) {
    const auto photo = photo_of.find(image.name);
    if (photo == photo_of.end() || !photo->second->rig) continue;
    const input::RigPlace& place = *photo->second->rig;
    image.shot = shots.Of(place);
    image.cam_from_rig = place.cam_from_rig;
    if (!place.exact_focal_px) continue;
    model.exact_cameras.insert(image.camera_id);
    model.cameras[image.camera_id] = ExactCamera(photo->second->width, photo->second->height, *place.exact_focal_px);
  }
}

void PlaceByRigs(const ColmapJob& job, const fs::path& from, const std::vector<input::PhotoFile>& photos, const fs::path& to,
                 base::ThreadPool& threads) {
  fs::remove_all(to);
  std::string reason;
  const std::optional<SeedInput> input = ReadSeedInput(job.Database(), photos, &reason);
  if (!input) throw base::InputError(job.Database(), reason, "Add --restart to find features and matches again");
  std::optional<bundle::BundleProblem> bundle = BundleOf(*input, survey::ReadColmapModel(from));
  if (!bundle) {
    WriteMeans(from, photos, to);
    return;
  }
  const std::vector<double> angles_deg = AnglesToRigs(*bundle);
  CheckRig(angles_deg, photos);
  Scale(bundle::RigScale(*bundle), *bundle);
  const size_t n_new = bundle::PlaceShots(*bundle);
  HoldFrame(*bundle);
  FillTracks(*input, *bundle);
  if (!bundle::AdjustInRounds(*bundle, "adjust rigs", threads)) {
    throw NoModelError(job.Log(), "the bundle adjustment with one pose per shot of the rig found no solution", kNoModelFix);
  }
  const size_t n_lost = RemoveLost(*bundle, threads);
  survey::ColmapModel model;
  survey::ColmapObservations observations;
  ModelOfBundle(*input, *bundle, &model, &observations);
  if (model.images.empty()) throw NoModelError(job.Log(), "no shot of the rig agrees with the matches of its photos", kNoModelFix);
  ColorPoints(model, observations, job.photo_root, threads);
  survey::WriteColmapBinary(model, observations, to);
  std::set<int> shots;
  size_t n_of_shots = 0;
  for (const bundle::BundlePhoto& photo : bundle->photos) {
    if (photo.shot < 0 || !photo.placed) continue;
    shots.insert(photo.shot);
    ++n_of_shots;
  }
  base::LogInfo("rigs: {} photos of {} shots, each with one pose; {} of them had none before, {} lost it", n_of_shots, shots.size(), n_new, n_lost);
  if (!angles_deg.empty()) {
    base::LogInfo("rigs: before, poses of photos were off their rigs' by {:.3f} degrees (median) and {:.3f} degrees at most",
                  base::Median(angles_deg), *std::max_element(angles_deg.begin(), angles_deg.end()));
  }
}

}  // namespace skyquilt::prepare::poses
