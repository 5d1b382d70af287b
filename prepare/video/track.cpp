#include "prepare/video/track.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>

namespace skyquilt::prepare::video {
namespace {

std::optional<double> Between(const std::optional<double>& a, const std::optional<double>& b, double share) {
  if (!a || !b) return share < 0.5 ? a : b;
  return *a + share * (*b - *a);
}

// The shorter way round.
std::optional<double> AngleBetween(const std::optional<double>& a, const std::optional<double>& b, double share) {
  if (!a || !b) return share < 0.5 ? a : b;
  return std::remainder(*a + share * std::remainder(*b - *a, 360.0), 360.0);
}

bool IsDigit(char c) {
  return c >= '0' && c <= '9';
}

// Reads parts of a date from the front of a text.
class Scanner {
 public:
  explicit Scanner(std::string_view text) : text_(text) {}

  // A number of least to most digits.
  bool Digits(size_t least, size_t most, int* value) {
    size_t n = 0;
    *value = 0;
    while (n < most && n < text_.size() && IsDigit(text_[n])) *value = 10 * *value + (text_[n++] - '0');
    if (n < least) return false;
    text_.remove_prefix(n);
    return true;
  }
  bool OneOf(std::string_view characters) {
    if (text_.empty() || characters.find(text_.front()) == std::string_view::npos) return false;
    text_.remove_prefix(1);
    return true;
  }
  // Digits behind a point, as a share of one.
  double Fraction() {
    double value = 0.0, place = 0.1;
    while (!text_.empty() && IsDigit(text_.front())) {
      value += place * (text_.front() - '0');
      place *= 0.1;
      text_.remove_prefix(1);
    }
    return value;
  }
  bool NextIsDigit() const { return !text_.empty() && IsDigit(text_.front()); }
  char Next() const { return text_.empty() ? '\0' : text_.front(); }
  char Then() const { return text_.size() < 2 ? '\0' : text_[1]; }

