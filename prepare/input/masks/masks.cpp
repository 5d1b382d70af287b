#include "prepare/input/masks/masks.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/base/text.h"
#include "prepare/input/file_names.h"
#include "prepare/input/masks/mask_files.h"
#include "prepare/input/masks/mask_index.h"
#include "prepare/input/masks/named_masks.h"

namespace skyquilt::prepare::input {
namespace {

namespace fs = std::filesystem;

constexpr const char* kAlpha = "alpha";

// Files and folders in a folder, in name order; nothing when it cannot be opened.
std::vector<fs::path> EntriesOf(const fs::path& folder) {
  std::vector<fs::path> entries;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) entries.push_back(entry->path());
  std::sort(entries.begin(), entries.end());
  return entries;
}

// The name as if masks/ were not in it: what it is beside.
std::string BesidePhotos(const std::string& name, bool* in_mask_folder) {
  std::string result;
  *in_mask_folder = false;
  for (size_t begin = 0; begin < name.size();) {
    const size_t slash = name.find('/', begin);
    const size_t end = slash == std::string::npos ? name.size() : slash + 1;
    if (!*in_mask_folder && slash != std::string::npos && IsMaskFolder(name.substr(begin, slash - begin))) {
      *in_mask_folder = true;
    } else {
      result += name.substr(begin, end - begin);
    }
    begin = end;
  }
  return result;
}

// `photos`: paths that are no masks, as masks may lie among the photos.
void AddFolder(const fs::path& folder, const std::set<fs::path>& photos, MaskIndex& index) {
  for (const FoundFile& file : WalkFolder(folder, {}, {})) {
    const bool may_be = file.in != FoundIn::kSystemFolder && LooksLikePhoto(file.name) && !photos.contains(folder / file.name);
    if (may_be) index.Add(folder / file.name, file.name, true);
  }
}

// Of the photo folder itself: what the list says are masks.
void AddListed(const fs::path& photo_root, const std::vector<InputFile>& files, MaskIndex& index) {
  for (const InputFile& file : files) {
    if (file.kind != FileKind::kMask) continue;
    bool in_mask_folder = false;
    const std::string name = BesidePhotos(file.name, &in_mask_folder);
    index.Add(photo_root / file.name, name, in_mask_folder);
  }
}

std::string ShownPath(const fs::path& file, const fs::path& photo_root) {
  const std::string below = file.lexically_relative(photo_root).generic_string();
  return below.empty() || below.starts_with("..") ? file.string() : below;
}

// A folder, or the file itself where it is one mask for several photos.
std::string SourceOf(const std::string& origin, bool shared) {
  if (origin == kAlpha) return "the photos' alpha";
  if (shared) return origin;
  const std::string folder = fs::path(origin).parent_path().generic_string();
  return folder.empty() ? "beside the photos" : folder + "/";
}

bool MayHaveAlpha(const std::string& photo) {
  const std::string extension = base::LowerCase(PartsOf(photo).extension);
  return extension != ".jpg" && extension != ".jpeg";
}

struct Chosen {
  fs::path file;  // empty: none
  bool shared = false;
};

class MaskSearch {
 public:
  MaskSearch(const fs::path& photo_root, const MaskPlaces& places, const std::vector<PhotoFile>& photos, const std::vector<InputFile>& files)
      : root_(photo_root), places_(places), photos_(photos), files_(files), names_(NamesOf(photos)), index_(names_) {}

