#include "masks/make_masks.h"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/base/progress.h"
#include "core/base/text.h"

namespace skyquilt::masks {
namespace {

namespace fs = std::filesystem;

constexpr double kMuch = 0.5;        // share of all pixels
constexpr double kNearlyAll = 0.95;  // share of a photo
constexpr size_t kNamed = 3;
constexpr int kPhotosPerThread = 4;  // of a task: long enough to be worth a message, short enough that all ranks end together

double Percent(int64_t part, int64_t all) {
  return all == 0 ? 0.0 : 100.0 * static_cast<double>(part) / static_cast<double>(all);
}

void LogMasks(const survey::MadeMasks& masks, const fs::path& folder) {
  int64_t pixels = 0, ignored = 0, given = 0, network = 0, ground = 0;
  size_t n_ignored = 0, n_network = 0, n_ground = 0;
  std::vector<std::string> nearly_all;
  for (const survey::MadeMask& mask : masks.photos) {
    pixels += mask.pixels;
    ignored += mask.ignored;
    given += mask.given;
    network += mask.network;
    ground += mask.ground;
    if (mask.ignored > 0) ++n_ignored;
    if (mask.network > 0) ++n_network;
    if (mask.ground > 0) ++n_ground;
    if (static_cast<double>(mask.ignored) > kNearlyAll * static_cast<double>(mask.pixels)) nearly_all.push_back(mask.photo);
  }
  const size_t n = masks.photos.size();
  if (!masks.network.empty()) {
    base::LogInfo("masks: {} finds {} in {} of {} photos: {} pixels, {:.2f} % of all", masks.network, base::Join(masks.classes), n_network, n,
                  network, Percent(network, pixels));
  }
  if (!masks.ground.empty()) {
    base::LogInfo("masks: {} of {} photos show ground that {} says to ignore: {} pixels, {:.2f} % of all", n_ground, n, masks.ground, ground,
                  Percent(ground, pixels));
  }
  base::LogInfo("masks: {:.2f} % of all pixels are ignored, in {} of {} photos ({:.2f} % by given masks); to look through: {}",
                Percent(ignored, pixels), n_ignored, n, Percent(given, pixels), (folder / "look").string());
  if (Percent(ignored, pixels) > 100.0 * kMuch) {
    base::LogWarning(
        "more than half of all pixels are ignored; look through {}: a network with a wrong scale, mean or order of classes ignores "
        "what it should not",
        (folder / "look").string());
  }
  if (!nearly_all.empty()) {
    const size_t named = std::min(kNamed, nearly_all.size());
    base::LogWarning("{} photos are ignored but for a twentieth or less, and teach nearly nothing: {}{}", nearly_all.size(),
                     base::Join(std::span(nearly_all).first(named)), named < nearly_all.size() ? ", ..." : "");
  }
}

}  // namespace

survey::MadeMasks MakeMasks(const fs::path& survey_folder, const MaskOptions& given, int n_threads, RemoteTasks* ranks) {
  MaskOptions options = given;
  for (std::string* const file : {&options.segment, &options.segment_config, &options.ignore_ground}) {
    if (!file->empty()) *file = fs::absolute(*file).string();  // other processes may run elsewhere
  }
  options.Check();
  // First: from here on the survey's masks are those that were given.
  std::error_code ignored;
  fs::remove(survey::MadeMasksFile(survey_folder), ignored);
  survey::MadeMasks masks;
  if (!options.Any()) {
    fs::remove_all(survey::MadeMasksFolder(survey_folder), ignored);
    return masks;
  }
  const survey::Survey survey = survey::LoadSurvey(survey_folder);
  // What cannot be used is refused here, before ranks are called.
  if (!options.segment.empty()) {
    masks.network = fs::path(options.segment).filename().string();
    masks.classes = Segmenter(options.segment, options.segment_config).config().IgnoredClasses();
  }
  if (!options.ignore_ground.empty()) {
    masks.ground = fs::path(options.ignore_ground).filename().string();
    masks.ground_rings = IgnoredGround(survey, options.ignore_ground).rings();
  }
  MaskTask all{.survey_folder = survey_folder, .options = options, .photos = std::vector<size_t>(survey.photos.size())};
  std::iota(all.photos.begin(), all.photos.end(), size_t{0});
  {
    base::Progress progress("masks", static_cast<double>(all.photos.size()), "photos");
    const TaskProgress advance = [&progress](double more) { progress.Advance(more); };
    if (ranks == nullptr) {
      MaskRunner(n_threads).Run(all, advance);
    } else {
      const auto chunk = static_cast<size_t>(std::max(1, kPhotosPerThread * ranks->threads()));
      std::vector<std::string> tasks;
      for (size_t begin = 0; begin < all.photos.size(); begin += chunk) {
        MaskTask part{survey_folder, options, {}};
        part.photos.assign(all.photos.begin() + static_cast<std::ptrdiff_t>(begin),
                           all.photos.begin() + static_cast<std::ptrdiff_t>(std::min(begin + chunk, all.photos.size())));
        tasks.push_back(ToText(part));
      }
      ranks->Run(tasks, advance);
    }
    progress.Finish();
  }
  for (const survey::Photo& photo : survey.photos) masks.photos.push_back(ReadMadeMask(survey_folder, photo.name));
  survey::SaveMadeMasks(masks, survey_folder);
  LogMasks(masks, survey::MadeMasksFolder(survey_folder));
  return masks;
}

}  // namespace skyquilt::masks
