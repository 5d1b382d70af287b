// Which files are photos.
#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

#include "core/base/text.h"
#include "core/image/develop.h"
#include "prepare/input/file_names.h"
#include "prepare/input/glob.h"
#include "prepare/input/list_files.h"

namespace skyquilt::prepare::input {
namespace {

// Fewer photos in colour than one for so many bands are not what the flight was for.
constexpr size_t kMostBands = 12;
constexpr size_t kFewestPhotos = 3;
// A thermal camera has far fewer pixels than the one beside it.
constexpr int64_t kTimesThermal = 4;

struct Candidate {
  InputFile file;
  FoundFile found;
  PictureHeader header;
  NameParts parts;
  FileGroup group = FileGroup::kOther;
};

std::string Key(const Candidate& one, const std::string& stem) {
  return one.parts.folder + base::LowerCase(stem);
}

int64_t AreaOf(const Candidate& one) {
  return int64_t{one.header.width} * one.header.height;
}

bool IsTiff(const Candidate& one) {
  const std::string extension = base::LowerCase(one.parts.extension);
  return extension == ".tif" || extension == ".tiff";
}

// JPEGs have the camera's tags, PNGs hardly any. What must be developed takes longest.
int RankOfForm(const Candidate& one) {
  const std::string extension = base::LowerCase(one.parts.extension);
  if (one.group == FileGroup::kHeic) return 3;
  if (one.group == FileGroup::kRaw) return 4;
  return extension == ".png" ? 2 : IsTiff(one) ? 1 : 0;
}

bool MayBeOneChannel(const Candidate& one) {
  return one.header.channels <= 1;
}

class Chooser {
 public:
  explicit Chooser(std::vector<Candidate> all) : all_(std::move(all)) {}

  void Choose(const std::vector<std::string>& patterns) {
    for (Candidate& one : all_) StartWith(one);
    FindMasksBesidePhotos();
    ForPhotos([](Candidate& one) {
      if (IsThumbnailStem(one.parts.stem)) LeaveOut(one, FileKind::kThumbnail, "thumbnail by its name");
      if (one.header.is_map) LeaveOut(one, FileKind::kMap, "map with a geo-reference (GeoTIFF)");
      if (IsTiff(one) && IsMapStem(one.parts.stem)) LeaveOut(one, FileKind::kMap, "map by its name");
    });
    DecideProjectImages();
    KeepOneForm();
    LeaveOutBands();
    LeaveOutThermal();
    if (!patterns.empty()) UsePatterns(patterns);
    NameOtherForms();
  }

  std::vector<InputFile> Files() {
    std::vector<InputFile> files;
    std::set<std::string> projects_with_photos;
    ForPhotos([&](const Candidate& one) {
      if (one.found.in == FoundIn::kProjectImages) projects_with_photos.insert(one.found.outer);
    });
    std::map<std::string, std::pair<size_t, InputFile>> folders;
    for (Candidate& one : all_) {
      // Results of other programs may be ten thousands of files: one line for all.
      if (one.file.kind == FileKind::kProject) {
        auto& [n_pictures, folder] = folders[one.found.outer];
        n_pictures += one.group == FileGroup::kPicture ? 1 : 0;
        folder.name = one.found.outer;
        const bool rest = projects_with_photos.contains(one.found.outer);
        folder.kind = one.found.project && !rest ? FileKind::kProject : FileKind::kResult;
        folder.reason = rest ? "rest of " + one.found.why + " whose images/ are taken" : one.found.why;
        continue;
      }
      if (one.group != FileGroup::kOther) one.file.shot = one.parts.folder + ShotOf(one.parts.stem);
      one.file.width = one.header.width;
      one.file.height = one.header.height;
      files.push_back(std::move(one.file));
    }
    for (auto& [name, folder] : folders) {
      if (folder.first == 0) folder.second.kind = FileKind::kResult;
      folder.second.reason += ", with " + std::to_string(folder.first) + (folder.first == 1 ? " picture" : " pictures");
      files.push_back(std::move(folder.second));
    }
    std::sort(files.begin(), files.end(), [](const InputFile& a, const InputFile& b) { return a.name < b.name; });
    return files;
  }

 private:
  static void LeaveOut(Candidate& one, FileKind kind, const std::string& reason) {
    if (!one.file.Taken()) return;
    one.file.kind = kind;
    one.file.reason = reason;
  }