  std::vector<Chosen> Choose() {
    std::vector<Chosen> chosen(photos_.size());
    const bool one_file = !places_.given.empty() && !fs::is_directory(places_.given);
    if (one_file) {
      for (Chosen& one : chosen) one = {places_.given, true};
      return chosen;
    }
    if (!places_.given.empty()) {
      std::set<fs::path> paths;
      for (const std::string& name : names_) paths.insert(root_ / name);
      AddFolder(places_.given, paths, index_);
    } else {
      for (const fs::path& folder : places_.folders) AddFolder(folder, {}, index_);
      AddListed(root_, files_, index_);
      for (const fs::path& file : places_.shared) index_.Add(file, file.filename().string(), false);
    }
    const std::map<std::string, fs::path> named =
        places_.given.empty() ? NamedMasks(root_, names_, places_.transforms) : std::map<std::string, fs::path>();
    for (size_t i = 0; i < photos_.size(); ++i) {
      const std::optional<size_t> mask = index_.Find(names_[i]);
      if (mask) chosen[i].file = index_.File(*mask);
      if (const auto by_model = named.find(names_[i]); by_model != named.end()) chosen[i].file = by_model->second;
    }
    // Pictures that are left out may have masks as well.
    for (const InputFile& file : files_) {
      if (!file.Taken() && file.kind != FileKind::kMask && LooksLikePhoto(file.name)) index_.Find(file.name);
    }
    for (size_t i = 0; i < photos_.size(); ++i) {
      if (!chosen[i].file.empty()) continue;
      if (const std::optional<size_t> mask = index_.FindShared(names_[i])) chosen[i] = {index_.File(*mask), true};
    }
    TellUnfit(std::any_of(chosen.begin(), chosen.end(), [](const Chosen& one) { return !one.file.empty(); }), named);
    return chosen;
  }

 private:
  static std::vector<std::string> NamesOf(const std::vector<PhotoFile>& photos) {
    std::vector<std::string> names;
    names.reserve(photos.size());
    for (const PhotoFile& photo : photos) names.push_back(photo.name);
    return names;
  }

  void TellUnfit(bool any, const std::map<std::string, fs::path>& named) const {
    std::set<fs::path> by_model;
    for (const auto& [photo, file] : named) by_model.insert(file.lexically_normal());
    std::vector<fs::path> unfit = index_.Unfit();
    std::erase_if(unfit, [&by_model](const fs::path& file) { return by_model.contains(file.lexically_normal()); });
    const std::string how = "Name masks like " + names_.front() + ".png";
    const bool none_fits = !any && !index_.AnyFits();
    if (none_fits && !places_.given.empty()) throw base::InputError(places_.given, "has no mask for any photo", how);
    if (none_fits && index_.AnyInMaskFolder()) {
      throw base::InputError(unfit.front().parent_path(), "has no mask for any photo (but for instance " + unfit.front().filename().string() + ")",
                             how + ", or set prepare.masks = none to use none");
    }
    if (!unfit.empty())
      base::LogWarning("{} masks fit no photo and are not used, for instance {}. {}", unfit.size(), ShownPath(unfit.front(), root_), how);
  }

  const fs::path& root_;
  const MaskPlaces& places_;
  const std::vector<PhotoFile>& photos_;
  const std::vector<InputFile>& files_;
  std::vector<std::string> names_;
  MaskIndex index_;
};

void LogMasks(const std::vector<std::string>& origin, const std::vector<Chosen>& chosen) {
  std::map<std::string, size_t> sources;
  size_t n = 0;
  for (size_t i = 0; i < origin.size(); ++i) {
    if (origin[i].empty()) continue;
    ++n;
    ++sources[SourceOf(origin[i], chosen[i].shared)];
  }
  if (n == 0) return;
  std::vector<std::string> parts;
  parts.reserve(sources.size());
  for (const auto& [source, count] : sources) parts.push_back(sources.size() == 1 ? source : source + " (" + std::to_string(count) + ")");
  const size_t n_parts = std::min<size_t>(parts.size(), 5);
  base::LogInfo("masks for {} of {} photos, from {}{}", n, origin.size(), base::Join(std::span(parts).first(n_parts)),
                parts.size() > n_parts ? ", ..." : "");
}

}  // namespace

