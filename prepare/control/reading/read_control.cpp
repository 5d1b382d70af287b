#include "prepare/control/reading/read_control.h"

#include <fmt/core.h>

#include <algorithm>
#include <limits>
#include <map>
#include <set>
#include <span>
#include <sstream>
#include <utility>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/text.h"
#include "prepare/control/reading/control_columns.h"
#include "prepare/control/reading/metashape_markers.h"
#include "prepare/control/reading/odm_gcp_list.h"
#include "prepare/control/reading/opensfm_control.h"
#include "prepare/control/reading/point_places.h"
#include "prepare/control/reading/point_table.h"
#include "prepare/tables/text_table.h"

namespace skyquilt::prepare::control {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFormats =
    "Give OpenDroneMap's gcp_list.txt, OpenSfM's ground_control_points.json, or a table label,x,y,z with a second file of marks "
    "(docs/control_points.md)";
constexpr size_t kShown = 5;

std::string Some(const std::set<std::string>& names) {
  const std::vector<std::string> all(names.begin(), names.end());
  return base::Join(std::span(all).first(std::min(all.size(), kShown))) + (all.size() > kShown ? ", ..." : "");
}

char FirstCharacter(const std::string& text) {
  const size_t begin = text.starts_with("\xEF\xBB\xBF") ? 3 : 0;
  const size_t first = text.find_first_not_of(" \t\r\n", begin);
  return first == std::string::npos ? '\0' : text[first];
}

[[noreturn]] void FailLine(const fs::path& file, const LineProblem& problem) {
  tables::FailTableLine(file, problem.line, problem.found, problem.fix);
}

RawControl ReadPoints(const ControlFiles& files, const ControlPhotos& photos) {
  const std::string text = base::ReadFile(files.points);
  switch (FirstCharacter(text)) {
    case '\0':
      throw base::InputError(files.points, "is empty", kFormats);
    case '{':
      return ReadOpensfmControl(files.points);
    case '<':
      return ReadMetashapeMarkers(files.points, text);
    default:
      break;
  }
  const tables::TextTable table = tables::ParseTextTable(files.points, text);
  if (!files.columns.empty() || !LooksLikeGcpList(table, photos.names())) return ReadPointTable(table, files.columns);
  GcpList list = ReadGcpList(table, photos.names());
  if (!list.problems.empty()) FailLine(files.points, list.problems.front());
  return std::move(list.control);
}

RawControl ReadMarks(const fs::path& file) {
  const std::string text = base::ReadFile(file);
  return FirstCharacter(text) == '<' ? ReadMetashapeMarkers(file, text) : ReadMarkTable(tables::ParseTextTable(file, text));
}

// With the line each is on; 0 in the option itself.
std::map<std::string, int> CheckLabels(const std::string& check_points, bool& is_file) {
  std::map<std::string, int> labels;
  std::error_code error;
  is_file = check_points.size() < 4096 && fs::is_regular_file(check_points, error);
  if (!is_file) {
    for (const std::string& label : SplitNames(check_points)) {
      if (!label.empty()) labels.emplace(label, 0);
    }
    return labels;
  }
  std::istringstream lines(base::ReadFile(check_points));
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    if (++number == 1 && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);
    const std::vector<std::string> names = SplitNames(line);
    if (!names.empty() && !names.front().empty() && names.front().front() != '#') labels.emplace(names.front(), number);
  }
  return labels;
}

void SetCheckPoints(const std::string& check_points, std::vector<ControlPoint>& points) {
  bool is_file = false;
  std::map<std::string, int> labels = CheckLabels(check_points, is_file);
  for (ControlPoint& point : points) {
    if (labels.erase(point.label) > 0) point.check = true;
  }
  if (labels.empty()) return;
  const auto& [label, line] = *labels.begin();
  std::set<std::string> known;
  for (const ControlPoint& point : points) known.insert(point.label);
  const std::string found = "names '" + label.substr(0, 60) + "', but no point is called so; there are " + Some(known);
  if (is_file) tables::FailTableLine(check_points, line, found, "Correct the label, or leave the line out");
  throw base::UsageError("check_points " + found);
}

// Marks in photos that are there, of points that are there.
struct UsableMarks {
  std::vector<RawMark> marks;
  std::vector<const PhotoSize*> photos;
  std::vector<size_t> points;
};

UsableMarks KeepUsable(const RawControl& from, const std::map<std::string, size_t>& by_label, const ControlPhotos& photos,
                       std::vector<std::string>& warnings) {
  UsableMarks usable;
  std::set<std::string> missing, unknown;
  size_t n_missing = 0, n_unknown = 0;
  int first_missing = 0, first_unknown = 0;
  for (const RawMark& mark : from.marks) {
    const auto point = by_label.find(mark.label);
    if (point == by_label.end()) {
      unknown.insert(mark.label);
      if (n_unknown++ == 0) first_unknown = mark.line;
      continue;
    }
    const PhotoSize* const photo = photos.Find(mark.photo);
    if (photo == nullptr) {
      missing.insert(mark.photo);
      if (n_missing++ == 0) first_missing = mark.line;
      continue;
    }
    usable.marks.push_back(mark);
    usable.photos.push_back(photo);
    usable.points.push_back(point->second);
  }
  if (n_missing > 0) {
    warnings.push_back(fmt::format("{}: line {}: {} of {} marks are in photos that are not there, or whose name several share, and are left out: {}",
                                   from.file.string(), first_missing, n_missing, from.marks.size(), Some(missing)));
  }
  if (n_unknown > 0) {
    warnings.push_back(fmt::format("{}: line {}: {} of {} marks are of points without coordinates and are left out: {}", from.file.string(),
                                   first_unknown, n_unknown, from.marks.size(), Some(unknown)));
  }
  return usable;
}