  template <typename Action>
  void ForPhotos(const Action& action) {
    for (Candidate& one : all_) {
      if (one.file.Taken()) action(one);
    }
  }

  template <typename Condition>
  size_t CountPhotos(const Condition& condition) const {
    return static_cast<size_t>(std::count_if(all_.begin(), all_.end(), [&](const Candidate& one) { return one.file.Taken() && condition(one); }));
  }

  // By its folder and its extension.
  static void StartWith(Candidate& one) {
    const auto set = [&one](FileKind kind, const std::string& reason) {
      one.file.kind = kind;
      one.file.reason = reason;
    };
    const std::string file_name = one.parts.stem + one.parts.extension;
    if (one.found.in == FoundIn::kSystemFolder) return set(FileKind::kSystem, one.found.why);
    if (one.found.in == FoundIn::kResultFolder) return set(FileKind::kProject, one.found.why);
    if (IsHiddenName(file_name)) return set(FileKind::kSystem, file_name.starts_with("._") ? "left there by macOS, not a picture" : "hidden file");
    switch (one.group) {
      case FileGroup::kPicture:
        break;
      case FileGroup::kHeic:
      case FileGroup::kRaw:
        if (image::NeedsDeveloping(file_name)) break;
        return set(FileKind::kUnread, "cannot be read (" + GroupName(one.group) + ")");
      case FileGroup::kOther:
        return set(IsModelName(file_name) ? FileKind::kModel : FileKind::kOther,
                   IsModelName(file_name) ? "camera model, used if given with --model" : "not a picture");
      default:
        return set(FileKind::kUnread, "cannot be read (" + GroupName(one.group) + ")");
    }
    if (one.found.in == FoundIn::kMaskFolder) return set(FileKind::kMask, one.found.why);
    if (one.found.in == FoundIn::kThumbnailFolder) return set(FileKind::kThumbnail, one.found.why);
    set(FileKind::kPhoto, "");
  }

  static bool IsModelName(const std::string& file_name) {
    const std::string name = base::LowerCase(file_name);
    return name == "transforms.json" || name == "transforms_train.json" || name == "poses_bounds.npy" || name == "reconstruction.json" ||
           name == "cameras.xml" || name.ends_with(".opf");
  }

  // The images/ of a project are copies when photos lie around the project or have the same names.
  void DecideProjectImages() {
    std::set<std::string> folders, names, taken;
    std::map<std::string, std::vector<Candidate*>> projects;
    ForPhotos([&](Candidate& one) {
      if (one.found.in == FoundIn::kProjectImages) {
        projects[one.found.outer].push_back(&one);
      } else {
        folders.insert(one.parts.folder);
        names.insert(base::LowerCase(one.parts.stem));
      }
    });
    for (const auto& [project, images] : projects) {
      const bool around =
          std::any_of(folders.begin(), folders.end(), [&outer = project](const std::string& folder) { return outer.starts_with(folder); });
      const auto n_same =
          std::count_if(images.begin(), images.end(), [&names](const Candidate* one) { return names.contains(base::LowerCase(one->parts.stem)); });
      const bool same = 2 * static_cast<size_t>(n_same) >= images.size();
      if (!around && !same) taken.insert(project);
    }
    // With their masks.
    for (Candidate& one : all_) {
      if (!one.found.project || taken.contains(one.found.outer)) continue;
      if (!one.file.Taken() && one.file.kind != FileKind::kMask) continue;
      one.file.kind = FileKind::kProject;
      one.file.reason = one.found.why;
    }
  }

  void FindMasksBesidePhotos() {
    std::set<std::string> stems, names;
    std::map<std::string, bool> photo_in_colour;  // by folder and stem, of JPEG and TIFF
    size_t n_pictures = 0;
    ForPhotos([&](Candidate& one) {
      if (!MaskedStem(one.parts.stem) && !IsSharedMaskStem(one.parts.stem)) ++n_pictures;
      stems.insert(Key(one, one.parts.stem));
      names.insert(Key(one, one.parts.stem + one.parts.extension));
      if (RankOfForm(one) < 2 && one.header.channels == 3) photo_in_colour[Key(one, one.parts.stem)] = true;
    });
    if (n_pictures == 0) return;
    ForPhotos([&](Candidate& one) {
      const std::string& stem = one.parts.stem;
      if (IsSharedMaskStem(stem)) return LeaveOut(one, FileKind::kMask, "mask of all photos, by its name");
      if (const std::optional<std::string> photo = MaskedStem(stem)) {
        return LeaveOut(
            one, FileKind::kMask,
            stems.contains(Key(one, *photo)) || names.contains(Key(one, *photo)) ? "mask of " + *photo + ", by its name" : "mask, by its name");
      }
      if (GroupOf(stem) == FileGroup::kPicture && names.contains(Key(one, stem)))
        return LeaveOut(one, FileKind::kMask, "mask of " + stem + ", by its name");
      const bool black_and_white = RankOfForm(one) == 2 && one.header.channels == 1;
      if (black_and_white && photo_in_colour.contains(Key(one, stem)))
        LeaveOut(one, FileKind::kMask, "mask: in black and white beside a photo of its name");
    });
  }

