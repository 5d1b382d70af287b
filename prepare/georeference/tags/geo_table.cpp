#include "prepare/georeference/tags/geo_table.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <span>
#include <stdexcept>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/order_statistics.h"
#include "core/base/text.h"
#include "core/geo/crs.h"
#include "core/geo/ecef.h"
#include "prepare/control/reading/control_columns.h"
#include "prepare/input/list_files.h"
#include "prepare/models/photo_names.h"
#include "prepare/tables/text_table.h"

namespace skyquilt::prepare::georeference {
namespace {

namespace fs = std::filesystem;

constexpr const char* kGeoFix =
    "Write per line: photo, x (east or longitude), y (north or latitude), height; the first line is the coordinate system";
constexpr const char* kCrsFix = "Begin the file with EPSG:4326 for longitude and latitude, or with the coordinate system of x and y";
constexpr double kNotGiven = std::numeric_limits<double>::quiet_NaN();

std::vector<std::string> NamesOf(const std::vector<input::PhotoFile>& photos) {
  std::vector<std::string> names;
  names.reserve(photos.size());
  for (const input::PhotoFile& photo : photos) names.push_back(photo.name);
  return names;
}

// With an empty line in its place. Lines count from 1.
std::string WithoutLine(const std::string& text, int line) {
  size_t begin = 0;
  for (int i = 1; i < line; ++i) begin = text.find('\n', begin) + 1;
  const size_t end = text.find('\n', begin);
  return text.substr(0, begin) + (end == std::string::npos ? "" : text.substr(end));
}

// A row before its coordinate system is applied.
struct RawRow {
  GeoRow row;
  Eigen::Vector3d given = Eigen::Vector3d::Zero();  // z is NaN when it has none
};

class GeoReader {
 public:
  GeoReader(const fs::path& file, const std::vector<input::PhotoFile>& photos) : file_(file), photos_(photos), names_(NamesOf(photos)) {}

  GeoTable Read() {
    const std::string text = base::ReadFile(file_);
    table_ = tables::ParseTextTable(file_, text);
    const std::optional<geo::Crs> crs = ReadCrs(text);
    for (size_t i = rows_from_; i < table_.rows.size(); ++i) ReadRow(table_.rows[i]);
    if (rows_.empty()) throw base::InputError(file_, "has no positions", kGeoFix);
    WarnOfRows();
    Place(*crs);
    KeepOnePerPhoto();
    for (RawRow& raw : rows_) result_.rows.push_back(std::move(raw.row));
    return std::move(result_);
  }

 private:
  std::optional<double> Number(const std::string& text) const { return tables::ParseTableNumber(text, table_.decimal_comma); }

  bool HasNumber(const std::vector<std::string>& fields) const {
    return std::any_of(fields.begin(), fields.end(), [&](const std::string& field) { return Number(field).has_value(); });
  }

  // Sets heading_ and rows_from_.
  void FindHeading() {
    heading_.clear();
    rows_from_ = 0;
    const auto complete = [](const std::vector<std::string>& names) {
      return control::ControlColumns(names, control::TableKind::kPositions).IsComplete(control::TableKind::kPositions);
    };
    if (!table_.heading.empty() && complete(table_.heading)) heading_ = table_.heading;
    if (table_.rows.empty()) return;
    const std::vector<std::string>& first = table_.rows.front().fields;
    if (HasNumber(first)) return;
    // One whose names are not known is a heading all the same, if it has as many fields as a row needs.
    if (complete(first)) heading_ = first;
    if (complete(first) || (first.size() >= 3 && table_.rows.size() > 1)) rows_from_ = 1;
  }

  std::optional<geo::Crs> ReadCrs(const std::string& text) {
    FindHeading();
    std::string definition = table_.crs;
    int line = table_.crs_line;
    if (definition.empty()) {
      if (table_.rows.empty()) throw base::InputError(file_, "has no positions", kGeoFix);
      if (!heading_.empty() && HasDegrees()) {
        result_.warnings.push_back(file_.string() +
                                   ": does not say what its coordinate system is; its columns are named longitude and latitude, and "
                                   "are taken as WGS84 (EPSG:4326)");
        return geo::Crs("EPSG:4326");
      }
      // Names of systems are of many kinds.
      definition = table_.first_row;
      line = table_.rows.front().line;
    }
    try {
      geo::Crs crs(definition == "WGS84" ? "EPSG:4326" : definition);
      if (table_.crs.empty()) {
        table_ = tables::ParseTextTable(file_, WithoutLine(text, line));
        FindHeading();
      }
      return crs;
    } catch (const std::invalid_argument& error) {
      tables::FailTableLine(file_, line, "'" + definition.substr(0, 60) + "' is not a coordinate system (" + error.what() + ")", kCrsFix);
    }
  }

