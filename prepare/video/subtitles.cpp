#include "prepare/video/subtitles.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>

#include "core/base/cancel.h"
#include "core/base/errors.h"

namespace skyquilt::prepare::video {
namespace {

constexpr size_t kLongestCue = 4096;  // what follows is no subtitle
constexpr const char* kSubtitleFix = "Copy the subtitles from the drone again, or remove the file to go on without them";

bool IsWordCharacter(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.';
}

// Behind a word that stands alone, its spaces and its ':' or '='; null data where it is missing. `text` is in lower case.
std::string_view Behind(std::string_view text, std::string_view word) {
  for (size_t at = text.find(word); at != std::string_view::npos; at = text.find(word, at + 1)) {
    const size_t end = at + word.size();
    if ((at > 0 && IsWordCharacter(text[at - 1])) || (end < text.size() && IsWordCharacter(text[end]))) continue;
    size_t value = std::min(text.find_first_not_of(" \t", end), text.size());
    if (value < text.size() && (text[value] == ':' || text[value] == '=')) value = std::min(text.find_first_not_of(" \t", value + 1), text.size());
    return text.substr(value);
  }
  return {};
}

std::optional<double> NumberBehind(std::string_view text, std::initializer_list<std::string_view> words) {
  for (const std::string_view word : words) {
    const std::string_view value = Behind(text, word);
    if (value.data() == nullptr) continue;
    if (const std::optional<double> number = LeadingNumber(value)) return number;
  }
  return std::nullopt;
}

std::optional<double> Positive(std::optional<double> value) {
  return value && *value > 0.0 ? value : std::nullopt;
}

std::optional<double> Within(std::optional<double> value, double most) {
  return value && std::abs(*value) <= most ? value : std::nullopt;
}

struct TupleNumber {
  double value = 0.0;
  char direction = '\0';  // n, s, e or w before it
  bool has_unit = false;  // an m behind it
  size_t decimals = 0;
};

// The numbers of "(a, b, c)" at the beginning of the text; empty when it is something else.
std::vector<TupleNumber> Tuple(std::string_view text) {
  if (!text.starts_with('(')) return {};
  const size_t close = text.find(')');
  if (close == std::string_view::npos) return {};
  text = text.substr(1, close - 1);
  std::vector<TupleNumber> numbers;
  while (!text.empty()) {
    const size_t comma = std::min(text.find(','), text.size());
    std::string_view field = text.substr(0, comma);
    text.remove_prefix(std::min(comma + 1, text.size()));
    field.remove_prefix(std::min(field.find_first_not_of(' '), field.size()));
    TupleNumber number;
    if (!field.empty() && std::string_view("nsew").find(field.front()) != std::string_view::npos) {
      number.direction = field.front();
      field.remove_prefix(std::min(field.find_first_not_of(": ", 1), field.size()));
    }
    size_t length = 0;
    const std::optional<double> value = LeadingNumber(field, &length);
    if (!value) return {};
    number.value = number.direction == 's' || number.direction == 'w' ? -*value : *value;
    const size_t point = field.substr(0, length).find('.');
    number.decimals = point == std::string_view::npos ? 0 : length - point - 1;
    field.remove_prefix(length);
    number.has_unit = field.starts_with('m');
    numbers.push_back(number);
  }
  return numbers;
}

size_t DecimalsOf(std::string_view text) {
  size_t length = 0;
  if (!LeadingNumber(text, &length)) return 0;
  const size_t point = text.substr(0, length).find('.');
  return point == std::string_view::npos ? 0 : length - point - 1;
}

// Sets the position and returns its decimals; 0: there is none.
size_t ReadPosition(std::string_view text, TrackPoint& point) {
  const std::string_view latitude = Behind(text, "latitude");
  std::string_view longitude = Behind(text, "longitude");
  // A spelling mistake of early firmware.
  if (longitude.data() == nullptr) longitude = Behind(text, "longtitude");
  if (const std::optional<double> lat = LeadingNumber(latitude), lon = LeadingNumber(longitude); lat && lon) {
    SetPosition(*lat, *lon, point);
    return std::max<size_t>(1, std::max(DecimalsOf(latitude), DecimalsOf(longitude)));
  }
  for (const std::string_view word : {"gps", "rtk"}) {
    const std::vector<TupleNumber> numbers = Tuple(Behind(text, word));
    if (numbers.size() < 2) continue;
    const bool named = numbers[0].direction == 'n' || numbers[0].direction == 's';
    const bool by_unit = numbers[0].direction == '\0' && numbers.size() > 2 && numbers[2].has_unit;
    const size_t lat = named || by_unit ? 0 : 1;
    SetPosition(numbers[lat].value, numbers[1 - lat].value, point);
    if (numbers[0].direction != '\0' && numbers.size() > 2 && numbers[2].has_unit) point.altitude_m = Within(numbers[2].value, 20'000.0);
    return std::max<size_t>(1, std::max(numbers[0].decimals, numbers[1].decimals));
  }
  return 0;
}

void ReadAngles(std::string_view text, TrackPoint& point) {
  point.gimbal_yaw_deg = Within(NumberBehind(text, {"gb_yaw"}), 360.0);
  point.gimbal_pitch_deg = Within(NumberBehind(text, {"gb_pitch"}), 180.0);
  point.gimbal_roll_deg = Within(NumberBehind(text, {"gb_roll"}), 180.0);
  const std::vector<TupleNumber> angles = Tuple(Behind(text, "g.pry"));
  if (angles.size() != 3 || point.gimbal_pitch_deg) return;
  point.gimbal_pitch_deg = Within(angles[0].value, 180.0);
  point.gimbal_roll_deg = Within(angles[1].value, 180.0);
  point.gimbal_yaw_deg = Within(angles[2].value, 360.0);
}

// Seconds of "1/320.0", or of the number of which it is one part.
std::optional<double> ExposureOf(std::string_view text) {
  size_t length = 0;
  const std::optional<double> first = Positive(LeadingNumber(text, &length));
  if (!first) return std::nullopt;
  text.remove_prefix(length);
  if (!text.starts_with('/')) return 1.0 / *first;
  const std::optional<double> second = Positive(LeadingNumber(text.substr(1)));
  return second ? std::optional(*first / *second) : std::nullopt;
}

void ReadExposure(std::string_view text, TrackPoint& point) {
  constexpr double kLongest_s = 60.0;
  for (const std::string_view word : {"shutter", "ss"}) {
    if (!point.exposure_time_s) point.exposure_time_s = Within(ExposureOf(Behind(text, word)), kLongest_s);
  }
  point.iso = Within(Positive(NumberBehind(text, {"iso"})), 1e7);
  std::string_view f_number;
  for (const std::string_view word : {"fnum", "f-num"}) {
    if (f_number.data() == nullptr) f_number = Behind(text, word);
  }
  if (f_number.starts_with('f')) f_number.remove_prefix(1);
  if (f_number.data() == nullptr) {
    f_number = Behind(text, "f");
    f_number = f_number.starts_with('/') ? f_number.substr(1) : std::string_view();
  }
  point.f_number = Positive(LeadingNumber(f_number));
  // 280 is f/2.8; no drone has f/50.
  if (point.f_number && *point.f_number > 50.0) *point.f_number /= 100.0;
  const std::string_view focal = Behind(text, "focal_len");
  point.focal_35mm = Positive(LeadingNumber(focal));
  // 240 is 24 mm; newer firmware writes 24.00.
  if (point.focal_35mm && *point.focal_35mm >= 100.0 && DecimalsOf(focal) == 0) *point.focal_35mm /= 10.0;
  point.focal_35mm = Within(point.focal_35mm, 2000.0);
}

class SubtitleReader {
 public:
  explicit SubtitleReader(FlightTrack& track) : track_(track) {}

  void Line(std::string_view line) {
    if (const size_t arrow = line.find("-->"); arrow != std::string_view::npos) {
      End();
      has_cues_ = true;
      start_s_ = CueTime(line.substr(0, arrow));
      return;
    }
    // Without cues, every date begins a block.
    if (!has_cues_ && FindClock(line)) End();
    if (text_.size() + line.size() > kLongestCue) return;
    text_.append(line);
    text_.push_back(' ');
  }

  void End() {
    if (!text_.empty()) Add();
    text_.clear();
    start_s_.reset();
  }

  // Decimals of the most exact position.
  size_t decimals() const { return decimals_; }

 private:
  static std::optional<double> CueTime(std::string_view text) {
    double time_s = 0.0;
    int n = 0;
    while (n < 3) {
      size_t length = 0;
      const std::optional<double> part = LeadingNumber(text, &length);
      if (!part || *part < 0.0 || *part > 1e6) return std::nullopt;
      time_s = 60.0 * time_s + *part;
      text.remove_prefix(length);
      if (++n < 3 && !text.starts_with(':')) return std::nullopt;
      if (n < 3) text.remove_prefix(1);
    }
    // Behind the seconds, which are whole where a comma follows.
    if (text.starts_with(',')) {
      size_t length = 0;
      const std::optional<double> thousandths = LeadingNumber(text.substr(1), &length);
      if (thousandths && *thousandths >= 0.0 && length <= 6) time_s += *thousandths * std::pow(10.0, -static_cast<double>(length));
    }
    return time_s;
  }

  void Add() {
    std::transform(text_.begin(), text_.end(), text_.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    std::replace_if(
        text_.begin(), text_.end(), [](char c) { return c == '[' || c == ']' || c == '<' || c == '>' || c == '\t' || c == '\r'; }, ' ');
    const std::string_view text = text_;
    TrackPoint point;
    const size_t decimals = ReadPosition(text, point);
    if (point.latitude_deg) decimals_ = std::max(decimals_, decimals);
    constexpr double kHighest_m = 20'000.0;
    point.relative_altitude_m = Within(NumberBehind(text, {"rel_alt", "barometer", "hb", "h"}), kHighest_m);
    if (!point.altitude_m) point.altitude_m = Within(NumberBehind(text, {"abs_alt", "altitude"}), kHighest_m);
    ReadAngles(text, point);
    ReadExposure(text, point);
    point.clock_s = FindClock(text);
    const bool tells = point.latitude_deg || point.relative_altitude_m || point.gimbal_pitch_deg || point.exposure_time_s;
    if (!tells) return;
    if (start_s_) {
      point.time_s = *start_s_;
    } else if (!has_cues_ && point.clock_s) {
      if (!first_clock_s_) first_clock_s_ = *point.clock_s;
      point.time_s = *point.clock_s - *first_clock_s_;
    } else {
      return;
    }
    if (!track_.points.empty() && std::abs(point.time_s - track_.points.back().time_s) < kLeastApart_s) return;
    track_.points.push_back(point);
  }

  FlightTrack& track_;
  std::string text_;
  std::optional<double> start_s_, first_clock_s_;
  bool has_cues_ = false;
  size_t decimals_ = 0;
};

}  // namespace

FlightTrack ReadSubtitles(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw base::InputError(file, "cannot be read", "Check its permissions, or remove it to go on without it");
  return ParseSubtitles(in, file);
}

FlightTrack ParseSubtitles(std::istream& in, const std::filesystem::path& file) {
  FlightTrack track{.file = file, .form = "subtitles"};
  SubtitleReader reader(track);
  size_t n_lines = 0;
  // Lines without an end are no subtitles, and must not fill the memory.
  std::string buffer(65'536, '\0');
  while (in.getline(buffer.data(), static_cast<std::streamsize>(buffer.size())) || in.gcount() > 0) {
    if (in.fail() && !in.eof()) throw base::InputError(file, "line " + std::to_string(n_lines + 1) + " is too long for subtitles", kSubtitleFix);
    std::string_view line(buffer.data(), static_cast<size_t>(in.gcount()));
    // The end of the line, which getline replaces.
    while (!line.empty() && (line.back() == '\0' || line.back() == '\r')) line.remove_suffix(1);
    if (line.find('\0') != std::string_view::npos) {
      throw base::InputError(file, "line " + std::to_string(n_lines + 1) + " is not text in UTF-8", kSubtitleFix);
    }
    if (++n_lines % 4096 == 0) base::ThrowIfCancelled();
    reader.Line(line);
  }
  reader.End();
  TidyPoints(track.points);
  if (reader.decimals() > 0 && reader.decimals() < 6) track.position_step_deg = std::pow(10.0, -static_cast<double>(reader.decimals()));
  return track;
}

}  // namespace skyquilt::prepare::video