  void KeepOneForm() {
    std::map<std::string, std::vector<Candidate*>> forms;
    ForPhotos([&](Candidate& one) { forms[Key(one, one.parts.stem)].push_back(&one); });
    for (const auto& [key, files] : forms) {
      const Candidate* best =
          *std::min_element(files.begin(), files.end(), [](const Candidate* a, const Candidate* b) { return RankOfForm(*a) < RankOfForm(*b); });
      for (Candidate* one : files) {
        if (RankOfForm(*one) > RankOfForm(*best)) LeaveOut(*one, FileKind::kOtherForm, "another form of " + best->file.name + ", which is taken");
      }
    }
  }

  // The band of a file: by its name, and without colours in its header.
  std::map<Candidate*, std::string> BandsByName() {
    std::map<Candidate*, std::string> bands;
    std::map<std::string, std::vector<std::pair<Candidate*, std::string>>> numbered;
    ForPhotos([&](Candidate& one) {
      if (!IsTiff(one) || !MayBeOneChannel(one)) return;
      if (const std::optional<ShotName> name = BandName(one.parts.stem)) {
        bands[&one] = name->camera;
      } else if (const std::optional<ShotName> number = NumberedBandName(one.parts.stem)) {
        numbered[Key(one, number->shot)].emplace_back(&one, number->camera);
      }
    });
    // Few bands, or few shots with bands, may be photos that somebody numbered.
    std::erase_if(numbered, [](const auto& shot) { return shot.second.size() < 3; });
    if (numbered.size() < kFewestPhotos) return bands;
    for (const auto& [shot, files] : numbered) bands.insert(files.begin(), files.end());
    return bands;
  }

  void LeaveOutBands() {
    const std::map<Candidate*, std::string> bands = BandsByName();
    std::set<const Candidate*> named;
    for (const auto& [one, band] : bands) named.insert(one);
    const auto is_band = [&](const Candidate& one) { return named.contains(&one); };
    const auto is_gray = [&](const Candidate& one) { return is_band(one) || (IsTiff(one) && one.header.channels == 1); };
    const size_t n_gray = CountPhotos(is_gray);
    if (n_gray == 0) return;
    const size_t n_colour = CountPhotos([&](const Candidate& one) { return !is_gray(one); });
    if (n_colour >= kFewestPhotos && n_colour * kMostBands >= n_gray) {
      ForPhotos([&](Candidate& one) {
        if (is_band(one)) return LeaveOut(one, FileKind::kBand, "single band beside photos in colour, by its name");
        if (is_gray(one)) LeaveOut(one, FileKind::kBand, "one channel, beside photos in colour");
      });
      return;
    }
    TakeOneBand(bands);
  }

  // Of shots that are nothing but bands.
  void TakeOneBand(const std::map<Candidate*, std::string>& bands) {
    std::map<std::string, std::pair<size_t, int64_t>> sizes;  // of each band: files, pixels of the smallest
    for (const auto& [one, band] : bands) {
      auto& [n_files, area] = sizes[band];
      area = n_files == 0 ? AreaOf(*one) : std::min(area, AreaOf(*one));
      ++n_files;
    }
    if (sizes.size() < 2) return;
    size_t most = 0;
    for (const auto& [band, size] : sizes) most = std::max(most, size.first);
    // The sharpest; of equal ones green, which has the best contrast of those that all cameras have.
    const auto order = [](const std::string& band) {
      static constexpr std::array kOrder = {"g", "gre", "2", "re", "reg", "r", "red", "nir"};
      return std::find(kOrder.begin(), kOrder.end(), band) - kOrder.begin();
    };
    const auto rank = [&](const std::string& band) { return std::tuple(-sizes.at(band).second, order(band), band); };
    std::string best;
    for (const auto& [band, size] : sizes) {
      if (10 * size.first < 9 * most) continue;
      if (best.empty() || rank(band) < rank(best)) best = band;
    }
    for (const auto& [one, band] : bands) {
      if (band == best) {
        one->file.reason = "single band: band " + best + " is taken for all, as there are no photos in colour";
      } else {
        LeaveOut(*one, FileKind::kBand, "single band: band " + best + " is taken, as there are no photos in colour");
      }
    }
  }

