#include "masks/mask_runner.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/packed_bytes.h"
#include "masks/mask_pictures.h"

namespace skyquilt::masks {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr int kLookWidth = 800;     // pixels
constexpr int kGroundWidth = 1600;  // photos are reduced to it to find the pixels on ignored ground
constexpr int kLookQuality = 85;
constexpr const char* kVersion = "1";  // of what is written per photo

// Files of one photo, relative to made_masks/.
std::string CombinedName(const std::string& photo) {
  return "combined/" + photo + ".png";
}
std::string LookName(const std::string& photo) {
  return "look/" + photo + ".jpg";
}
std::string NetworkName(const std::string& photo) {
  return "network/" + photo + ".png";
}
std::string RecordName(const std::string& photo) {
  return "photos/" + photo + ".json";
}

std::string DigestOf(const fs::path& file) {
  return base::HashHex(base::ReadFile(file));
}

// Written behind the file that it speaks of.
std::string KeyBeside(const fs::path& file) {
  const fs::path key = file.string() + ".key";
  return fs::exists(key) && fs::exists(file) ? base::ReadFile(key) : std::string();
}

std::string PoseText(const survey::Photo& photo, const camera::Camera& camera) {
  base::BytePacker bytes;
  bytes.Add(camera::ModelName(camera.model));
  bytes.Add(camera.width);
  bytes.Add(camera.height);
  bytes.Add(camera.params);
  for (const double value : photo.cam_from_enu.rotation.coeffs()) bytes.Add(value);
  for (const double value : photo.cam_from_enu.translation) bytes.Add(value);
  return bytes.Take();
}

void RequireFolderOf(const fs::path& file) {
  std::error_code error;
  fs::create_directories(file.parent_path(), error);
  if (error) throw base::InputError(file.parent_path(), "cannot be made: " + error.message(), "Check the permissions of the project folder");
}

// Whether the files of a photo were made of the same, and are all there.
bool IsMade(const fs::path& folder, const std::string& photo, const std::string& key) {
  const fs::path record = folder / RecordName(photo);
  if (!fs::exists(record)) return false;
  const json value = base::TryParseJson(base::ReadFile(record));
  if (!value.is_object() || value.value("key", "") != key) return false;
  const std::string file = value.value("file", ""), look = value.value("look", "");
  return (file.empty() || fs::exists(folder / file)) && (look.empty() || fs::exists(folder / look));
}

}  // namespace

std::string ToText(const MaskTask& task) {
  return base::JsonText(json{{"survey_folder", task.survey_folder.string()},
                             {"segment", task.options.segment},
                             {"segment_config", task.options.segment_config},
                             {"ignore_ground", task.options.ignore_ground},
                             {"photos", task.photos}});
}

MaskTask TaskFromText(const std::string& text) {
  const json value = base::ParseJson(text);
  MaskTask task{
      .survey_folder = value.at("survey_folder").get<std::string>(), .options = {}, .photos = value.at("photos").get<std::vector<size_t>>()};
  task.options.segment = value.at("segment").get<std::string>();
  task.options.segment_config = value.at("segment_config").get<std::string>();
  task.options.ignore_ground = value.at("ignore_ground").get<std::string>();
  return task;
}

void MaskRunner::Open(const MaskTask& task) {
  if (opened_ && ToText({task.survey_folder, task.options, {}}) == ToText(*opened_)) return;
  opened_.reset();
  survey_ = survey::LoadSurvey(task.survey_folder);
  ground_.reset();
  if (!task.options.ignore_ground.empty()) ground_.emplace(survey_, task.options.ignore_ground);
  segmenters_.clear();
  segmenters_.resize(static_cast<size_t>(threads_.size()));
  opened_ = MaskTask{task.survey_folder, task.options, {}};
  if (!task.options.segment.empty()) SegmenterOf(0);
}

Segmenter& MaskRunner::SegmenterOf(size_t thread) {
  std::unique_ptr<Segmenter>& segmenter = segmenters_[thread];
  if (!segmenter) segmenter = std::make_unique<Segmenter>(opened_->options.segment, opened_->options.segment_config);
  return *segmenter;
}

void MaskRunner::Run(const MaskTask& task, const TaskProgress& on_progress) {
  const network::OneThreadPerNetwork one_each;  // as many photos at a time as there are threads
  Open(task);
  threads_.ParallelFor(static_cast<int64_t>(task.photos.size()), [&](int64_t i, int thread) {
    base::ThrowIfCancelled();
    MaskPhoto(task.photos[static_cast<size_t>(i)], static_cast<size_t>(thread));
    on_progress(1.0);
  });
}

