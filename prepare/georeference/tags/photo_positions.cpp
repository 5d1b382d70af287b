#include "prepare/georeference/tags/photo_positions.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <sstream>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/pattern.h"
#include "core/base/text.h"
#include "core/geo/ecef.h"
#include "prepare/georeference/tags/geo_table.h"
#include "prepare/tables/text_table.h"

namespace skyquilt::prepare::georeference {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMrkFix = "Copy the file from the drone again, or remove it to use the photos' tags";
// More accurate than this, a position was measured at the moment of exposure.
constexpr double kMeasured_m = 0.1;
// Tags of the same photo differ less.
constexpr double kFarOff_m = 100.0;

std::vector<std::string> WordsOf(const std::string& line) {
  std::istringstream in(line);
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

struct Numbered {
  MrkRow row;
  fs::path file;
};

// The number of a photo in its folder by its name.
std::optional<int> NumberOf(const std::string& name) {
  const std::string stem = fs::path(name).stem().string();
  if (stem.size() > 200) return std::nullopt;
  const auto match = base::MatchWhole(stem, "(?:^|.*_)(\\d{4})(?:_[A-Za-z]+)*");
  return match ? std::optional(std::stoi((*match)[1])) : std::nullopt;
}

// Empty: there is none.
fs::path GeoFileOf(const fs::path& photo_root, const std::string& geo_file) {
  if (!geo_file.empty()) return geo_file;
  if (fs::exists(photo_root / "geo.txt")) return photo_root / "geo.txt";
  const fs::path beside = photo_root.parent_path() / "geo.txt";
  return photo_root.filename() == "images" && fs::exists(beside) ? beside : fs::path();
}

// Of folders in the photo folder, as of zones, in name order.
std::vector<fs::path> GeoFilesInside(const fs::path& photo_root) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator entry(photo_root, error), end; !error && entry != end; entry.increment(error)) {
    std::error_code ignored;
    if (entry->is_directory(ignored) && fs::is_regular_file(entry->path() / "geo.txt", ignored)) files.push_back(entry->path() / "geo.txt");
  }
  std::sort(files.begin(), files.end());
  return files;
}

void UseGeoFile(const fs::path& file, std::vector<input::PhotoFile>& photos) {
  const GeoTable table = ReadGeoTable(file, photos);
  for (const std::string& warning : table.warnings) base::LogWarning("{}", warning);
  size_t n_used = 0;
  for (const GeoRow& row : table.rows) {
    if (!row.index) continue;
    survey::PhotoTags& tags = photos[*row.index].tags;
    tags.gps = row.position;
    tags.position_file = file.string();
    tags.horizontal_accuracy_m = row.horizontal_accuracy_m;
    tags.vertical_accuracy_m = row.vertical_accuracy_m;
    tags.rtk = row.horizontal_accuracy_m && *row.horizontal_accuracy_m <= kMeasured_m;
    tags.dop.reset();
    ++n_used;
  }
  if (n_used == 0) {
    throw base::InputError(file,
                           "names none of the photos; its first is '" + table.rows.front().photo.substr(0, 60) + "', that of the photos '" +
                               (photos.empty() ? "" : photos.front().name) + "'",
                           "Write the photos' file names in its first column");
  }
  base::LogInfo("positions of {} of {} photos come from {} instead of their tags", n_used, photos.size(), file.string());
}

// By number; without numbers that several files have.
std::map<int, Numbered> RowsOfFolder(const fs::path& folder) {
  std::map<int, Numbered> rows;
  std::set<int> ambiguous;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    if (base::LowerCase(entry->path().extension().string()) != ".mrk") continue;
    try {
      for (const MrkRow& row : ReadMrkFile(entry->path())) {
        if (row.status > 0 && !rows.emplace(row.number, Numbered{row, entry->path()}).second) ambiguous.insert(row.number);
      }
    } catch (const base::InputError& problem) {
      base::LogWarning("not used: {}", problem.what());
    }
  }
  if (!ambiguous.empty())
    base::LogWarning(
        "{}: the .MRK files number {} photos twice, which keep their tags; keep the photos of a flight in a folder of their own with its .MRK",
        folder.string(), ambiguous.size());
  for (const int number : ambiguous) rows.erase(number);
  return rows;
}

bool IsFarFromTag(const MrkRow& row, const survey::PhotoTags& tags) {
  if (!tags.gps) return false;
  const geo::Geodetic tag{tags.gps->latitude_deg, tags.gps->longitude_deg, row.position.height_m};
  return (geo::EcefFromGeodetic(tag) - geo::EcefFromGeodetic(row.position)).norm() > kFarOff_m;
}