  // Whether the heading names longitude and latitude.
  bool HasDegrees() const {
    const auto names = [&](const char* part) {
      return std::any_of(heading_.begin(), heading_.end(), [&](const std::string& name) {
        return control::ColumnOfName(name, control::TableKind::kPositions).has_value() && base::LowerCase(name).find(part) != std::string::npos;
      });
    };
    return names("lon") && names("lat");
  }

  // How many words at the beginning are the photo's name: of those that stand before two numbers the fewest that are a photo's, else that end with
  // the extension of one, else the fewest.
  size_t WordsOfName(const std::vector<std::string>& words) const {
    const auto is_value = [&](size_t i) { return Number(words[i]).has_value() || (!words[i].empty() && tables::IsNoValue(words[i])); };
    std::optional<size_t> shortest, with_extension;
    std::string name;
    for (size_t n = 1; n + 2 <= words.size(); ++n) {
      name += (n == 1 ? "" : " ") + words[n - 1];
      if (!is_value(n) || !is_value(n + 1)) continue;
      if (names_.Find(name)) return n;
      if (!shortest) shortest = n;
      if (!with_extension && input::LooksLikePhoto(words[n - 1])) with_extension = n;
    }
    return with_extension ? *with_extension : shortest.value_or(1);
  }

  // The fields with the photo's name as one of them.
  std::vector<std::string> FieldsOf(const tables::TableRow& row) const {
    std::vector<std::string> fields = row.fields;
    const bool name_first = heading_.empty() || PhotoColumnIsFirst();
    if (table_.separator != ' ' || !name_first || fields.size() < 3) return fields;
    const size_t n = WordsOfName(fields);
    const std::string name = base::Join(std::span(fields).first(n), " ");
    fields.erase(fields.begin(), fields.begin() + static_cast<std::ptrdiff_t>(n - 1));
    fields.front() = name;
    return fields;
  }

  bool PhotoColumnIsFirst() const {
    const std::optional<control::ControlColumn> column = control::ColumnOfName(heading_.front(), control::TableKind::kPositions);
    return column == control::ControlColumn::kPhoto || column == control::ControlColumn::kLabel;
  }

  // By the heading, else by place. Empty: there is none.
  std::string Field(const std::vector<std::string>& fields, control::ControlColumn column) const {
    if (!heading_.empty()) return control::ControlColumns(heading_, control::TableKind::kPositions).Field(fields, column);
    const auto at = [&](size_t i) { return i < fields.size() ? fields[i] : std::string(); };
    // Pix4D's rows without angles; OpenDroneMap has no rows of six.
    const bool six = fields.size() == 6 && IsAccuracy(fields[4]) && IsAccuracy(fields[5]);
    switch (column) {
      case control::ControlColumn::kPhoto:
        return at(0);
      case control::ControlColumn::kX:
        return at(1);
      case control::ControlColumn::kY:
        return at(2);
      case control::ControlColumn::kZ:
        return at(3);
      case control::ControlColumn::kHorizontalSigma:
        return at(six ? 4 : 7);
      case control::ControlColumn::kVerticalSigma:
        return at(six ? 5 : 8);
      default:
        return "";
    }
  }

  bool IsAccuracy(const std::string& text) const {
    constexpr double kMost_m = 50.0;
    const std::optional<double> value = Number(text);
    return value && *value > 0.0 && *value < kMost_m;
  }

  // Zero, less, and what is no number mean that it is not known.
  std::optional<double> Accuracy(const std::vector<std::string>& fields, control::ControlColumn column) const {
    const std::optional<double> value = Number(Field(fields, column));
    return value && *value > 0.0 ? value : std::nullopt;
  }

