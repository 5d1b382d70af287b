#include "prepare/poses/seed_model.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <unordered_map>

#include "core/base/log.h"
#include "core/survey/colmap_database.h"
#include "core/survey/colmap_model.h"
#include "prepare/input/tag_accuracy.h"
#include "prepare/poses/focal_check.h"
#include "prepare/poses/seed/focal_by_height.h"
#include "prepare/poses/seed/point_colors.h"
#include "prepare/poses/seed/seed_poses.h"
#include "prepare/poses/shot_poses.h"

namespace skyquilt::prepare::poses {
namespace {

namespace fs = std::filesystem;

constexpr int kSeedVersion = 5;  // a new number makes finished models anew

fs::path SeededFolder(const ColmapJob& job) {
  return job.folder / "seeded";
}

SeedPhoto SeedPhotoOf(const survey::DatabaseImage& image, const survey::PhotoTags& tags, const std::vector<survey::DatabaseKeypoint>& keypoints) {
  const input::TagAccuracy accuracy = input::AccuracyOf(tags);
  SeedPhoto photo{.image_id = image.id,
                  .camera_id = image.camera_id,
                  .name = image.name,
                  .gps = tags.gps,
                  .horizontal_sigma_m = accuracy.horizontal_m,
                  .vertical_sigma_m = accuracy.vertical_m,
                  .yaw_deg = tags.gimbal_yaw_deg,
                  .pitch_deg = tags.gimbal_pitch_deg,
                  .roll_deg = tags.gimbal_roll_deg,
                  .relative_altitude_m = tags.relative_altitude_m,
                  .features = {}};
  photo.features.reserve(keypoints.size());
  for (const survey::DatabaseKeypoint& keypoint : keypoints) photo.features.emplace_back(keypoint.x, keypoint.y);
  return photo;
}

bool HasFocalTags(const SeedInput& input) {
  return std::any_of(input.cameras.begin(), input.cameras.end(), [](const auto& camera) { return camera.second.focal_is_known; });
}

// Where tags have no focal length, RelativeAltitude may tell it, by the height above ground that goes with it. It is asked when poses with a guessed
// focal length contradict it, or when there are none: take-off need not be at the height of the ground. The input keeps the focal lengths tried last.
std::optional<SeededModel> SeedWithoutFocalTags(SeedInput& input, base::ThreadPool& threads, std::string* reason) {
  std::optional<SeededModel> guessed = SeedPoses(input, threads, reason);
  const HeightAboveTakeOff height = guessed ? HeightsInModel(input, guessed->model) : HeightAboveTakeOff();
  if (guessed && !height.Notable()) return guessed;
  const std::optional<double> factor = FocalFactorByHeight(input);
  if (!factor) return guessed;
  for (auto& [id, lens] : input.cameras) {
    lens = ScaledFocal(lens, *factor);
    base::LogInfo(
        "the tags have no focal length, and {}; once more with {:.0f} px, by RelativeAltitude",
        guessed ? fmt::format("the cameras would be {:.0f} m above the ground, where RelativeAltitude says {:.0f} m", height.found_m, height.tagged_m)
                : "a guessed one gives no poses by tags and matches",
        lens.camera.FocalX());
  }
  std::string other_reason;
  std::optional<SeededModel> by_height = SeedPoses(input, threads, &other_reason);
  if (!by_height || HeightsInModel(input, by_height->model).Differs()) return guessed;
  reason->clear();
  return by_height;
}

// Whether the heights of `one` are far nearer to RelativeAltitude. Ground and barometer explain small differences.
bool IsMuchNearer(const HeightAboveTakeOff& one, const HeightAboveTakeOff& other) {
  constexpr double kTimes = 3.0;
  return one.Known() && other.Notable() && kTimes * std::abs(std::log(one.ratio)) < std::abs(std::log(other.ratio));
}

// Photos that look straight down fit other focal lengths nearly as well, and features weigh so much more than tags that a little misfit of the lens
// drives it away. Then poses with the focal length held near the tagged one are better, if they agree with the matches too.
std::optional<SeededModel> SeedWithPlausibleFocal(SeedInput& input, base::ThreadPool& threads, std::string* reason) {
  if (!HasFocalTags(input)) return SeedWithoutFocalTags(input, threads, reason);
  constexpr double kHeldSigma = 0.01;
  std::optional<SeededModel> seeded = SeedPoses(input, threads, reason);
  if (!seeded) return std::nullopt;
  std::map<uint32_t, camera::Camera> tagged;
  std::map<uint32_t, double> tagged_px;
  for (auto& [id, lens] : input.cameras) {
    tagged.emplace(id, lens.camera);
    if (lens.focal_is_known) tagged_px.emplace(id, lens.camera.FocalX());
    lens.focal_sigma = kHeldSigma;
  }
  const std::optional<FarFocal> far = FindFarFocal(seeded->model, tagged);
  if (!far && !AnyFocalMoved(tagged_px, seeded->model)) return seeded;
  if (far) base::LogInfo("poses by tags and matches need {}; once more with focal lengths held near the tags'", far->Text());
  std::string held_reason;
  std::optional<SeededModel> held = SeedPoses(input, threads, &held_reason);
  if (!held) return seeded;
  // Far ones cannot be right; of others RelativeAltitude decides whether photos or tags are.
  if (far ? !FindFarFocal(held->model, tagged) : IsMuchNearer(HeightsInModel(input, held->model), HeightsInModel(input, seeded->model))) {
    if (!far) base::LogInfo("poses are found with focal lengths held near the tags', as RelativeAltitude agrees with them");
    return held;
  }
  // The caller refuses far ones and says why.
  return seeded;
}

// COLMAP's mapper, too, begins with the focal lengths that RelativeAltitude told.
void KeepFocalsByHeight(const SeedInput& input, const fs::path& file) {
  survey::ColmapDatabase database(file);
  for (const auto& [id, camera] : database.ReadCameras()) {
    const auto lens = input.cameras.find(id);
    if (lens == input.cameras.end() || !IsGuessedFocal(camera) || lens->second.camera.FocalX() == camera.FocalX()) continue;
    constexpr bool kFromTags = false;
    database.SetFocal(id, lens->second.camera.FocalX(), kFromTags);
  }
}

}  // namespace

std::string TagText(const std::optional<double>& value) {
  return value ? fmt::format("{:.9g}", *value) : "-";
}

std::string SeedInputs(const std::vector<input::PhotoFile>& photos) {
  std::string text = fmt::format("seeded {}\n", kSeedVersion);
  for (const input::PhotoFile& photo : photos) {
    const survey::PhotoTags& tags = photo.tags;
    const input::TagAccuracy accuracy = input::AccuracyOf(tags);
    text += tags.gps ? fmt::format("{:.9g}", tags.gps->height_m) : "-";
    text += RigInputs(photo);
    text += fmt::format(" {:.9g} {:.9g} {}\n", accuracy.horizontal_m, accuracy.vertical_m, TagText(tags.gimbal_roll_deg));
  }
  return text;
}

std::optional<SeedInput> ReadSeedInput(const fs::path& file, const std::vector<input::PhotoFile>& photos, std::string* reason) {
  const survey::ColmapDatabase database(file);
  std::unordered_map<std::string, survey::DatabaseImage> image_of_name;
  for (survey::DatabaseImage& image : database.ReadImages()) image_of_name.emplace(image.name, image);
  const std::map<uint32_t, camera::Camera> cameras = database.ReadCameras();
  SeedInput input;
  std::unordered_map<uint32_t, size_t> n_features;
  ShotNumbers shots;
  for (const input::PhotoFile& photo : photos) {
    const auto image = image_of_name.find(photo.name);
    if (image == image_of_name.end()) continue;  // COLMAP could not read it
    const auto camera = cameras.find(image->second.camera_id);
    if (camera == cameras.end()) {
      *reason = "COLMAP's database has no camera for " + photo.name;
      return std::nullopt;
    }
    input.cameras.try_emplace(camera->first, SeedLens{camera->second, !IsGuessedFocal(camera->second)});
    input.photos.push_back(SeedPhotoOf(image->second, photo.tags, database.ReadKeypoints(image->second.id)));
    if (photo.rig) {
      input.photos.back().shot = shots.Of(*photo.rig);
      input.photos.back().cam_from_rig = photo.rig->cam_from_rig;
      input.cameras.at(camera->first).exact = photo.rig->exact_focal_px.has_value();
    }
    n_features.emplace(image->second.id, input.photos.back().features.size());
  }
  for (survey::DatabaseMatches& matches : database.ReadTwoViewMatches()) {
    const auto a = n_features.find(matches.images.first), b = n_features.find(matches.images.second);
    if (a == n_features.end() || b == n_features.end() || matches.features.empty()) continue;
    const bool have_places = std::all_of(matches.features.begin(), matches.features.end(),
                                         [&](const survey::FeaturePair& pair) { return pair[0] < a->second && pair[1] < b->second; });
    if (!have_places) {
      *reason = fmt::format("COLMAP's database has no places for the matched features of images {} and {}", a->first, b->first);
      return std::nullopt;
    }
    input.pairs.push_back({matches.images.first, matches.images.second, std::move(matches.features)});
  }
  return input;
}

void SeedModel(const ColmapJob& job, const std::vector<input::PhotoFile>& photos, base::ThreadPool& threads) {
  const auto start = std::chrono::steady_clock::now();
  const auto seconds = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); };
  const fs::path folder = SeededFolder(job);
  fs::remove_all(folder);
  std::string reason;
  std::optional<SeedInput> input = ReadSeedInput(job.Database(), photos, &reason);
  std::optional<SeededModel> seeded;
  const bool guesses_focal = input && !HasFocalTags(*input);
  if (input) seeded = SeedWithPlausibleFocal(*input, threads, &reason);
  if (!seeded) {
    if (guesses_focal) KeepFocalsByHeight(*input, job.Database());
    base::LogInfo("poses are left to COLMAP's mapper ({:.1f} s): {}", seconds(), reason);
    return;
  }
  ColorPoints(seeded->model, seeded->observations, job.photo_root, threads);
  WriteSeededModel(*seeded, folder);
  base::LogInfo("poses by tags and matches, without COLMAP's mapper ({:.1f} s): {}", seconds(), seeded->summary);
}

std::optional<FoundModel> SeededModelOf(const ColmapJob& job) {
  const fs::path folder = SeededFolder(job);
  if (!fs::exists(folder / "images.bin")) return std::nullopt;
  return FoundModel{folder, survey::CountColmapImages(folder)};
}

}  // namespace skyquilt::prepare::poses