MaskPlaces FindMaskPlaces(const fs::path& photo_root, const std::string& option, const std::vector<fs::path>& transforms) {
  MaskPlaces places;
  places.none = option == "none";
  if (places.none) return places;
  if (!option.empty()) {
    if (!fs::exists(option))
      throw base::InputError(option, "no such folder", "Give the folder with masks named PHOTO.jpg.png, or one mask for all photos");
    places.given = fs::canonical(option);
    return places;
  }
  places.transforms = transforms;
  const std::string name = photo_root.filename().string();
  if (name != "images" && !name.starts_with("images_")) return places;
  // Masks for photos that nerfstudio made smaller come first.
  const std::string same_size = "masks" + name.substr(6);
  std::vector<fs::path> full_size;
  for (const fs::path& entry : EntriesOf(photo_root.parent_path())) {
    const std::string entry_name = entry.filename().string();
    std::error_code ignored;
    if (fs::is_directory(entry, ignored)) {
      if (entry_name == same_size) {
        places.folders.push_back(entry);
      } else if (IsMaskFolder(entry_name)) {
        full_size.push_back(entry);
      }
    } else if (LooksLikePhoto(entry) && IsSharedMaskStem(entry.stem().string())) {
      places.shared.push_back(entry);
    }
  }
  places.folders.insert(places.folders.end(), full_size.begin(), full_size.end());
  return places;
}

PhotoMasks FindMasks(const fs::path& photo_root, const MaskPlaces& places, const fs::path& own_folder, std::vector<PhotoFile>& photos,
                     std::vector<InputFile>& files, base::ThreadPool& threads) {
  PhotoMasks masks;
  masks.origin.resize(photos.size());
  if (places.none || photos.empty()) return masks;
  std::vector<Chosen> chosen = MaskSearch(photo_root, places, photos, files).Choose();

  std::vector<MaskJob> jobs;
  size_t n_misfit = 0;
  std::string misfit;
  for (size_t i = 0; i < photos.size(); ++i) {
    MaskJob job{.photo = &photos[i], .file = chosen[i].file};
    if (!job.file.empty()) {
      job.size = SizeOfMask(job.file, photos[i], chosen[i].shared);
      if (job.size.x() == 0) {
        ++n_misfit;
        misfit = chosen[i].file.string();
        job.file.clear();
      }
    }
    job.alpha = job.file.empty() && !photos[i].filled && MayHaveAlpha(photos[i].name) && ReadPictureHeader(photo_root / photos[i].name).has_alpha;
    jobs.push_back(std::move(job));
  }
  if (n_misfit > 0) base::LogWarning("{} has another shape than {} photos, where it is not used", misfit, n_misfit);
  masks.folder = MaskFolderOf(jobs);
  if (masks.folder.empty()) {
    const fs::path written = WriteMasks(photo_root, own_folder, jobs, threads);
    // When no alpha hides anything, the others may be in order as they are.
    masks.folder = MaskFolderOf(jobs);
    if (masks.folder.empty()) {
      masks.folder = written;
    } else {
      fs::remove_all(own_folder);
    }
  }
  for (size_t i = 0; i < photos.size(); ++i) {
    if (jobs[i].file.empty() && !jobs[i].alpha) continue;
    photos[i].mask = (masks.folder / (photos[i].name + ".png")).string();
    masks.origin[i] = jobs[i].alpha ? kAlpha : ShownPath(jobs[i].file, photo_root);
  }
  LogMasks(masks.origin, chosen);
  const auto n_scaled = std::count_if(jobs.begin(), jobs.end(), [](const MaskJob& job) {
    return !job.file.empty() && (job.size.x() != job.photo->width || job.size.y() != job.photo->height);
  });
  if (n_scaled > 0) base::LogInfo("{} masks are scaled to the size of their photos", n_scaled);

  std::map<std::string, const std::string*> origin_of;
  for (size_t i = 0; i < photos.size(); ++i) origin_of.emplace(photos[i].name, &masks.origin[i]);
  for (InputFile& file : files) {
    if (const auto found = origin_of.find(file.name); found != origin_of.end()) file.mask = *found->second;
  }
  return masks;
}

}  // namespace skyquilt::prepare::input