void UseMrkFiles(const fs::path& photo_root, std::vector<input::PhotoFile>& photos) {
  std::map<fs::path, std::vector<input::PhotoFile*>> by_folder;
  for (input::PhotoFile& photo : photos) by_folder[(photo_root / photo.name).parent_path()].push_back(&photo);
  for (const auto& [folder, in_folder] : by_folder) {
    const std::map<int, Numbered> rows = RowsOfFolder(folder);
    std::vector<std::pair<input::PhotoFile*, const Numbered*>> pairs;
    size_t n_far = 0;
    for (input::PhotoFile* photo : in_folder) {
      const std::optional<int> number = NumberOf(photo->name);
      const auto row = number ? rows.find(*number) : rows.end();
      if (row == rows.end()) continue;
      pairs.emplace_back(photo, &row->second);
      n_far += IsFarFromTag(row->second.row, photo->tags) ? 1 : 0;
    }
    if (pairs.empty()) continue;
    if (2 * n_far > pairs.size()) {
      base::LogWarning("{}: the .MRK is not used, because it is more than {} m from the tags of {} of {} photos", folder.string(), kFarOff_m, n_far,
                       pairs.size());
      continue;
    }
    for (const auto& [photo, numbered] : pairs) {
      const MrkRow& row = numbered->row;
      constexpr int kRtkFixed = 50;
      photo->tags.gps = row.position;
      photo->tags.position_file = numbered->file.string();
      photo->tags.rtk = row.status == kRtkFixed;
      if (row.horizontal_accuracy_m > 0.0) photo->tags.horizontal_accuracy_m = row.horizontal_accuracy_m;
      if (row.vertical_accuracy_m > 0.0) photo->tags.vertical_accuracy_m = row.vertical_accuracy_m;
    }
    base::LogInfo("positions of {} of {} photos come from {} instead of their tags", pairs.size(), in_folder.size(),
                  pairs.front().second->file.string());
  }
}

}  // namespace

std::vector<MrkRow> ReadMrkFile(const fs::path& file) {
  std::istringstream lines(base::ReadFile(file));
  std::vector<MrkRow> rows;
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    std::replace(line.begin(), line.end(), ',', ' ');
    const std::vector<std::string> words = WordsOf(line);
    if (words.empty()) continue;
    const auto before = [&](const char* label) {
      const auto found = std::find(words.begin() + 1, words.end(), label);
      const std::optional<double> value = found == words.end() ? std::nullopt : tables::ParseTableNumber(*(found - 1), false);
      if (!value) tables::FailTableLine(file, number, std::string("has no number before ") + label, kMrkFix);
      return *value;
    };
    MrkRow row;
    const std::optional<double> index = tables::ParseTableNumber(words.front(), false);
    if (!index || *index < 0.0 || *index > 1e6 || *index != std::floor(*index))
      tables::FailTableLine(file, number, "does not begin with the photo's number", kMrkFix);
    row.number = static_cast<int>(*index);
    row.position = {before("Lat"), before("Lon"), before("Ellh")};
    if (!geo::IsValid(row.position)) tables::FailTableLine(file, number, "has a position that is not on Earth", kMrkFix);
    row.position.longitude_deg = geo::WrapLongitudeDeg(row.position.longitude_deg);
    const double status = before("Q");
    row.status = status > 0.0 && status < 1000.0 ? static_cast<int>(status) : 0;
    // North, east and up follow the height.
    const auto height = std::find(words.begin(), words.end(), "Ellh");
    std::vector<double> sigmas;
    for (auto word = height + 1; word != words.end() && sigmas.size() < 3; ++word) {
      const std::optional<double> sigma = tables::ParseTableNumber(*word, false);
      if (!sigma) break;
      sigmas.push_back(*sigma);
    }
    if (sigmas.size() == 3) {
      row.horizontal_accuracy_m = std::max(sigmas[0], sigmas[1]);
      row.vertical_accuracy_m = sigmas[2];
    }
    rows.push_back(row);
  }
  return rows;
}

std::vector<fs::path> PositionFiles(const fs::path& photo_root, const std::string& geo_file) {
  const fs::path table = GeoFileOf(photo_root, geo_file);
  if (!table.empty()) return {table};
  std::vector<fs::path> logs = GeoFilesInside(photo_root);
  std::error_code error;
  for (fs::recursive_directory_iterator
           entry(photo_root, fs::directory_options::skip_permission_denied | fs::directory_options::follow_directory_symlink, error),
       end;
       !error && entry != end; entry.increment(error)) {
    if (base::LowerCase(entry->path().extension().string()) == ".mrk") logs.push_back(entry->path());
  }
  std::sort(logs.begin(), logs.end());
  return logs;
}

void UsePositionFiles(const fs::path& photo_root, const std::string& geo_file, std::vector<input::PhotoFile>& photos) {
  const fs::path table = GeoFileOf(photo_root, geo_file);
  if (!table.empty()) return UseGeoFile(table, photos);
  UseMrkFiles(photo_root, photos);
  for (const fs::path& file : GeoFilesInside(photo_root)) {
    const std::string prefix = file.parent_path().filename().string() + "/";
    std::vector<input::PhotoFile> inside;
    std::vector<size_t> index;
    for (size_t i = 0; i < photos.size(); ++i) {
      if (!photos[i].name.starts_with(prefix)) continue;
      inside.push_back(photos[i]);
      index.push_back(i);
    }
    if (inside.empty()) continue;
    UseGeoFile(file, inside);
    for (size_t k = 0; k < index.size(); ++k) photos[index[k]] = std::move(inside[k]);
  }
}

}  // namespace skyquilt::prepare::georeference