void AddMarks(const RawControl& from, const ControlPhotos& photos, ControlPoints& control) {
  std::map<std::string, size_t> by_label;
  for (size_t i = 0; i < control.points.size(); ++i) by_label[control.points[i].label] = i;
  const UsableMarks usable = KeepUsable(from, by_label, photos, control.warnings);
  const std::vector<StoredMark> stored = StoredPixels(from.file, usable.marks, usable.photos, control.warnings);
  std::map<std::pair<size_t, std::string>, size_t> seen;
  for (size_t i = 0; i < usable.marks.size(); ++i) {
    const RawMark& mark = usable.marks[i];
    const auto [first, is_new] = seen.emplace(std::pair(usable.points[i], usable.photos[i]->name), i);
    if (is_new) {
      control.points[usable.points[i]].marks.push_back({usable.photos[i]->name, stored[i].pixel, mark.line, stored[i].if_upright});
    } else if (stored[first->second].pixel != stored[i].pixel) {
      tables::FailTableLine(
          from.file, mark.line,
          fmt::format("marks {} in {} a second time, elsewhere than line {}", mark.label, usable.photos[i]->name, usable.marks[first->second].line),
          "Keep one mark of a point per photo");
    }
  }
}

void WarnOfFewMarks(ControlPoints& control) {
  std::set<std::string> useless, few;
  for (const ControlPoint& point : control.points) {
    if (point.marks.size() < 2) useless.insert(point.label);
    if (point.marks.size() == 2) few.insert(point.label);
  }
  if (!useless.empty()) {
    control.warnings.push_back(fmt::format("{}: {} of {} points are marked in fewer than two photos and cannot be used: {}", control.file,
                                           useless.size(), control.points.size(), Some(useless)));
  }
  if (!few.empty()) {
    control.warnings.push_back(fmt::format("{}: {} of {} points are marked in two photos only, so a wrong mark there cannot be found: {}",
                                           control.file, few.size(), control.points.size(), Some(few)));
  }
}

}  // namespace

ControlPoints ReadControl(const ControlFiles& files, const std::vector<PhotoSize>& photos) {
  const ControlPhotos known(photos);
  RawControl raw = ReadPoints(files, known);
  if (raw.points.empty()) throw base::InputError(files.points, "has no points with coordinates", kFormats);
  if (!files.marks.empty()) {
    raw.marks.clear();
  } else if (raw.marks.empty()) {
    throw base::InputError(files.points, "is " + raw.format + " and has no marks, so it is not known where its points are in the photos",
                           "Give the marks with prepare.gcp_marks: a table image,label,x,y or Metashape's XML of markers");
  }
  ControlPoints control;
  control.file = files.points.string();
  const PointPlaces places = PlacePoints(raw, files.crs, files.heights);
  if (!places.problems.empty()) FailLine(files.points, places.problems.begin()->second);
  for (const std::string& warning : places.warnings) control.warnings.push_back(control.file + ": " + warning);
  control.crs = places.crs;
  control.heights = places.heights;
  control.crs_definition = places.definition;
  for (size_t i = 0; i < raw.points.size(); ++i) {
    const RawPoint& from = raw.points[i];
    ControlPoint point;
    point.label = from.label;
    point.given = from.given;
    point.place = places.places[i];
    if (from.horizontal_sigma_m) point.horizontal_sigma_m = *from.horizontal_sigma_m;
    if (from.vertical_sigma_m) point.vertical_sigma_m = *from.vertical_sigma_m;
    point.check = from.check;
    point.line = from.line;
    control.points.push_back(std::move(point));
  }
  SetCheckPoints(files.check_points, control.points);
  AddMarks(files.marks.empty() ? raw : ReadMarks(files.marks), known, control);
  WarnOfFewMarks(control);
  return control;
}

ControlPoints ReadMarkedPlaces(const fs::path& marks, const std::vector<PhotoSize>& photos) {
  const RawControl raw = ReadMarks(marks);
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  ControlPoints control;
  control.file = marks.string();
  std::set<std::string> labels;
  for (const RawMark& mark : raw.marks) {
    if (!labels.insert(mark.label).second) continue;
    ControlPoint point;
    point.label = mark.label;
    point.given = Eigen::Vector3d::Constant(kNan);
    point.place = {kNan, kNan, kNan};
    point.line = mark.line;
    control.points.push_back(std::move(point));
  }
  AddMarks(raw, ControlPhotos(photos), control);
  WarnOfFewMarks(control);
  return control;
}

}  // namespace skyquilt::prepare::control