  void LeaveOutThermal() {
    std::set<std::string> folders_with_colour, stems;
    ForPhotos([&](Candidate& one) {
      if (ColourName(one.parts.stem)) folders_with_colour.insert(one.parts.folder);
      stems.insert(Key(one, one.parts.stem));
    });
    ForPhotos([&](Candidate& one) {
      const std::optional<ShotName> name = ThermalName(one.parts.stem);
      if (name && (folders_with_colour.contains(one.parts.folder) || stems.contains(Key(one, name->shot)))) {
        LeaveOut(one, FileKind::kThermal, "picture of heat beside photos in colour, by its name");
      }
    });
    static const std::set<std::pair<int, int>> thermal_sizes = {{160, 120}, {320, 240}, {320, 256}, {336, 256}, {384, 288}, {640, 480}, {640, 512}};
    const auto is_small = [](const Candidate& one) { return thermal_sizes.contains({one.header.width, one.header.height}); };
    const size_t n_small = CountPhotos(is_small);
    if (n_small == 0) return;
    int64_t largest_small = 0;
    ForPhotos([&](Candidate& one) { largest_small = is_small(one) ? std::max(largest_small, AreaOf(one)) : largest_small; });
    const size_t n_large = CountPhotos([&](const Candidate& one) { return AreaOf(one) >= kTimesThermal * largest_small; });
    if (n_large < kFewestPhotos || 2 * n_large < n_small) return;
    ForPhotos([&](Candidate& one) {
      if (!is_small(one)) return;
      LeaveOut(one, FileKind::kThermal,
               "picture of heat or thumbnail: " + std::to_string(one.header.width) + "x" + std::to_string(one.header.height) +
                   " pixels beside photos with far more");
    });
  }

  void UsePatterns(const std::vector<std::string>& patterns) {
    for (Candidate& one : all_) {
      const bool picture = one.group == FileGroup::kPicture || image::NeedsDeveloping(one.parts.stem + one.parts.extension);
      const bool possible = picture && one.file.kind != FileKind::kMask && one.file.kind != FileKind::kSystem;
      if (!possible) continue;
      if (MatchesAny(patterns, one.file.name)) {
        if (!one.file.Taken()) one.file.reason = "chosen by prepare.photos (" + KindName(one.file.kind) + ")";
        one.file.kind = FileKind::kPhoto;
      } else {
        LeaveOut(one, FileKind::kNoChoice, "not chosen by prepare.photos");
      }
    }
  }

  // Raw files and videos that a taken photo was made from or with.
  void NameOtherForms() {
    std::map<std::string, std::string> taken;
    ForPhotos([&](Candidate& one) { taken.emplace(Key(one, one.parts.stem), one.file.name); });
    for (Candidate& one : all_) {
      if (one.file.kind != FileKind::kUnread) continue;
      const auto photo = taken.find(Key(one, one.parts.stem));
      if (photo == taken.end()) continue;
      one.file.kind = FileKind::kOtherForm;
      one.file.reason = "another form of " + photo->second + ", which is taken";
    }
  }

  std::vector<Candidate> all_;
};

}  // namespace

std::vector<InputFile> ChooseFiles(const std::vector<FoundFile>& found, const std::vector<PictureHeader>& headers,
                                   const std::vector<std::string>& patterns) {
  std::vector<Candidate> all;
  all.reserve(found.size());
  for (size_t i = 0; i < found.size(); ++i) {
    Candidate one;
    one.file.name = found[i].name;
    one.found = found[i];
    one.header = headers[i];
    one.parts = PartsOf(found[i].name);
    one.group = GroupOf(found[i].name);
    all.push_back(std::move(one));
  }
  // Which of equal files counts does not depend on the disk.
  std::sort(all.begin(), all.end(), [](const Candidate& a, const Candidate& b) { return a.file.name < b.file.name; });
  Chooser chooser(std::move(all));
  chooser.Choose(patterns);
  return chooser.Files();
}

}  // namespace skyquilt::prepare::input
