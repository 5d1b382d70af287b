#include "viewer/data/gcp_list.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cstdio>
#include <set>
#include <unordered_map>
#include <vector>

namespace skyquilt::viewer {
namespace {

using Json = nlohmann::json;

constexpr size_t kMaxListBytes = 4U << 20U;
constexpr size_t kMaxListPoints = 10'000;
constexpr size_t kLongestListName = 64;

bool IsBlank(char c) {
  return static_cast<unsigned char>(c) <= ' ';
}

std::string WithoutBlanks(std::string name) {
  std::replace_if(name.begin(), name.end(), IsBlank, '_');
  return name;
}

std::string Fixed(double value, int digits) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*f", digits, value);
  return text.data();
}

std::vector<std::string_view> Words(std::string_view line) {
  std::vector<std::string_view> words;
  for (size_t at = 0; at < line.size();) {
    const auto begin = std::find_if_not(line.begin() + static_cast<std::ptrdiff_t>(at), line.end(), IsBlank);
    const auto end = std::find_if(begin, line.end(), IsBlank);
    if (begin != end) words.emplace_back(begin, end);
    at = static_cast<size_t>(end - line.begin());
  }
  return words;
}

std::optional<double> Number(std::string_view word) {
  double value = 0.0;
  if (word.starts_with('+')) word.remove_prefix(1);
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size() || !(value >= -1e9 && value <= 1e9)) return {};
  return value;
}

std::optional<int> WholeNumber(std::string_view word) {
  int value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc() && end == word.data() + word.size() ? std::optional(value) : std::nullopt;
}

// The coordinate system in the first line.
struct Header {
  enum class Kind { kUnknown, kLocal, kGeographic, kMap } kind = Kind::kUnknown;
  geo::UtmZone zone = {};
};

Header MapHeader(int zone, bool north) {
  if (zone < 1 || zone > 60) return {};
  return {Header::Kind::kMap, {zone, north}};
}

Header HeaderOfEpsg(int code) {
  if (code == 4326 || code == 4979) return {Header::Kind::kGeographic, {}};
  if (code == 32661 || code == 32761) return {Header::Kind::kMap, {0, code == 32661}};
  if (code > 32600 && code <= 32660) return MapHeader(code - 32600, true);
  if (code > 32700 && code <= 32760) return MapHeader(code - 32700, false);
  if (code >= 25828 && code <= 25838) return MapHeader(code - 25800, true);
  return {};
}

Header HeaderOfProj(const std::vector<std::string_view>& words) {
  std::string_view projection;
  std::optional<int> zone;
  bool north = true;
  for (const std::string_view word : words) {
    if (word.starts_with("+PROJ=")) projection = word.substr(6);
    if (word.starts_with("+ZONE=")) zone = WholeNumber(word.substr(6));
    if (word == "+SOUTH") north = false;
    if (word.starts_with("+DATUM=") && word != "+DATUM=WGS84") return {};
    if (word.starts_with("+ELLPS=") && word != "+ELLPS=WGS84" && word != "+ELLPS=GRS80") return {};
    if (word.starts_with("+UNITS=") && word != "+UNITS=M") return {};
  }
  if (projection == "LONGLAT" || projection == "LATLONG") return {Header::Kind::kGeographic, {}};
  return projection == "UTM" && zone ? MapHeader(*zone, north) : Header();
}

