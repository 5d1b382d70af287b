#include "prepare/held_out_photos.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <unordered_set>

#include "core/base/errors.h"
#include "core/base/log.h"
#include "prepare/bundle/resect.h"
#include "prepare/holdout.h"
#include "prepare/input/input_table.h"
#include "prepare/model_use.h"

namespace skyquilt::prepare {

std::set<std::string> ChooseHeldOut(const PrepareOptions& options, const models::InputModel& model, const std::filesystem::path& model_path,
                                    const std::vector<input::PreparedPhoto>& photos, const std::vector<std::string>& names) {
  survey::Survey survey;
  std::set<std::string> with_pose;
  for (const input::PreparedPhoto& photo : photos) {
    survey.photos.emplace_back().name = photo.file.name;
    with_pose.insert(photo.file.name);
  }
  std::set_difference(names.begin(), names.end(), with_pose.begin(), with_pose.end(), std::back_inserter(survey.unregistered));
  std::map<std::string, std::string> shot_of_photo;
  for (const input::PreparedPhoto& photo : photos) {
    if (photo.file.rig) shot_of_photo.emplace(photo.file.name, photo.file.rig->shot);
  }
  MarkHoldout(ParseHoldout(options.holdout), shot_of_photo, survey);
  if (options.holdout == PrepareOptions().holdout) HoldOutByModel(model, model_path, survey);
  std::set<std::string> held_out;
  for (const survey::Photo& photo : survey.photos) {
    if (photo.is_test) held_out.insert(photo.name);
  }
  return held_out;
}

std::optional<WithheldPhotos> Withhold(const std::set<std::string>& held_out, const std::vector<input::PreparedPhoto>& photos,
                                       const std::filesystem::path& model_folder, bool has_observations, survey::ColmapModel& model,
                                       base::ThreadPool& threads) {
  std::unordered_set<uint32_t> images;
  for (const input::PreparedPhoto& photo : photos) {
    if (held_out.contains(photo.file.name)) images.insert(model.images[photo.image].id);
  }
  std::optional<WithheldPhotos> withheld;
  std::string reason = "the model has no observations of points in photos, or its poses are exact";
  try {
    if (has_observations) withheld = WithholdPhotos(images, survey::ReadColmapObservations(model_folder), model, threads, &reason);
  } catch (const base::InputError& error) {
    reason = error.what();
  }
  if (!withheld) base::LogWarning("held-out photos keep the poses of the model, in spite of prepare.holdout_poses: {}", reason);
  return withheld;
}

std::vector<input::PreparedPhoto> PutBack(const WithheldPhotos& withheld, const std::set<std::string>& held_out,
                                          const input::FileOfImage& file_of_image, const std::vector<input::PhotoFile>& files,
                                          survey::ColmapModel& model, georeference::Georeference& georeference) {
  const std::vector<std::string> lost = ResectWithheld(withheld, model);
  if (lost.size() == withheld.images.size()) {
    throw base::UsageError(
        fmt::format("prepare.holdout_poses = resected: none of the {} held-out photos ({}) sees enough points of the others to be placed by them. "
                    "Set it to given, or "
                    "hold out photos that overlap more with others (prepare.holdout), and add --restart",
                    lost.size(), input::FewNames(lost)));
  }
  if (!lost.empty()) {
    base::LogWarning("{} held-out photos get no pose, because they see fewer than {} points of the others: {}", lost.size(),
                     bundle::kLeastObservations, input::FewNames(lost));
  }
  std::vector<input::PreparedPhoto> photos = input::PreparePhotos(model, file_of_image, files);
  AddResected(photos, held_out, georeference);
  return photos;
}

}  // namespace skyquilt::prepare