 private:
  std::string_view text_;
};

std::optional<double> ClockAt(std::string_view text) {
  Scanner scan(text);
  int year = 0, month = 0, day = 0, hour = 0, minute = 0, second = 0;
  const bool read = scan.Digits(4, 4, &year) && scan.OneOf("-./:") && scan.Digits(1, 2, &month) && scan.OneOf("-./:") && scan.Digits(1, 2, &day) &&
                    scan.OneOf(" Tt_") && scan.Digits(1, 2, &hour) && scan.OneOf(":") && scan.Digits(2, 2, &minute) && scan.OneOf(":") &&
                    scan.Digits(2, 2, &second);
  if (!read || year < 1970 || hour > 23 || minute > 59 || second > 60) return std::nullopt;
  const std::chrono::year_month_day date{std::chrono::year(year), std::chrono::month(static_cast<unsigned>(month)),
                                         std::chrono::day(static_cast<unsigned>(day))};
  if (!date.ok()) return std::nullopt;
  double time_s = static_cast<double>(std::chrono::sys_days(date).time_since_epoch().count()) * 86400.0 + hour * 3600.0 + minute * 60.0 + second;
  // 51,393,525: milliseconds and microseconds.
  if ((scan.Next() == '.' || scan.Next() == ',') && IsDigit(scan.Then())) {
    scan.OneOf(".,");
    time_s += scan.Fraction();
    if ((scan.Next() == '.' || scan.Next() == ',') && IsDigit(scan.Then())) {
      scan.OneOf(".,");
      time_s += 1e-3 * scan.Fraction();
    }
  }
  const char sign = scan.Next();
  if ((sign == '+' || sign == '-') && IsDigit(scan.Then())) {
    scan.OneOf("+-");
    int hours = 0, minutes = 0;
    if (scan.Digits(2, 2, &hours) && (!scan.OneOf(":") || scan.NextIsDigit())) {
      if (scan.NextIsDigit() && !scan.Digits(2, 2, &minutes)) minutes = 0;
      if (hours <= 14 && minutes <= 59) time_s -= (sign == '+' ? 1.0 : -1.0) * (hours * 3600.0 + minutes * 60.0);
    }
  }
  return time_s;
}

}  // namespace

std::optional<TrackPoint> StateAt(const FlightTrack& track, double time_s, double most_apart_s) {
  const std::vector<TrackPoint>& points = track.points;
  if (points.empty() || !std::isfinite(time_s)) return std::nullopt;
  const auto after = std::lower_bound(points.begin(), points.end(), time_s, [](const TrackPoint& point, double time) { return point.time_s < time; });
  if (after == points.begin() || after == points.end()) {
    const TrackPoint& nearest = after == points.end() ? points.back() : points.front();
    if (std::abs(nearest.time_s - time_s) > most_apart_s) return std::nullopt;
    return nearest;
  }
  const TrackPoint &a = *(after - 1), &b = *after;
  const double gap_s = b.time_s - a.time_s;
  if (gap_s > 2.0 * most_apart_s) {
    if (time_s - a.time_s <= most_apart_s) return a;
    if (b.time_s - time_s <= most_apart_s) return b;
    return std::nullopt;
  }
  const double share = gap_s > 0.0 ? (time_s - a.time_s) / gap_s : 0.0;
  TrackPoint state = share < 0.5 ? a : b;
  state.time_s = time_s;
  state.latitude_deg = Between(a.latitude_deg, b.latitude_deg, share);
  state.longitude_deg = AngleBetween(a.longitude_deg, b.longitude_deg, share);
  state.altitude_m = Between(a.altitude_m, b.altitude_m, share);
  state.relative_altitude_m = Between(a.relative_altitude_m, b.relative_altitude_m, share);
  state.gimbal_yaw_deg = AngleBetween(a.gimbal_yaw_deg, b.gimbal_yaw_deg, share);
  state.gimbal_pitch_deg = AngleBetween(a.gimbal_pitch_deg, b.gimbal_pitch_deg, share);
  state.gimbal_roll_deg = AngleBetween(a.gimbal_roll_deg, b.gimbal_roll_deg, share);
  state.clock_s = Between(a.clock_s, b.clock_s, share);
  return state;
}

void TidyPoints(std::vector<TrackPoint>& points) {
  std::stable_sort(points.begin(), points.end(), [](const TrackPoint& a, const TrackPoint& b) { return a.time_s < b.time_s; });
  size_t n_kept = 0;
  for (size_t i = 0; i < points.size(); ++i) {
    if (n_kept > 0 && !(points[i].time_s - points[n_kept - 1].time_s >= kLeastApart_s)) continue;
    if (i != n_kept) points[n_kept] = points[i];
    ++n_kept;
  }
  points.resize(n_kept);
}

void SetPosition(double latitude_deg, double longitude_deg, TrackPoint& point) {
  const bool on_earth = std::abs(latitude_deg) <= 90.0 && std::abs(longitude_deg) <= 180.0;
  if (!on_earth || (latitude_deg == 0.0 && longitude_deg == 0.0)) return;
  point.latitude_deg = latitude_deg;
  point.longitude_deg = longitude_deg;
}

std::optional<double> FindClock(std::string_view text) {
  for (size_t at = 0; at + 14 <= text.size(); ++at) {
    if (!IsDigit(text[at]) || (at > 0 && IsDigit(text[at - 1]))) continue;
    if (const std::optional<double> clock = ClockAt(text.substr(at))) return clock;
  }
  return std::nullopt;
}

std::optional<double> LeadingNumber(std::string_view text, size_t* length) {
  size_t at = std::min(text.find_first_not_of(" \t"), text.size());
  if (at < text.size() && text[at] == '+') ++at;
  double value = 0.0;
  const auto result = std::from_chars(text.data() + at, text.data() + text.size(), value);
  if (result.ec != std::errc() || !std::isfinite(value)) return std::nullopt;
  if (length != nullptr) *length = static_cast<size_t>(result.ptr - text.data());
  return value;
}

}  // namespace skyquilt::prepare::video