Header HeaderOf(std::string line) {
  std::transform(line.begin(), line.end(), line.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  const std::vector<std::string_view> words = Words(line);
  if (words.empty()) return {};
  if (words[0] == "LOCAL" && words.size() == 1) return {Header::Kind::kLocal, {}};
  if (words[0].starts_with("EPSG:")) {
    const std::string_view code = words[0].size() > 5 ? words[0].substr(5) : words.size() > 1 ? words[1] : std::string_view();
    return HeaderOfEpsg(WholeNumber(code).value_or(0));
  }
  if (words[0].starts_with('+')) return HeaderOfProj(words);
  if (words[0] == "WGS84" && words.size() == 1) return {Header::Kind::kGeographic, {}};
  if (words.size() >= 3 && words[0] == "WGS84" && words[1] == "UTM") {
    std::string_view zone = words[2];
    std::string_view side = words.size() > 3 ? words[3] : std::string_view();
    if (side.empty() && !zone.empty()) {
      side = zone.substr(zone.size() - 1);
      zone.remove_suffix(1);
    }
    const auto number = WholeNumber(zone);
    if (number && (side == "N" || side == "S")) return MapHeader(*number, side == "N");
  }
  return {};
}

using Place = std::array<double, 3>;

// In the project's coordinates; nothing for a place that cannot be there.
std::optional<Place> Converted(const Header& header, const std::optional<geo::UtmZone>& zone, const Place& place) {
  if (!zone || (header.kind == Header::Kind::kMap && header.zone.zone == zone->zone && header.zone.north == zone->north)) return place;
  try {
    const geo::Geodetic position = header.kind == Header::Kind::kMap ? geo::GeodeticFromUtm({place[0], place[1]}, place[2], header.zone)
                                                                     : geo::Geodetic{place[1], geo::WrapLongitudeDeg(place[0]), place[2]};
    if (!geo::IsValid(position)) return {};
    const Eigen::Vector2d map = geo::UtmFromGeodetic(position, *zone);
    if (!map.allFinite()) return {};
    return Place{map.x(), map.y(), place[2]};
  } catch (const std::exception&) {
    return {};
  }
}

// At most so long, and cut between characters.
std::string Shortened(std::string name) {
  if (name.size() <= kLongestListName) return name;
  size_t end = kLongestListName;
  while (end > 0 && (static_cast<unsigned char>(name[end]) & 0xC0U) == 0x80U) --end;
  return name.substr(0, end);
}

class ListReader {
 public:
  ListReader(const Header& header, const std::optional<geo::UtmZone>& zone, const MarkablePhotos& photos)
      : header_(header), zone_(zone), photos_(photos) {}

  void Read(const std::vector<std::string_view>& words) {
    if (!TryRead(words)) ++skipped_;
  }

  // Points without a name get a free one.
  Json Take(const Json& crs) {
    std::set<std::string> taken;
    for (const Json& point : points_) taken.insert(point["name"]);
    size_t number = 1;
    for (Json& point : points_) {
      if (!point["name"].get_ref<const std::string&>().empty()) continue;
      while (taken.contains("GCP_" + std::to_string(number))) ++number;
      point["name"] = "GCP_" + std::to_string(number++);
    }
    Json gcp = {{"crs", crs}, {"points", std::move(points_)}};
    if (skipped_ > 0) gcp["skipped"] = skipped_;
    return gcp;
  }

 private:
  bool TryRead(const std::vector<std::string_view>& words) {
    if (words.size() < 6) return false;
    std::array<double, 5> numbers{};
    for (size_t i = 0; i < numbers.size(); ++i) {
      const std::optional<double> number = Number(words[i]);
      if (!number) return false;
      numbers[i] = *number;
    }
    const auto place = Converted(header_, zone_, {numbers[0], numbers[1], numbers[2]});
    if (!place) return false;
    const std::string photo = photos_.Find(std::string(words[5]));
    if (!photo.empty() && !photos_.Contains(photo, numbers[3], numbers[4])) return false;
    const std::string name = words.size() > 6 ? Shortened(std::string(words[6])) : "";
    Json* marks =
        MarksOf(name, name.empty() ? Fixed((*place)[0], 4) + " " + Fixed((*place)[1], 4) + " " + Fixed((*place)[2], 4) : "n " + name, *place);
    if (marks == nullptr) return false;
    Json mark = {{"photo", photo.empty() ? std::string(words[5]) : photo}, {"pixel", {numbers[3], numbers[4]}}};
    if (photo.empty()) mark["unknown"] = true;
    const auto same = std::find_if(marks->begin(), marks->end(), [&](const Json& other) { return other["photo"] == mark["photo"]; });
    if (same != marks->end()) {
      *same = std::move(mark);
    } else {
      marks->push_back(std::move(mark));
    }
    return true;
  }

  Json* MarksOf(const std::string& name, const std::string& key, const Place& place) {
    const auto at = index_.find(key);
    if (at != index_.end()) return &points_[at->second]["marks"];
    if (points_.size() >= kMaxListPoints) return nullptr;
    index_[key] = points_.size();
    points_.push_back({{"name", name}, {"x", place[0]}, {"y", place[1]}, {"z", place[2]}, {"marks", Json::array()}});
    return &points_.back()["marks"];
  }

  const Header& header_;
  const std::optional<geo::UtmZone>& zone_;
  const MarkablePhotos& photos_;
  Json points_ = Json::array();
  std::unordered_map<std::string, size_t> index_;
  int skipped_ = 0;
};

}  // namespace

std::string GcpListText(const Json& gcp, const MarkablePhotos& photos) {
  std::string text = gcp["crs"].is_string() ? gcp["crs"].get<std::string>() : "LOCAL";
  text += "\n";
  std::set<std::string> names;
  for (const Json& point : gcp["points"]) {
    const std::string plain = WithoutBlanks(point["name"]);
    std::string name = plain;
    for (int number = 2; !names.insert(name).second; ++number) name = plain + "_" + std::to_string(number);
    std::string place;
    for (const char* axis : {"x", "y", "z"}) place.append(Fixed(point[axis].get<double>(), 4)).append(" ");
    if (point["marks"].empty()) text.append("# no marks yet: ").append(place).append(name).append("\n");
    for (const Json& mark : point["marks"]) {
      const std::string photo = photos.ShortName(mark["photo"]);
      if (std::any_of(photo.begin(), photo.end(), IsBlank)) text += "# a photo with blanks in its name: ";
      text += place;
      for (const Json& pixel : mark["pixel"]) text.append(Fixed(pixel.get<double>(), 2)).append(" ");
      text.append(photo).append(" ").append(name).append("\n");
    }
  }
  return text;
}

GcpList ReadGcpList(std::string_view text, const std::optional<geo::UtmZone>& zone, const MarkablePhotos& photos) {
  if (text.size() > kMaxListBytes) return {nullptr, "it is larger than 4 MiB"};
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  std::optional<Header> header;
  std::optional<ListReader> reader;
  while (!text.empty()) {
    const size_t end = std::min(text.find_first_of("\r\n"), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(text.size(), end + 1));
    const std::vector<std::string_view> words = Words(line);
    if (words.empty() || words[0].starts_with('#')) continue;
    if (reader) {
      reader->Read(words);
      continue;
    }
    header = HeaderOf(std::string(line));
    if (header->kind == Header::Kind::kUnknown) return {nullptr, "its first line is none of the coordinate systems that the viewer can convert"};
    if ((header->kind == Header::Kind::kLocal) != !zone) {
      return {nullptr, zone ? "it has local coordinates, but the project has a geo-reference"
                            : "the project has no geo-reference, so its points must be LOCAL"};
    }
    reader.emplace(*header, zone, photos);
  }
  if (!reader) return {nullptr, "it is empty"};
  const auto crs = CrsNameOf(zone.has_value(), zone.value_or(geo::UtmZone()));
  return {reader->Take(crs ? Json(*crs) : Json(nullptr)), ""};
}

}  // namespace skyquilt::viewer
