#include "prepare/input/plain_photos.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <span>
#include <sstream>
#include <utility>
#include <vector>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/progress.h"
#include "core/base/text.h"
#include "core/gis/photo_bands.h"
#include "core/image/develop.h"
#include "core/image/fill_alpha.h"
#include "core/image/image.h"
#include "core/image/pixel_format.h"
#include "prepare/input/band_choice.h"
#include "prepare/input/picture_header.h"
#include "prepare/input/white_level.h"

namespace skyquilt::prepare::input {
namespace {

namespace fs = std::filesystem;

// What the folder was made from; and names of photos that could not be converted, each with a tab and the problem.
constexpr const char *kStampName = "made_from.txt", *kLeftOutName = "left_out.txt";
constexpr const char* kBandsFix =
    "Set prepare.bands to three bands for red, green and blue, or to one for grey pictures, by number or name, for instance --set "
    "prepare.bands=\"3,2,1\", or remove the file from the folder";
// Of a photo's values may be above its range: hot pixels.
constexpr double kAboveRange = 1e-5;
constexpr size_t kMostSampled = size_t{1} << 20U;
constexpr int kRowsAtOnce = 128;
constexpr int kPngLevel = 1;
// prepare.alpha
constexpr const char *kAsMask = "mask", *kOverWhite = "white";

// A photo to convert.
struct PhotoSource {
  size_t photo = 0;  // index into the usable photos
  image::PixelFormat format;
  std::vector<int> bands;                  // as read: for CMYK all four
  std::string problem;                     // not empty: it is left out
  bool develop = false;                    // HEIC or raw: no bands are chosen
  std::optional<uint8_t> background = {};  // shown over this; no bands are chosen
  PhotoRange range;
};

// Calls `use` with a block of rows after the other.
template <typename Use>
void ForRows(const gis::PhotoBands& file, std::span<const int> bands, const Use& use) {
  std::vector<float> values;
  for (int row = 0; row < file.height(); row += kRowsAtOnce) {
    base::ThrowIfCancelled();
    const int n_rows = std::min(kRowsAtOnce, file.height() - row);
    values.resize(static_cast<size_t>(n_rows) * static_cast<size_t>(file.width()) * bands.size());
    file.ReadRows(row, n_rows, bands, values);
    use(row, std::span<const float>(values));
  }
}

// The value that a share of kAboveRange is above, of evenly chosen pixels.
double LargestValue(const gis::PhotoBands& file, std::span<const int> bands) {
  const size_t n = static_cast<size_t>(file.width()) * static_cast<size_t>(file.height()) * bands.size();
  const size_t step = std::max<size_t>(1, n / kMostSampled);
  std::vector<float> sample;
  size_t next = 0, at = 0;
  ForRows(file, bands, [&](int /*row*/, std::span<const float> values) {
    for (; next < at + values.size(); next += step) {
      const float value = values[next - at];
      if (std::isfinite(value)) sample.push_back(value);
    }
    at += values.size();
  });
  if (sample.empty()) return 0.0;
  const auto above = static_cast<size_t>(kAboveRange * static_cast<double>(sample.size()));
  const auto place = sample.end() - 1 - static_cast<std::ptrdiff_t>(above);
  std::nth_element(sample.begin(), place, sample.end());
  return std::max(0.0, static_cast<double>(*place));
}

uint8_t To8Bits(double value, double scale) {
  // Also for NaN.
  if (!(value > 0.0)) return 0;
  return static_cast<uint8_t>(std::nearbyint(std::min(value * scale, 255.0)));
}

image::Image8 Converted(const gis::PhotoBands& file, const PhotoSource& source, double white) {
  const double scale = 255.0 / white;
  const size_t n_bands = source.bands.size();
  const bool cmyk = source.format.is_cmyk && n_bands == 4;
  image::Image8 image(file.width(), file.height(), n_bands == 1 ? 1 : 3);
  ForRows(file, source.bands, [&](int row, std::span<const float> values) {
    uint8_t* out = image.At(0, row);
    if (!cmyk) {
      for (size_t i = 0; i < values.size(); ++i) out[i] = To8Bits(static_cast<double>(values[i]), scale);
      return;
    }
    for (size_t i = 0; i < values.size(); i += 4) {
      const double paper = white - static_cast<double>(values[i + 3]);
      for (size_t c = 0; c < 3; ++c) *out++ = To8Bits((white - static_cast<double>(values[i + c])) * paper / white, scale);
    }
  });
  return image;
}

std::string StampOf(const fs::path& photo_root, const std::string& bands, const std::string& alpha, const std::vector<PhotoSource>& sources,
                    const PhotoSet& photos) {
  std::string text = "photos converted to 8 bits, form 1\nbands " + bands + "\n" + photo_root.string() + "\n";
  if (alpha != kAsMask) text += "alpha " + alpha + "\n";
  size_t next = 0;
  for (size_t i = 0; i < photos.usable.size(); ++i) {
    const bool converted = next < sources.size() && sources[next].photo == i;
    if (converted) ++next;
    const fs::path file = photo_root / photos.usable[i].name;
    std::error_code error;
    const auto time = fs::last_write_time(file, error).time_since_epoch().count();
    text += fmt::format("{} {} {} {}\n", converted ? "convert" : "link", fs::file_size(file, error), time, photos.usable[i].name);
  }
  return text;
}

std::vector<image::PixelFormat> ReadFormats(const fs::path& photo_root, const PhotoSet& photos, base::ThreadPool& threads) {
  std::vector<image::PixelFormat> formats(photos.usable.size());
  threads.ParallelFor(static_cast<int64_t>(formats.size()), [&](int64_t task, int /*thread*/) {
    const auto i = static_cast<size_t>(task);
    // The header of a raw file tells of its thumbnail.
    if (!image::NeedsDeveloping(photos.usable[i].name)) formats[i] = image::ReadPixelFormat(photo_root / photos.usable[i].name);
  });
  return formats;
}

bool HasAlpha(const fs::path& photo, const image::PixelFormat& format) {
  return (format.kind == image::FileKind::kPng || format.kind == image::FileKind::kTiff) && ReadPictureHeader(photo).has_alpha;
}

// Photos that are not plain, and those that the options are about.
std::vector<PhotoSource> FindSources(const fs::path& photo_root, const PhotoSet& photos, const std::vector<image::PixelFormat>& formats,
                                     const std::string& bands, const std::string& alpha) {
  std::vector<PhotoSource> sources;
  for (size_t i = 0; i < formats.size(); ++i) {
    if (image::NeedsDeveloping(photos.usable[i].name)) {
      sources.push_back({.photo = i, .format = {}, .bands = {}, .problem = {}, .develop = true, .background = {}, .range = {}});
      continue;
    }
    if (alpha != kAsMask && HasAlpha(photo_root / photos.usable[i].name, formats[i])) {
      sources.push_back({.photo = i,
                         .format = formats[i],
                         .bands = {},
                         .problem = {},
                         .develop = false,
                         .background = static_cast<uint8_t>(alpha == kOverWhite ? 255 : 0),
                         .range = {}});
      continue;
    }
    const bool chosen = !bands.empty() && formats[i].kind == image::FileKind::kTiff && formats[i].bands > 1;
    if (image::IsPlain(formats[i]) && !chosen) continue;
    sources.push_back({.photo = i, .format = formats[i], .bands = {}, .problem = {}, .develop = false, .background = {}, .range = {}});
  }
  return sources;
}

void LogGrey(const std::vector<image::PixelFormat>& formats) {
  const auto is_grey = [](const image::PixelFormat& format) {
    return format.bands > 0 && format.bands - format.alpha_bands == 1 && !format.has_palette;
  };
  const auto n_grey = std::count_if(formats.begin(), formats.end(), is_grey);
  if (n_grey > 0)
    base::LogInfo("{} of {} photos have one band: they are grey pictures, and what they show alone becomes grey", n_grey, formats.size());
}

void ChooseBandsOf(const fs::path& file, const std::vector<std::string>& tagged_names, const std::string& wanted, PhotoSource& source) {
  const gis::PhotoBands bands(file);
  source.format.bands = bands.bands();
  if (source.format.is_cmyk && bands.IsRgb()) {
    source.format.is_cmyk = false;
    source.format.is_rgb = true;
    source.format.alpha_bands = bands.bands() - 3;
  }
  if (source.format.is_cmyk && wanted.empty()) {
    source.bands = {1, 2, 3, 4};
  } else {
    const bool named = tagged_names.size() == static_cast<size_t>(bands.bands());
    BandChoice choice = ChooseBands(source.format, named ? tagged_names : bands.Names(), wanted);
    if (!choice.problem.empty()) throw base::InputError(file, choice.problem, kBandsFix);
    source.bands = std::move(choice.bands);
  }
  source.range = {
      .largest = LargestValue(bands, source.bands), .floating = source.format.floating, .bits = source.format.bits, .white = source.format.white};
}

// Runs `work` for each source that has no problem; what it throws becomes the source's problem.
template <typename Work>
void ForSources(std::vector<PhotoSource>& sources, const std::string& label, base::ThreadPool& threads, const Work& work) {
  base::Progress progress(label, static_cast<double>(sources.size()), "photos");
  threads.ParallelFor(static_cast<int64_t>(sources.size()), [&](int64_t task, int /*thread*/) {
    base::ThrowIfCancelled();
    PhotoSource& source = sources[static_cast<size_t>(task)];
    try {
      if (source.problem.empty()) work(source);
    } catch (const base::InputError& error) {
      source.problem = error.what();
    }
    progress.Advance();
  });
  progress.Finish();
}

void LeaveOutProblems(const fs::path& photo_root, std::vector<PhotoSource>& sources, PhotoSet& photos) {
  const auto first = std::find_if(sources.begin(), sources.end(), [](const PhotoSource& source) { return !source.problem.empty(); });
  if (first == sources.end()) return;
  const std::string problem = first->problem;
  std::vector<char> left_out(photos.usable.size(), 0);
  for (const PhotoSource& source : sources) {
    if (source.problem.empty()) continue;
    left_out[source.photo] = 1;
    base::LogWarning("photo left out: {}", source.problem);
    photos.unreadable.push_back(photos.usable[source.photo].name);
  }
  const size_t n_before = photos.usable.size();
  std::vector<size_t> new_place(n_before, 0);
  std::vector<PhotoFile> kept;
  for (size_t i = 0; i < n_before; ++i) {
    new_place[i] = kept.size();
    if (left_out[i] == 0) kept.push_back(std::move(photos.usable[i]));
  }
  photos.usable = std::move(kept);
  std::erase_if(sources, [](const PhotoSource& source) { return !source.problem.empty(); });
  for (PhotoSource& source : sources) source.photo = new_place[source.photo];
  if (photos.usable.size() < kMinPhotos) {
    throw base::InputError(photo_root,
                           fmt::format("only {} of {} photos can be used, at least {} are needed (first problem: {})", photos.usable.size(), n_before,
                                       kMinPhotos, problem),
                           "Correct this or give another folder");
  }
}

void LinkPhoto(const fs::path& original, const fs::path& link) {
  std::error_code error;
  fs::create_symlink(original, link, error);
  // File systems of cameras and of Windows have no links.
  if (error) fs::copy_file(original, link, fs::copy_options::overwrite_existing, error);
  if (error) throw base::InputError(link, "cannot be written: " + error.message(), "Check free space and permissions of the output folder");
}

// Names and problems of an earlier call.
std::map<std::string, std::string> ReadLeftOut(const fs::path& folder) {
  std::map<std::string, std::string> problems;
  if (!fs::exists(folder / kLeftOutName)) return problems;
  std::istringstream lines(base::ReadFile(folder / kLeftOutName));
  for (std::string line; std::getline(lines, line);) {
    const size_t tab = line.find('\t');
    if (tab != std::string::npos) problems.emplace(line.substr(0, tab), line.substr(tab + 1));
  }
  return problems;
}

// Appends those that have a problem.
void NoteLeftOut(const std::vector<PhotoSource>& sources, const PhotoSet& photos, std::string& text) {
  for (const PhotoSource& source : sources) {
    if (source.problem.empty()) continue;
    std::string problem = source.problem;
    std::replace(problem.begin(), problem.end(), '\n', ' ');
    text += photos.usable[source.photo].name + "\t" + problem + "\n";
  }
}

// Whether all that an earlier call had to make is there. Puts its problems into the sources.
bool IsMade(const fs::path& copies, const std::string& asked, const PhotoSet& photos, std::vector<PhotoSource>& sources) {
  if (!fs::exists(copies / kStampName) || base::ReadFile(copies / kStampName) != asked) return false;
  const std::map<std::string, std::string> problems = ReadLeftOut(copies);
  for (const PhotoFile& photo : photos.usable) {
    if (!problems.contains(photo.name) && !fs::exists(copies / photo.name)) return false;
  }
  for (PhotoSource& source : sources) {
    const auto found = problems.find(photos.usable[source.photo].name);
    if (found != problems.end()) source.problem = found->second;
  }
  return true;
}

// For the log: how many photos have which bands, of how many bits.
std::string DescribeSources(const std::vector<PhotoSource>& sources) {
  int most_bits = 8;
  size_t n_floating = 0, n_several = 0, n_developed = 0, n_filled = 0;
  bool white = false;
  for (const PhotoSource& source : sources) {
    n_developed += source.develop ? 1 : 0;
    most_bits = std::max(most_bits, source.format.bits);
    n_filled += source.background ? 1 : 0;
    white = white || source.background == 255;
    n_floating += source.format.floating ? 1 : 0;
    if (source.background) continue;
    n_several += source.format.bands > 3 ? 1 : 0;
  }
  std::string text = fmt::format("{} photos of up to {} bits", sources.size(), most_bits);
  if (n_developed > 0) text += fmt::format(", {} of HEIC or raw files, which are developed", n_developed);
  if (n_floating > 0) text += fmt::format(", {} of floating point", n_floating);
  if (n_filled > 0) text += fmt::format(", {} with transparency, shown over {}", n_filled, white ? kOverWhite : "black");
  if (n_several > 0) {
    std::vector<std::string> bands;
    for (const int band : sources.front().bands) bands.push_back(std::to_string(band));
    text += fmt::format(", {} of several bands (used: {} of {})", n_several, base::Join(bands), sources.front().format.bands);
  }
  return text;
}

}  // namespace

fs::path MakePlainPhotos(const fs::path& photo_root, const std::string& bands, const std::string& alpha, const fs::path& folder, PhotoSet& photos,
                         base::ThreadPool& threads) {
  const std::vector<image::PixelFormat> formats = ReadFormats(photo_root, photos, threads);
  LogGrey(formats);
  std::vector<PhotoSource> sources = FindSources(photo_root, photos, formats, bands, alpha);
  if (sources.empty()) {
    if (!bands.empty()) base::LogWarning("prepare.bands = \"{}\" has no effect: no photo is a TIFF of several bands", bands);
    fs::remove_all(folder);
    return photo_root;
  }
  const fs::path copies = fs::absolute(folder);
  const auto mark = [&] {
    for (const PhotoSource& source : sources) {
      photos.usable[source.photo].converted = true;
      photos.usable[source.photo].filled = source.background.has_value();
    }
  };
  const std::string asked = StampOf(photo_root, bands, alpha, sources, photos);
  if (IsMade(copies, asked, photos, sources)) {
    LeaveOutProblems(photo_root, sources, photos);
    base::LogInfo("{} of {} photos are already converted to 8 bits, in {}", sources.size(), photos.usable.size(), copies.string());
    mark();
    return copies;
  }
  fs::remove_all(copies);
  base::RequireWritableFolder(copies);
  std::string left_out;
  ForSources(sources, "read range of photos", threads, [&](PhotoSource& source) {
    const PhotoFile& photo = photos.usable[source.photo];
    if (source.develop || source.background) return;
    ChooseBandsOf(photo_root / photo.name, photo.tags.band_names, bands, source);
  });
  NoteLeftOut(sources, photos, left_out);
  LeaveOutProblems(photo_root, sources, photos);

  // Whole numbers of 8 bits are not scaled.
  const auto is_deep = [](const PhotoSource& source) { return !source.background && (source.format.floating || source.format.bits > 8); };
  std::vector<PhotoRange> deep;
  for (const PhotoSource& source : sources) {
    if (is_deep(source)) deep.push_back(source.range);
  }
  const WhiteLevel white = deep.empty() ? WhiteLevel{255.0, ""} : FindWhite(deep);
  if (!sources.empty()) {
    base::LogInfo("{} are converted to 8 bits in {}{}", DescribeSources(sources), copies.string(),
                  deep.empty() ? "" : fmt::format("; white is {:g} ({})", white.value, white.reason));
  }
  for (const PhotoFile& photo : photos.usable) fs::create_directories((copies / photo.name).parent_path());
  ForSources(sources, "convert photos", threads, [&](const PhotoSource& source) {
    const std::string& name = photos.usable[source.photo].name;
    if (source.develop) {
      const PhotoFile& photo = photos.usable[source.photo];
      const image::Image8 developed = image::DevelopPhoto(photo_root / name);
      if (developed.width != photo.width || developed.height != photo.height) {
        throw base::InputError(photo_root / name, "is developed to another size than it says", "Export it as JPEG or TIFF");
      }
      base::WriteFileAtomically(copies / name, image::EncodePng(developed, kPngLevel));
      return;
    }
    if (source.background) {
      base::WriteFileAtomically(copies / name, image::EncodePng(image::LoadRgb8Over(photo_root / name, *source.background), kPngLevel));
      return;
    }
    const image::Image8 image = Converted(gis::PhotoBands(photo_root / name), source, is_deep(source) ? white.value : 255.0);
    base::WriteFileAtomically(copies / name, image::EncodePng(image, kPngLevel));
  });
  NoteLeftOut(sources, photos, left_out);
  LeaveOutProblems(photo_root, sources, photos);
  mark();
  for (const PhotoFile& photo : photos.usable) {
    if (!photo.converted) LinkPhoto(fs::absolute(photo_root / photo.name), copies / photo.name);
  }
  base::WriteFileAtomically(copies / kLeftOutName, left_out);
  base::WriteFileAtomically(copies / kStampName, asked);
  return copies;
}

}  // namespace skyquilt::prepare::input