  void ReadRow(const tables::TableRow& row) {
    const std::vector<std::string> fields = FieldsOf(row);
    std::string photo = Field(fields, control::ControlColumn::kPhoto);
    if (photo.empty()) photo = Field(fields, control::ControlColumn::kLabel);
    const std::string x = Field(fields, control::ControlColumn::kX), y = Field(fields, control::ControlColumn::kY),
                      z = Field(fields, control::ControlColumn::kZ);
    if (photo.empty() || photo.size() > 4096) tables::FailTableLine(file_, row.line, "has no name of a photo", kGeoFix);
    if (fields.size() < 3) tables::FailTableLine(file_, row.line, "has no x and y", kGeoFix);
    const auto number = [&](const std::string& text) {
      const std::optional<double> value = Number(text);
      if (!value) tables::FailTableLine(file_, row.line, "'" + text.substr(0, 60) + "' is not a number", kGeoFix);
      return *value;
    };
    if (tables::IsNoValue(x) || tables::IsNoValue(y)) {
      ++n_without_position_;
      return;
    }
    RawRow raw;
    raw.given = {number(x), number(y), tables::IsNoValue(z) ? kNotGiven : number(z)};
    if (raw.given.x() == 0.0 && raw.given.y() == 0.0) {
      ++n_without_position_;
      return;
    }
    raw.row.photo = photo;
    raw.row.index = names_.Find(photo);
    raw.row.line = row.line;
    raw.row.horizontal_accuracy_m = Accuracy(fields, control::ControlColumn::kHorizontalSigma);
    raw.row.vertical_accuracy_m = Accuracy(fields, control::ControlColumn::kVerticalSigma);
    if (const std::optional<double> both = Accuracy(fields, control::ControlColumn::kSigma)) {
      if (!raw.row.horizontal_accuracy_m) raw.row.horizontal_accuracy_m = both;
      if (!raw.row.vertical_accuracy_m) raw.row.vertical_accuracy_m = both;
    }
    rows_.push_back(std::move(raw));
  }

  void WarnOfRows() {
    if (n_without_position_ > 0) {
      result_.warnings.push_back(fmt::format("{}: {} of {} rows have no position (nothing, NaN, or 0 for x and y) and are not used", file_.string(),
                                             n_without_position_, n_without_position_ + rows_.size()));
    }
  }

  // Nothing, with the reason, for a place that is none.
  static std::optional<geo::Geodetic> PlaceOf(const geo::Crs& crs, const Eigen::Vector3d& given, bool exchanged, std::string* reason) {
    const bool has_height = !std::isnan(given.z());
    const double z = has_height ? given.z() : 0.0;
    try {
      geo::Geodetic place = crs.ToGeodetic(exchanged ? Eigen::Vector3d(given.y(), given.x(), z) : Eigen::Vector3d(given.x(), given.y(), z));
      if (!has_height) place.height_m = kNotGiven;
      return place;
    } catch (const std::invalid_argument& error) {
      if (reason != nullptr) *reason = error.what();
      return std::nullopt;
    }
  }

  // Horizontally, from the photo's own tag; nothing when it has none.
  std::optional<double> FromTag_m(const GeoRow& row, const geo::Geodetic& place) const {
    if (!row.index || !photos_[*row.index].tags.gps) return std::nullopt;
    const geo::Geodetic& tag = *photos_[*row.index].tags.gps;
    return (geo::EcefFromGeodetic({tag.latitude_deg, tag.longitude_deg, 0.0}) - geo::EcefFromGeodetic({place.latitude_deg, place.longitude_deg, 0.0}))
        .norm();
  }

  void Place(const geo::Crs& crs) {
    using Places = std::vector<std::optional<geo::Geodetic>>;
    Places places, others;
    std::vector<std::string> reasons(rows_.size());
    std::vector<double> from_tags_m, others_from_tags_m;
    for (size_t i = 0; i < rows_.size(); ++i) {
      places.push_back(PlaceOf(crs, rows_[i].given, false, &reasons[i]));
      others.push_back(PlaceOf(crs, rows_[i].given, true, nullptr));
      if (!places.back() || !others.back()) continue;
      const std::optional<double> distance_m = FromTag_m(rows_[i].row, *places.back()), other_m = FromTag_m(rows_[i].row, *others.back());
      if (!distance_m) continue;
      from_tags_m.push_back(*distance_m);
      others_from_tags_m.push_back(*other_m);
    }
    const auto n_places = std::count_if(places.begin(), places.end(), [](const auto& place) { return place.has_value(); });
    const bool others_possible = std::all_of(others.begin(), others.end(), [](const auto& place) { return place.has_value(); });
    const bool impossible = 2 * n_places < static_cast<std::ptrdiff_t>(places.size());
    const double distance_m = base::Median(from_tags_m), other_m = base::Median(others_from_tags_m);
    constexpr double kFar_m = 1000.0, kTimes = 10.0;
    const bool nearer = distance_m > kFar_m && other_m < kFar_m && distance_m > kTimes * other_m;
    const bool axes_said = !heading_.empty() && control::ControlColumns(heading_, control::TableKind::kPositions).axes_said();
    if (others_possible && (impossible || (nearer && !axes_said))) {
      result_.exchanged = true;
      result_.warnings.push_back(fmt::format(
          "{}: x and y look exchanged and are taken the other way round: as they are written, {}. Write x (east or longitude) before y, or name the "
          "columns in a line below the coordinate system, for instance photo,lat,lon,height",
          file_.string(),
          impossible
              ? fmt::format("{} of {} positions are outside of the coordinate system", places.size() - static_cast<size_t>(n_places), places.size())
              : fmt::format("they are {:.0f} km from the photos' GPS tags, the other way round {:.0f} m", 1e-3 * distance_m, other_m)));
      places = std::move(others);
    } else if (nearer) {
      result_.warnings.push_back(fmt::format(
          "{}: the columns of x and y look exchanged: as they are named, the positions are {:.0f} km from the photos' GPS tags, the other way round "
          "{:.0f} m. Correct their names, or the tags",
          file_.string(), 1e-3 * distance_m, other_m));
    }
    for (size_t i = 0; i < rows_.size(); ++i) {
      if (!places[i]) {
        tables::FailTableLine(file_, rows_[i].row.line, reasons[i],
                              crs.heights() == geo::CrsHeights::kGravity
                                  ? "Check the coordinates and the first line; heights above a geoid need its grid (projsync, or Debian's proj-data)"
                                  : "Check that x is east or longitude and y north or latitude, and that the first line is their coordinate system");
      }
      rows_[i].row.position = *places[i];
    }
  }