image::Image8 MaskRunner::NetworkMask(const survey::Photo& photo, const std::string& key, size_t thread) {
  const fs::path file = survey::MadeMasksFolder(opened_->survey_folder) / NetworkName(photo.name);
  if (KeyBeside(file) == key) return image::LoadMask(file);
  Segmenter& segmenter = SegmenterOf(thread);
  image::Image8 mask = segmenter.Mask(image::LoadReducedRgb8(survey_.photo_root / photo.name, segmenter.config().photo_width));
  RequireFolderOf(file);
  fs::remove(file.string() + ".key");
  image::SavePng(mask, file);
  base::WriteFileAtomically(file.string() + ".key", key);
  return mask;
}

void MaskRunner::MaskPhoto(size_t index, size_t thread) {
  SKYQUILT_CHECK(index < survey_.photos.size(), "a photo that the survey does not have");
  const survey::Photo& photo = survey_.photos[index];
  const camera::Camera& camera = survey_.cameras[static_cast<size_t>(photo.camera)];
  const fs::path folder = survey::MadeMasksFolder(opened_->survey_folder), picture = survey_.photo_root / photo.name;
  const bool segments = !opened_->options.segment.empty();
  const std::string network_key = segments ? base::HashHex(SegmenterOf(0).Key() + DigestOf(picture)) : "";
  const std::string key = base::HashHex(network_key + "|" + (photo.mask.empty() ? "" : DigestOf(photo.mask)) + "|" +
                                        (ground_ ? ground_->Key() + PoseText(photo, camera) : "") + "|" + kVersion);
  if (IsMade(folder, photo.name, key)) return;

  survey::MadeMask made{.photo = photo.name};
  int width = 0, height = 0;
  image::ReadImageSize(picture, &width, &height);
  MaskParts parts;
  if (!photo.mask.empty()) parts.given = image::LoadMask(photo.mask);
  if (!parts.given.Empty() && (parts.given.width != width || parts.given.height != height)) {
    throw base::InputError(photo.mask, "is a mask of another size than its photo", "A mask must have its photo's size");
  }
  if (segments) parts.network = image::ResizeMask(NetworkMask(photo, network_key, thread), width, height);
  if (ground_) {
    const int small = std::min(width, kGroundWidth);
    const camera::Camera reduced = camera.Resized(small, image::ScaledHeight(width, height, small));
    parts.ground = image::ResizeMask(ground_->Mask(reduced, photo.cam_from_enu), width, height);
  }
  const JoinedMask joined = Join(parts, width, height);
  made.pixels = int64_t{width} * height;
  made.ignored = joined.ignored;
  made.given = joined.given;
  made.network = joined.network;
  made.ground = joined.ground;
  for (const std::string& old : {CombinedName(photo.name), LookName(photo.name)}) fs::remove(folder / old);
  if (joined.differs) {
    made.file = CombinedName(photo.name);
    RequireFolderOf(folder / made.file);
    image::SavePng(joined.mask, folder / made.file);
  }
  if (joined.ignored > 0) {
    made.look = LookName(photo.name);
    RequireFolderOf(folder / made.look);
    image::SaveJpeg(LookPicture(image::LoadReducedRgb8(picture, kLookWidth), parts, kLookWidth), folder / made.look, kLookQuality);
  }
  // Last: what it names is there.
  nlohmann::ordered_json record = survey::ToJson(made);
  record["key"] = key;
  RequireFolderOf(folder / RecordName(photo.name));
  base::WriteFileAtomically(folder / RecordName(photo.name), base::JsonText(record) + "\n");
}

survey::MadeMask ReadMadeMask(const fs::path& survey_folder, const std::string& photo) {
  const fs::path file = survey::MadeMasksFolder(survey_folder) / RecordName(photo);
  constexpr const char* kRemove = "Remove it and run the same command again";
  try {
    return survey::MadeMaskFromJson(base::ParseJson(base::ReadFile(file)));
  } catch (const json::exception& error) {
    throw base::InputError(file, std::string("is damaged (") + error.what() + ")", kRemove);
  } catch (const std::invalid_argument& error) {
    throw base::InputError(file, error.what(), kRemove);
  }
}

}  // namespace skyquilt::masks
