#include "prepare/video/csv_track.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <string_view>

#include "core/base/file.h"
#include "core/base/text.h"
#include "prepare/tables/text_table.h"

namespace skyquilt::prepare::video {
namespace {

constexpr const char* kCsvFix = "Correct it, or remove the file to go on without it";
constexpr double kFoot_m = 0.3048;

struct Column {
  std::optional<size_t> index;
  double factor = 1.0;  // to metres and seconds
};

struct Columns {
  Column time, latitude, longitude, relative_altitude, altitude, yaw, pitch, roll, is_video;
  std::optional<size_t> date;
};

// "Height_above_takeoff (feet)": the name without spaces and its unit, in lower case.
struct Heading {
  std::string name, unit;
};

Heading HeadingOf(const std::string& field) {
  Heading heading;
  std::string text = base::LowerCase(field);
  std::erase_if(text, [](char c) { return c == ' ' || c == '"' || c == '#' || static_cast<unsigned char>(c) >= 0x80U; });
  const size_t open = std::min(text.find_first_of("(["), text.size());
  heading.name = text.substr(0, open);
  heading.unit = text.substr(open);
  std::erase_if(heading.unit, [](char c) { return c == '(' || c == ')' || c == '[' || c == ']'; });
  return heading;
}

double FactorOf(const std::string& unit) {
  if (unit == "feet" || unit == "ft" || unit == "foot") return kFoot_m;
  if (unit == "millisecond" || unit == "milliseconds" || unit == "ms") return 1e-3;
  return 1.0;
}

// The first of the names that the heading has.
Column Find(const std::vector<Heading>& headings, std::initializer_list<std::string_view> names) {
  for (const std::string_view name : names) {
    for (size_t i = 0; i < headings.size(); ++i) {
      if (headings[i].name == name) return {i, FactorOf(headings[i].unit)};
    }
  }
  return {};
}

Columns ColumnsOf(const std::vector<std::string>& fields) {
  std::vector<Heading> headings;
  for (const std::string& field : fields) headings.push_back(HeadingOf(field));
  Columns columns;
  columns.time = Find(headings, {"time", "time_s", "seconds", "t", "timestamp", "time_ms"});
  if (columns.time.index && headings[*columns.time.index].name == "time_ms") columns.time.factor = 1e-3;
  columns.date = Find(headings, {"datetime", "date", "utc", "time_utc"}).index;
  columns.latitude = Find(headings, {"latitude", "lat"});
  columns.longitude = Find(headings, {"longitude", "lon", "lng", "long"});
  columns.relative_altitude = Find(headings, {"height_above_takeoff", "relative_altitude", "rel_alt", "height", "agl"});
  columns.altitude = Find(headings, {"altitude_above_sealevel", "absolute_altitude", "abs_alt", "altitude", "alt", "ele", "elevation"});
  columns.yaw = Find(headings, {"gimbal_heading", "gimbal_yaw", "gb_yaw", "yaw"});
  columns.pitch = Find(headings, {"gimbal_pitch", "gb_pitch", "pitch"});
  columns.roll = Find(headings, {"gimbal_roll", "gb_roll", "roll"});
  columns.is_video = Find(headings, {"isvideo", "is_video"});
  return columns;
}

class RowReader {
 public:
  RowReader(const tables::TextTable& table, const tables::TableRow& row) : table_(table), row_(row) {}

  std::string Text(const std::optional<size_t>& index) const { return index && *index < row_.fields.size() ? row_.fields[*index] : std::string(); }
  std::optional<double> Number(const Column& column, double most) const {
    const std::string text = Text(column.index);
    if (!column.index || tables::IsNoValue(text)) return std::nullopt;
    const std::optional<double> value = LongNumber(text);
    if (!value) tables::FailTableLine(table_.file, row_.line, "has '" + text.substr(0, 40) + "' where a number must be", kCsvFix);
    const double scaled = *value * column.factor;
    return std::abs(scaled) <= most ? std::optional(scaled) : std::nullopt;
  }

 private:
  // Times in milliseconds since 1970 are larger than the numbers of other tables.
  std::optional<double> LongNumber(const std::string& text) const {
    if (table_.decimal_comma) return tables::ParseTableNumber(text, true);
    size_t length = 0;
    const std::optional<double> value = LeadingNumber(text, &length);
    return value && text.find_first_not_of(' ', length) == std::string::npos ? value : std::nullopt;
  }

  const tables::TextTable& table_;
  const tables::TableRow& row_;
};

}  // namespace

std::vector<FlightTrack> ReadCsvTracks(const std::filesystem::path& file) {
  const tables::TextTable table = tables::ParseTextTable(file, base::ReadFile(file));
  const bool commented = !table.heading.empty();
  if (!commented && table.rows.empty()) return {};
  const Columns columns = ColumnsOf(commented ? table.heading : table.rows.front().fields);
  if (!columns.latitude.index || !columns.longitude.index || (!columns.time.index && !columns.date)) return {};
  // Seconds since 1970 are no seconds of a video.
  constexpr double kLongestVideo_s = 1e7, kLatest_s = 1e11;
  std::vector<FlightTrack> tracks;
  bool recording = false;
  double first_s = 0.0;
  for (size_t i = commented ? 0 : 1; i < table.rows.size(); ++i) {
    const RowReader row(table, table.rows[i]);
    TrackPoint point;
    std::optional<double> time_s = row.Number(columns.time, kLatest_s);
    point.clock_s = FindClock(row.Text(columns.date));
    const bool by_clock = !time_s || *time_s > kLongestVideo_s;
    if (!time_s) time_s = point.clock_s;
    const std::optional<double> latitude = row.Number(columns.latitude, 90.0), longitude = row.Number(columns.longitude, 180.0);
    const bool filming = !columns.is_video.index || row.Number(columns.is_video, 1e9).value_or(0.0) != 0.0;
    if (!filming) recording = false;
    if (!time_s || !latitude || !longitude || !filming) continue;
    if (!recording) {
      tracks.push_back({.file = file, .form = "CSV", .by_clock = by_clock && !columns.is_video.index});
      first_s = columns.is_video.index ? *time_s : 0.0;
    }
    recording = true;
    SetPosition(*latitude, *longitude, point);
    point.time_s = *time_s - first_s;
    point.relative_altitude_m = row.Number(columns.relative_altitude, 20'000.0);
    point.altitude_m = row.Number(columns.altitude, 20'000.0);
    point.gimbal_yaw_deg = row.Number(columns.yaw, 360.0);
    point.gimbal_pitch_deg = row.Number(columns.pitch, 180.0);
    point.gimbal_roll_deg = row.Number(columns.roll, 180.0);
    tracks.back().points.push_back(point);
  }
  for (FlightTrack& track : tracks) TidyPoints(track.points);
  return tracks;
}

}  // namespace skyquilt::prepare::video