  // Of rows that name one photo, the one whose folders say most; another photo of that name may be missing.
  void KeepOnePerPhoto() {
    std::map<size_t, size_t> row_of_photo;
    std::map<std::string, int> line_of_name;
    std::vector<std::string> unknown;
    int first_unknown = 0;
    for (size_t i = 0; i < rows_.size(); ++i) {
      GeoRow& row = rows_[i].row;
      const auto [line, is_new] = line_of_name.emplace(row.photo, row.line);
      if (!is_new) FailTwice(row, line->second);
      if (!row.index) continue;
      const auto [first, is_first] = row_of_photo.emplace(*row.index, i);
      if (is_first) continue;
      GeoRow& other = rows_[first->second].row;
      const size_t parts = names_.CommonParts(row.photo, *row.index), of_other = names_.CommonParts(other.photo, *row.index);
      // Another folder's photo, which is not there, if the names end alike but for the folder.
      const bool folders = row.photo.find_first_of("/\\") != std::string::npos && other.photo.find_first_of("/\\") != std::string::npos;
      if (parts == of_other && !folders) FailTwice(row, other.line);
      if (parts == of_other) {
        ambiguous_.push_back(*row.index);
        row.index.reset();
      } else if (parts > of_other) {
        other.index.reset();
        first->second = i;
      } else {
        row.index.reset();
      }
    }
    for (RawRow& raw : rows_) {
      if (raw.row.index && std::find(ambiguous_.begin(), ambiguous_.end(), *raw.row.index) != ambiguous_.end()) raw.row.index.reset();
      if (raw.row.index) continue;
      if (unknown.empty()) first_unknown = raw.row.line;
      unknown.push_back(raw.row.photo.substr(0, 60));
    }
    if (unknown.empty() || unknown.size() == rows_.size()) return;
    constexpr size_t kShown = 5;
    const size_t n_shown = std::min(unknown.size(), kShown);
    result_.warnings.push_back(fmt::format("{}: line {}: {} of {} rows name no photo, or more than one: {}{}", file_.string(), first_unknown,
                                           unknown.size(), rows_.size(), base::Join(std::span(unknown).first(n_shown)),
                                           unknown.size() > kShown ? ", ..." : ""));
  }

  [[noreturn]] void FailTwice(const GeoRow& row, int line) const {
    tables::FailTableLine(file_, row.line, "names " + row.photo.substr(0, 60) + " a second time, after line " + std::to_string(line),
                          "Keep one line per photo");
  }

  fs::path file_;
  const std::vector<input::PhotoFile>& photos_;
  models::PhotoNames names_;
  tables::TextTable table_;
  std::vector<std::string> heading_;
  size_t rows_from_ = 0, n_without_position_ = 0;
  std::vector<RawRow> rows_;
  std::vector<size_t> ambiguous_;
  GeoTable result_;
};

}  // namespace

GeoTable ReadGeoTable(const fs::path& file, const std::vector<input::PhotoFile>& photos) {
  return GeoReader(file, photos).Read();
}

}  // namespace skyquilt::prepare::georeference
