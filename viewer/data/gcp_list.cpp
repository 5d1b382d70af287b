#include "viewer/data/gcp_list.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

namespace skyquilt::viewer {
namespace {

using Json = nlohmann::json;

std::string WithoutBlanks(std::string name) {
  for (char& c : name) {
    if (static_cast<unsigned char>(c) <= ' ') c = '_';
  }
  return name;
}

std::string Fixed(double value, int digits) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*f", digits, value);
  return text.data();
}

std::vector<std::string_view> Words(std::string_view line) {
  std::vector<std::string_view> words;
  size_t at = 0;
  while (at < line.size()) {
    const size_t begin = line.find_first_not_of(" \t\r", at);
    if (begin == std::string_view::npos) break;
    at = std::min(line.find_first_of(" \t\r", begin), line.size());
    words.push_back(line.substr(begin, at - begin));
  }
  return words;
}

std::optional<double> Number(std::string_view word) {
  double value = 0.0;
  if (word.starts_with('+')) word.remove_prefix(1);
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size() || !(value > -1e12 && value < 1e12)) return {};
  return value;
}

// The point of this name, or without a name at this place; made when there is none.
Json& PointOf(Json& points, const std::string& name, const std::array<double, 3>& place) {
  for (Json& point : points) {
    const bool same = name.empty() ? point["x"] == place[0] && point["y"] == place[1] && point["z"] == place[2] : point["name"] == name;
    if (same) return point;
  }
  std::string given = name;
  for (size_t number = points.size() + 1; given.empty(); ++number) {
    const std::string candidate = "GCP_" + std::to_string(number);
    if (std::none_of(points.begin(), points.end(), [&](const Json& point) { return point["name"] == candidate; })) given = candidate;
  }
  points.push_back({{"name", given}, {"x", place[0]}, {"y", place[1]}, {"z", place[2]}, {"marks", Json::array()}});
  return points.back();
}

}  // namespace

std::string GcpListText(const Json& gcp) {
  std::string text = gcp["crs"].is_string() ? gcp["crs"].get<std::string>() : "LOCAL";
  text += "\n";
  for (const Json& point : gcp["points"]) {
    const std::string name = WithoutBlanks(point["name"]);
    std::string place;
    for (const char* axis : {"x", "y", "z"}) place += Fixed(point[axis].get<double>(), 4) + " ";
    if (point["marks"].empty()) text += "# no marks yet: " + place + name + "\n";
    for (const Json& mark : point["marks"]) {
      text += place + Fixed(mark["pixel"][0].get<double>(), 2) + " " + Fixed(mark["pixel"][1].get<double>(), 2) + " " + WithoutBlanks(mark["photo"]) +
              " " + name + "\n";
    }
  }
  return text;
}

Json ReadGcpList(std::string_view text) {
  Json gcp = {{"crs", nullptr}, {"points", Json::array()}};
  int skipped = 0;
  bool first = true;
  while (!text.empty()) {
    const size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(text.size(), end + 1));
    const std::vector<std::string_view> words = Words(line);
    if (words.empty() || words[0].starts_with('#')) continue;
    if (first) {
      first = false;
      const size_t begin = line.find_first_not_of(" \t");
      const size_t last = line.find_last_not_of(" \t\r");
      const std::string crs(line.substr(begin, last - begin + 1));
      if (crs != "LOCAL") gcp["crs"] = crs;
      continue;
    }
    std::array<std::optional<double>, 5> numbers;
    for (size_t i = 0; i < numbers.size() && i < words.size(); ++i) numbers[i] = Number(words[i]);
    if (words.size() < 6 || !std::all_of(numbers.begin(), numbers.end(), [](const auto& number) { return number.has_value(); })) {
      ++skipped;
      continue;
    }
    const std::string name(words.size() > 6 ? words[6] : std::string_view());
    Json& point = PointOf(gcp["points"], name, {*numbers[0], *numbers[1], *numbers[2]});
    point["marks"].push_back({{"photo", std::string(words[5])}, {"pixel", {*numbers[3], *numbers[4]}}});
  }
  if (skipped > 0) gcp["skipped"] = skipped;
  return gcp;
}

}  // namespace skyquilt::viewer
