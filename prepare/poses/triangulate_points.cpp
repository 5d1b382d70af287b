#include "prepare/poses/triangulate_points.h"

#include <unordered_map>

#include "core/base/child_process.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "core/survey/colmap_database.h"
#include "prepare/poses/extract_features.h"
#include "prepare/poses/fill_database.h"
#include "prepare/poses/pairs.h"

namespace skyquilt::prepare::poses {
namespace {

namespace fs = std::filesystem;

constexpr size_t kFewestPoints = 10;  // fewer are no model

using ImageOfName = std::unordered_map<std::string, const survey::ColmapImage*>;

ImageOfName ImagesByName(const survey::ColmapModel& poses) {
  ImageOfName images;
  for (const survey::ColmapImage& image : poses.images) images.emplace(image.name, &image);
  return images;
}

std::string PosesText(const survey::ColmapModel& poses) {
  std::string text;
  for (const survey::ColmapImage& image : poses.images) {
    const Eigen::Quaterniond& q = image.cam_from_world.rotation;
    const Eigen::Vector3d& t = image.cam_from_world.translation;
    text += fmt::format("{} {} {} {} {} {} {} {} {}\n", image.name, image.camera_id, q.w(), q.x(), q.y(), q.z(), t.x(), t.y(), t.z());
  }
  for (const auto& [id, camera] : poses.cameras) {
    text += fmt::format("{} {}", id, camera::ModelName(camera.model));
    for (const double parameter : camera.params) text += fmt::format(" {}", parameter);
  }
  return text;
}

// The model with the database's numbers of images.
survey::ColmapModel NumberedAs(const survey::ColmapDatabase& database, const survey::ColmapModel& poses) {
  const ImageOfName images = ImagesByName(poses);
  survey::ColmapModel numbered;
  numbered.cameras = poses.cameras;
  for (const survey::DatabaseImage& in_database : database.ReadImages()) {
    const auto found = images.find(in_database.name);
    if (found == images.end()) continue;
    numbered.images.push_back(*found->second);
    numbered.images.back().id = in_database.id;
  }
  return numbered;
}

void RunTriangulator(const ColmapJob& job, const ColmapSettings& settings, const survey::ColmapModel& poses, const PoseOptions& options) {
  const fs::path given = job.folder / "given_poses", found = job.Models() / "0";
  fs::remove_all(job.Models());
  base::RequireWritableFolder(found);
  // Closed before COLMAP opens the database.
  survey::WriteColmapText(NumberedAs(survey::ColmapDatabase(job.Database()), poses), given);
  const ColmapCommand command{
      settings.program,
      "point_triangulator",
      {"--database_path", job.Database().string(), "--image_path", job.photo_root.string(), "--input_path", given.string(), "--output_path",
       found.string(), "--Mapper.num_threads", std::to_string(settings.n_threads), "--random_seed", std::to_string(options.seed)}};
  RunWithProgress(job, command, "triangulate points", poses.images.size());
}

}  // namespace

std::vector<survey::ColmapPoint> TriangulatePoints(const ColmapJob& job, const std::vector<input::PhotoFile>& photos,
                                                   const survey::ColmapModel& poses, const PoseOptions& options, base::ThreadPool& threads,
                                                   RemoteTasks* ranks) {
  const ColmapSettings settings{.program = base::FindProgram(options.colmap), .n_threads = threads.size(), .fast = true};
  base::LogInfo("the model has no points: COLMAP triangulates some from its poses; the log is {}", job.Log().string());
  const ImageOfName images = ImagesByName(poses);
  const std::string inputs = FeatureInputs(job, settings, photos, options);
  const auto choose = [&](const std::vector<input::PhotoFile>& found, FeatureStore& /*features*/) {
    std::vector<geo::Rigid3d> cam_from_world;
    for (const input::PhotoFile& photo : found) cam_from_world.push_back(images.at(photo.name)->cam_from_world);
    PhotoPairs pairs = PairsByPose(cam_from_world, PairRules{});
    base::LogInfo("pairs: {} of {} photos, by their poses", pairs.size(), found.size());
    return pairs;
  };
  const std::string poses_hash = base::HashHex(inputs + PosesText(poses));
  FillDatabase(job, settings, photos, options, {base::HashHex(inputs), poses_hash}, choose, threads, ranks);
  RunStep(job, {kModelStep, poses_hash}, {}, [&] { RunTriangulator(job, settings, poses, options); });

  const survey::ColmapModel found = survey::ReadColmapModel(job.Models() / "0");
  std::unordered_map<uint32_t, uint32_t> id_of_found;
  for (const survey::ColmapImage& image : found.images) id_of_found.emplace(image.id, images.at(image.name)->id);
  std::vector<survey::ColmapPoint> points = found.points;
  for (survey::ColmapPoint& point : points) {
    for (uint32_t& id : point.image_ids) id = id_of_found.at(id);
  }
  if (points.size() < kFewestPoints) {
    throw base::InputError(job.Log(), fmt::format("COLMAP triangulated {} points only from the poses of the model", points.size()),
                           "Check that the model was made from these photos; leave out --model to let COLMAP find the poses too");
  }
  base::LogInfo("{} points triangulated from the poses of {} photos", points.size(), photos.size());
  return points;
}

}  // namespace skyquilt::prepare::poses
