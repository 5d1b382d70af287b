#include "core/base/checked_json.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

namespace skyquilt::base {
namespace {

constexpr int kMaxDepth = 32;
constexpr size_t kShownCharacters = 40;

}  // namespace

int NestingOf(std::string_view text) {
  int depth = 0, deepest = 0;
  for (size_t i = 0; i < text.size();) {
    const char c = text[i];
    if (c == '[' || c == '{') deepest = std::max(deepest, ++depth);
    if (c == ']' || c == '}') --depth;
    i = c == '"' ? EndOfText(text, i) : i + 1;
  }
  return deepest;
}

nlohmann::json ParseDocument(std::string_view text, RepeatedKeys repeated) {
  using Event = nlohmann::json::parse_event_t;
  if (NestingOf(text) > kMaxDepth) throw Refused("its lists and objects are nested too deeply");
  std::vector<std::set<std::string>> keys;  // of the objects that are open
  std::string twice;
  const auto check = [&](int /*depth*/, Event event, nlohmann::json& parsed) {
    if (event == Event::object_start) keys.emplace_back();
    if (event == Event::object_end) keys.pop_back();
    if (event == Event::key && !keys.back().insert(parsed.get<std::string>()).second) twice = parsed.get<std::string>();
    return true;
  };
  nlohmann::json json = repeated == RepeatedKeys::kRefused ? nlohmann::json::parse(text, check, false) : nlohmann::json::parse(text, nullptr, false);
  if (json.is_discarded()) throw Refused("", "is not valid JSON");
  if (!twice.empty()) throw Refused("the key \"" + ShownStart(twice) + "\" occurs twice");
  return json;
}

size_t EndOfText(std::string_view document, size_t begin) {
  size_t at = begin + 1;
  while (at < document.size() && document[at] != '"') at += document[at] == '\\' ? 2 : 1;
  return std::min(at + 1, document.size());
}

size_t CharactersIn(std::string_view utf8) {
  // All bytes but those that continue a character.
  return static_cast<size_t>(std::count_if(utf8.begin(), utf8.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

bool IsControl(char c) {
  return static_cast<unsigned char>(c) < ' ' || c == '\x7F';
}

std::string ShownStart(std::string_view text) {
  std::string shown(text.substr(0, kShownCharacters));
  std::replace_if(
      shown.begin(), shown.end(), [](char c) { return c < ' ' || c > '~' || c == '"' || c == '\\'; }, '?');
  return shown + (text.size() > kShownCharacters ? "..." : "");
}

double NumberIn(const nlohmann::json& json, const std::string& key, double otherwise) {
  if (!json.is_object()) return otherwise;
  const auto at = json.find(key);
  return at != json.end() && at->is_number() ? at->get<double>() : otherwise;
}

}  // namespace skyquilt::base
