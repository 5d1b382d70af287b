#include "coordinator/planning/work_size.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/base/order_statistics.h"
#include "core/survey/exif.h"
#include "core/survey/view_kind.h"
#include "partition/capacity.h"
#include "prepare/holdout.h"
#include "prepare/input/input_folder.h"
#include "prepare/input/list_files.h"

namespace skyquilt::coordinator {
namespace {

// Surveys show each place in 5 to 13 photos; with what lies around the area about a tenth of all pixels is new.
constexpr double kNewShareOfPhotos = 0.12;
constexpr size_t kPhotosLookedAt = 8;
constexpr double kLevelPitch_deg = -30.0;

// "prepare" says all of it again.
class QuietLog {
 public:
  QuietLog() : level_(base::GetLogLevel()) { base::SetLogLevel(base::LogLevel::kError); }
  ~QuietLog() { base::SetLogLevel(level_); }
  QuietLog(const QuietLog&) = delete;
  QuietLog& operator=(const QuietLog&) = delete;

 private:
  base::LogLevel level_;
};

int HeldOutOf(const std::string& holdout, int photos) {
  const prepare::Holdout rule = prepare::ParseHoldout(holdout);
  if (rule.every > 0) return std::max(0, (photos - rule.offset + rule.every - 1) / rule.every);
  return rule.list.empty() ? 0 : photos / 8;
}

// Positions and directions of some photos stand for all.
void LookAtTags(const std::filesystem::path& root, const std::vector<std::string>& names, WorkSize* size) {
  const size_t step = std::max<size_t>(1, names.size() / kPhotosLookedAt);
  int looked = 0, placed = 0, level = 0, directed = 0;
  for (size_t i = 0; i < names.size(); i += step) {
    try {
      const survey::PhotoTags tags = survey::ReadPhotoTags(root / names[i]);
      ++looked;
      if (tags.gps) ++placed;
      if (tags.gimbal_pitch_deg) ++directed;
      if (tags.gimbal_pitch_deg && *tags.gimbal_pitch_deg > kLevelPitch_deg) ++level;
    } catch (const base::InputError&) {
      // "prepare" says what is wrong with it.
    }
  }
  size->tagged = looked == 0 || 2 * placed >= looked;
  size->level = directed > 0 && 2 * level > directed;
}

// 0 where no height above ground is known.
double PhotoGsd(const survey::Survey& survey) {
  std::vector<double> heights;
  for (const survey::Photo& photo : survey.photos) {
    if (photo.agl_m > 0.0) heights.push_back(photo.agl_m);
  }
  return heights.empty() ? 0.0 : partition::SurveyGsd(survey, base::Median(std::move(heights)), 0);
}

}  // namespace

double WorkSize::PixelsAt(int image_width) const {
  if (image_width == kAutoWidth) return PixelsAt(kLeastAutoWidth);
  if (image_width <= 0 || photo_width <= 0 || image_width >= photo_width) return photo_pixels;
  const double scale = static_cast<double>(image_width) / photo_width;
  return photo_pixels * scale * scale;
}

double WorkSize::SurfacePixelsAt(int image_width) const {
  return photo_pixels > 0.0 ? surface_pixels * PixelsAt(image_width) / photo_pixels : 0.0;
}

double WorkSize::GsdAt(int image_width) const {
  if (image_width == kAutoWidth) return GsdAt(kLeastAutoWidth);
  return image_width > 0 && image_width < photo_width ? photo_gsd_m * photo_width / image_width : photo_gsd_m;
}

double WorkSize::Speedup() const {
  const int workers = ranks > 1 ? ranks - 1 : 1;
  return std::max(1, machines) * static_cast<double>(workers) / std::max(1, ranks);
}

WorkSize CountPhotos(const std::filesystem::path& photos, const std::filesystem::path& model, const Settings& settings,
                     const std::filesystem::path& project_folder, base::ThreadPool& threads) {
  const QuietLog quiet;
  const prepare::input::InputFolder folders = prepare::input::FindInputs(photos, model, settings.prepare.masks);
  prepare::input::ListOptions list{.skip = {}, .masks = folders.masks.given, .patterns = settings.prepare.photos};
  if (!project_folder.empty()) list.skip.push_back(std::filesystem::absolute(project_folder));
  WorkSize size;
  std::vector<std::string> names;
  for (const prepare::input::InputFile& file : prepare::input::ListInput(folders.photo_root, list, threads)) {
    if (!file.Taken()) continue;
    names.push_back(file.name);
    size.photo_pixels += static_cast<double>(file.width) * file.height;
    size.photo_width = std::max(size.photo_width, file.width);
  }
  size.photos = static_cast<int>(names.size());
  size.photo_pixels /= std::max(1, size.photos);
  size.held_out = HeldOutOf(settings.prepare.holdout, size.photos);
  size.surface_pixels = kNewShareOfPhotos * size.photos * size.photo_pixels;
  size.poses_given = !folders.model.empty();
  size.truth = folders.truth.has_value();
  size.threads = settings.run.UsableThreads();
  LookAtTags(folders.photo_root, names, &size);
  size.tagged = size.tagged || !settings.prepare.geo_file.empty();
  return size;
}

void CountSurvey(const survey::Survey& survey, WorkSize* size) {
  if (survey.photos.empty()) return;
  size->photos = static_cast<int>(survey.photos.size());
  size->held_out = static_cast<int>(std::count_if(survey.photos.begin(), survey.photos.end(), [](const survey::Photo& p) { return p.is_test; }));
  double pixels = 0.0;
  size->photo_width = 0;
  for (const survey::Photo& photo : survey.photos) {
    const camera::Camera& camera = survey.cameras[static_cast<size_t>(photo.camera)];
    pixels += static_cast<double>(camera.width) * camera.height;
    size->photo_width = std::max(size->photo_width, camera.width);
  }
  size->photo_pixels = pixels / size->photos;
  size->surface_pixels = kNewShareOfPhotos * pixels;
  size->level = survey::LooksLevel(survey);
  size->photo_gsd_m = size->level ? 0.0 : PhotoGsd(survey);
  size->truth = survey.truth.has_value();
}

void CountBlocks(const partition::BlockSet& blocks, WorkSize* size) {
  size->blocks = 0;
  size->log2_table_size = 0;
  double pixels = 0.0, finest_m = std::numeric_limits<double>::infinity();
  for (const partition::Block& block : blocks.blocks) {
    if (block.empty) continue;
    ++size->blocks;
    size->log2_table_size = std::max(size->log2_table_size, block.log2_table_size);
    if (!(block.gsd_m > 0.0)) continue;
    finest_m = std::min(finest_m, block.gsd_m);
    const Eigen::Vector3d extent = block.max_enu - block.min_enu;
    pixels += extent.x() * extent.y() / (block.gsd_m * block.gsd_m);
  }
  size->blocks = std::max(1, size->blocks);
  // Walls are no part of a block's ground.
  if (size->level || !(pixels > 0.0)) return;
  const bool reduced = blocks.image_width > 0 && blocks.image_width < size->photo_width;
  size->photo_gsd_m = reduced ? finest_m * blocks.image_width / size->photo_width : finest_m;
  const double trained = size->PixelsAt(blocks.image_width);
  if (trained > 0.0) size->surface_pixels = pixels * size->photo_pixels / trained;
}

}  // namespace skyquilt::coordinator
