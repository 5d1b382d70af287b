#include "prepare/poses/add_photos.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <unordered_map>

#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/base/order_statistics.h"
#include "prepare/bundle/adjust_rounds.h"
#include "prepare/bundle/triangulate.h"
#include "prepare/poses/colmap_run.h"
#include "prepare/poses/join_parts.h"
#include "prepare/poses/loose_photos.h"
#include "prepare/poses/pairs.h"
#include "prepare/poses/photo_places.h"
#include "prepare/poses/seed/bundle_model.h"
#include "prepare/poses/seed/point_colors.h"
#include "prepare/poses/seed/verdict.h"
#include "prepare/poses/seed_model.h"
#include "prepare/poses/shot_poses.h"

namespace skyquilt::prepare::poses {
namespace {

namespace fs = std::filesystem;

constexpr size_t kLeastKnown = 3;     // photos that a part must have in common with the survey to be laid on it
constexpr double kFocalSigma = 0.01;  // relative: what was found without holding the survey is near

// Marks all photos that have a pair with a marked one.
void MarkPartners(const PhotoPairs& pairs, std::vector<char>& marked) {
  const std::vector<char> before = marked;
  for (const PhotoPair& pair : pairs) {
    if (before[pair.a] != 0) marked[pair.b] = 1;
    if (before[pair.b] != 0) marked[pair.a] = 1;
  }
}

// The job's folder of features that a model is made of: another one when the search was repeated with more pairs.
ColmapJob JobOfModel(const ColmapJob& job, const fs::path& model) {
  ColmapJob of_model = job;
  for (fs::path folder = model.parent_path(); folder != job.folder.parent_path() && folder.has_relative_path(); folder = folder.parent_path()) {
    of_model.folder = folder;
    if (fs::exists(of_model.Database())) return of_model;
  }
  return job;
}

// The part of a model with these photos.
survey::ColmapModel PartWith(survey::ColmapModel model, const std::vector<std::string>& names) {
  const std::set<std::string> kept(names.begin(), names.end());
  RemovePhotos([&](const survey::ColmapImage& image) { return !kept.contains(image.name); }, model);
  return model;
}

// Lays each part of a model on the survey. Photos of parts that nothing places lose their pose.
void Place(const std::vector<input::PhotoFile>& photos, const KnownPoses& known, AddedPoses& poses) {
  survey::ColmapModel placed;
  placed.cameras = poses.model.cameras;
  std::vector<std::vector<std::string>> parts = TiedPhotos(poses.model);
  for (const std::vector<std::string>& names : parts) {
    survey::ColmapModel part = PartWith(poses.model, names);
    std::vector<geo::Rigid3d> of_model, of_survey;
    for (const survey::ColmapImage& image : part.images) {
      const auto found = known.photos.find(image.name);
      if (found == known.photos.end()) continue;
      of_model.push_back(image.cam_from_world);
      of_survey.push_back(found->second.cam_from_enu);
    }
    const size_t n_added = part.images.size() - of_model.size();
    if (n_added == 0) continue;
    if (of_model.size() >= kLeastKnown) {
      Transform(SimilarityOfPoses(of_model, of_survey), part);
      base::LogInfo("{} added photos are laid on the survey by {} of its photos", n_added, of_model.size());
    } else if (const auto by_tags = known.georeferenced ? PlaceByTags(part, photos, known.origin) : std::nullopt) {
      Transform(by_tags->enu_from_model, part);
      for (const survey::ColmapImage& image : part.images) {
        if (!known.photos.contains(image.name)) poses.by_tags.push_back(image.name);
      }
      base::LogInfo("{} added photos have no features in common with the survey and are placed by their tags ({:.1f} m from them)", n_added,
                    by_tags->median_m);
    } else {
      base::LogWarning("{} added photos such as {} have no features in common with the survey, and tags do not hold them: they get no pose", n_added,
                       names.front());
      continue;
    }
    placed.images.insert(placed.images.end(), part.images.begin(), part.images.end());
    placed.points.insert(placed.points.end(), part.points.begin(), part.points.end());
  }
  poses.model = std::move(placed);
}

// Known photos where they are known to be, with the survey's lenses, which get ids of their own.
void UseKnown(const KnownPoses& known, survey::ColmapModel& model) {
  uint32_t next = model.cameras.empty() ? 1 : model.cameras.rbegin()->first + 1;
  for (survey::ColmapImage& image : model.images) {
    const auto found = known.photos.find(image.name);
    if (found == known.photos.end()) continue;
    image.cam_from_world = found->second.cam_from_enu;
    image.camera_id = next++;
    model.cameras.emplace(image.camera_id, found->second.camera);
  }
  std::erase_if(model.cameras, [&](const auto& camera) {
    return std::none_of(model.images.begin(), model.images.end(), [&](const auto& image) { return image.camera_id == camera.first; });
  });
}

// The photos of the database as the model has them. Gives the input the model's cameras. Nothing when there is a lens that the adjustment does not
// know.
std::optional<bundle::BundleProblem> BundleOf(const survey::ColmapModel& model, const KnownPoses& known, SeedInput& input) {
  std::unordered_map<std::string, const survey::ColmapImage*> image_of;
  for (const survey::ColmapImage& image : model.images) image_of.emplace(image.name, &image);
  std::erase_if(input.photos, [&](const SeedPhoto& photo) { return !image_of.contains(photo.name); });
  std::set<uint32_t> ids;
  for (SeedPhoto& photo : input.photos) {
    photo.camera_id = image_of.at(photo.name)->camera_id;
    ids.insert(photo.image_id);
  }
  std::erase_if(input.pairs, [&](const PairMatches& pair) { return !ids.contains(pair.image_a) || !ids.contains(pair.image_b); });
  input.cameras.clear();
  std::map<uint32_t, int> lens_of;
  bundle::BundleProblem bundle;
  std::set<uint32_t> held;
  for (const survey::ColmapImage& image : model.images) {
    if (known.photos.contains(image.name)) held.insert(image.camera_id);
  }
  for (const auto& [id, camera] : model.cameras) {
    const std::optional<bundle::Lens> numbers = bundle::LensOf(camera);
    if (!numbers) return std::nullopt;
    input.cameras.emplace(id, SeedLens{camera});
    lens_of.emplace(id, static_cast<int>(bundle.lenses.size()));
    bundle::BundleLens& lens = bundle.lenses.emplace_back();
    lens.numbers = lens.initial = *numbers;
    lens.camera = camera;
    lens.focal_sigma = kFocalSigma;
    lens.unit_px = std::max(camera.width, camera.height) / bundle::kUnitWidth_px;
    lens.exact = held.contains(id);
  }
  Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (const SeedPhoto& photo : input.photos) {
    const survey::ColmapImage& image = *image_of.at(photo.name);
    bundle::BundlePhoto& placed = bundle.photos.emplace_back();
    placed.lens = lens_of.at(photo.camera_id);
    placed.placed = true;
    placed.held = known.photos.contains(photo.name);
    placed.cam_from_enu = image.cam_from_world.rotation.normalized();
    placed.centre = image.cam_from_world.OriginInSource();
    low = low.cwiseMin(placed.centre);
    high = high.cwiseMax(placed.centre);
  }
  // Where photos are holds the frame of what no known photo holds, so loosely (the size of the whole) that it bends nothing.
  for (bundle::BundlePhoto& photo : bundle.photos) {
    if (photo.held || !((high - low).norm() > 0.0)) continue;
    photo.gps = photo.centre;
    photo.gps_sigma = Eigen::Vector3d::Constant((high - low).norm());
  }
  return bundle;
}

// Takes the pose from added photos that contradict the matches. Returns their number.
size_t RemoveLost(bundle::BundleProblem& bundle, base::ThreadPool& threads) {
  bundle::BundleProblem judged = bundle;
  constexpr double kAnyGround = 1e-3;  // parts that show other ground stay: tags place them
  if (RemoveContradicted(judged, kAnyGround) == 0) return 0;
  size_t n_lost = 0;
  for (size_t i = 0; i < bundle.photos.size(); ++i) {
    bundle::BundlePhoto& photo = bundle.photos[i];
    if (photo.held || judged.photos[i].placed) continue;
    photo.placed = false;
    ++n_lost;
  }
  if (n_lost > 0) bundle::TriangulateAll(bundle, bundle::kFinalThreshold, threads);
  return n_lost;
}

// To all verified matches of the database. The model stays what it is where there is no such adjustment.
void AdjustAdded(const ColmapJob& job, const std::vector<input::PhotoFile>& photos, const KnownPoses& known, survey::ColmapModel& model,
                 base::ThreadPool& threads) {
  std::string reason;
  std::optional<SeedInput> input = ReadSeedInput(job.Database(), photos, &reason);
  if (!input) throw base::InputError(job.Database(), reason, "Remove its folder and run the same command again");
  std::optional<bundle::BundleProblem> bundle = BundleOf(model, known, *input);
  if (!bundle) {
    base::LogInfo("a lens is one that the adjustment does not know, so added photos stay where they were laid on the survey");
    return;
  }
  FillTracks(*input, *bundle);
  if (!bundle::AdjustInRounds(*bundle, "adjust added photos", threads)) {
    base::LogWarning("the adjustment of the added photos found no solution: they stay where they were laid on the survey");
    return;
  }
  const size_t n_lost = RemoveLost(*bundle, threads);
  if (n_lost > 0) base::LogWarning("{} added photos contradict their matches with the others and get no pose", n_lost);
  survey::ColmapModel adjusted;
  survey::ColmapObservations observations;
  ModelOfBundle(*input, *bundle, &adjusted, &observations);
  // Not through a quaternion and a centre: to the last bit.
  for (survey::ColmapImage& image : adjusted.images) {
    if (const auto found = known.photos.find(image.name); found != known.photos.end()) image.cam_from_world = found->second.cam_from_enu;
  }
  ColorPoints(adjusted, observations, job.photo_root, threads);
  model = std::move(adjusted);
}

}  // namespace

std::vector<size_t> PhotosAround(const std::vector<input::PhotoFile>& photos, const std::vector<bool>& known) {
  SKYQUILT_CHECK(known.size() == photos.size(), "one entry per photo");
  const std::vector<std::optional<PhotoPlace>> places = FindPlaces(photos);
  std::vector<char> chosen(photos.size(), 0);
  bool all = false;
  for (size_t i = 0; i < photos.size(); ++i) {
    chosen[i] = known[i] ? 0 : 1;
    all = all || (!known[i] && !places[i]);
  }
  const PairRules rules;
  all = all || photos.size() < rules.all_below;
  if (!all) {
    PhotoPairs pairs = PairsInSpace(places, rules);
    ConnectGroups(
        photos.size(), rules.links, [&](uint32_t photo) { return PlaceCosts(places, photo); }, pairs);
    MarkPartners(pairs, chosen);
    MarkPartners(pairs, chosen);  // points of known photos are firm when several of these see them
  }
  std::vector<size_t> around;
  for (size_t i = 0; i < photos.size(); ++i) {
    if (all || chosen[i] != 0) around.push_back(i);
  }
  return around;
}

geo::Similarity3d SimilarityOfPoses(const std::vector<geo::Rigid3d>& cam_from_a, const std::vector<geo::Rigid3d>& cam_from_b) {
  const size_t n = cam_from_a.size();
  SKYQUILT_CHECK(n == cam_from_b.size() && n >= 2, "two poses of at least two photos");
  std::vector<Eigen::Quaterniond> turns;
  std::vector<Eigen::Vector3d> a, b;
  for (size_t i = 0; i < n; ++i) {
    turns.push_back((cam_from_b[i].rotation.conjugate() * cam_from_a[i].rotation).normalized());
    a.push_back(cam_from_a[i].OriginInSource());
    b.push_back(cam_from_b[i].OriginInSource());
  }
  // The turn that is nearest to the others, averaged with those as near to it as half of them are.
  size_t best = 0;
  double least = std::numeric_limits<double>::infinity();
  std::vector<double> angles(n);
  for (size_t i = 0; i < n; ++i) {
    for (size_t k = 0; k < n; ++k) angles[k] = turns[i].angularDistance(turns[k]);
    const double median = base::UpperMedian(angles);
    if (median >= least) continue;
    least = median;
    best = i;
  }
  Eigen::Vector4d sum = Eigen::Vector4d::Zero();
  for (const Eigen::Quaterniond& turn : turns) {
    if (turn.angularDistance(turns[best]) <= least) sum += turn.dot(turns[best]) < 0.0 ? -turn.coeffs() : turn.coeffs();
  }
  geo::Similarity3d map;
  map.rotation = Eigen::Quaterniond(Eigen::Vector4d(sum.normalized()));
  std::vector<double> scales;
  for (size_t i = 0; i < n; ++i) {
    for (size_t k = i + 1; k < n; ++k) {
      const double from = (a[i] - a[k]).norm(), to = (b[i] - b[k]).norm();
      if (from > 0.0 && to > 0.0) scales.push_back(to / from);
    }
  }
  if (!scales.empty()) map.scale = base::Median(std::move(scales));
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> off;
    for (size_t i = 0; i < n; ++i) off.push_back((b[i] - map.scale * (map.rotation * a[i]))[axis]);
    map.translation[axis] = base::Median(std::move(off));
  }
  return map;
}

AddedPoses FindAddedPoses(const ColmapJob& job, const std::vector<input::PhotoFile>& photos, const KnownPoses& known, const PoseOptions& options,
                          base::ThreadPool& threads, RemoteTasks* ranks) {
  const fs::path found = RunColmap(job, photos, options, threads, ranks);
  AddedPoses poses{.model = survey::ReadColmapModel(found)};
  Place(photos, known, poses);
  if (poses.model.images.empty()) {
    throw base::InputError(job.Log(), "none of the added photos can be placed beside the survey",
                           "They need features in common with its photos, or GPS tags: add photos between them, or give them a project of their own");
  }
  UseKnown(known, poses.model);
  AdjustAdded(JobOfModel(job, found), photos, known, poses.model, threads);
  std::set<std::string> placed;
  for (const survey::ColmapImage& image : poses.model.images) placed.insert(image.name);
  std::erase_if(poses.by_tags, [&](const std::string& name) { return !placed.contains(name); });
  return poses;
}

}  // namespace skyquilt::prepare::poses
