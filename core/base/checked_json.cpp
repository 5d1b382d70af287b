#include "core/base/checked_json.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace skyquilt::base {
namespace {

constexpr int kMaxDepth = 32;

// How deep lists and objects are nested, without following them.
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

}  // namespace

nlohmann::json ParseDocument(std::string_view text) {
  if (NestingOf(text) > kMaxDepth) throw Refused("its lists and objects are nested too deeply");
  nlohmann::json json = nlohmann::json::parse(text, nullptr, false);
  if (json.is_discarded()) throw Refused("it is not JSON");
  return json;
}

void RequireNumber(const nlohmann::json& value, const std::string& where) {
  if (!value.is_number() || !(std::abs(value.get<double>()) <= 1e9)) throw Refused(where + " must be a number from -1e9 to 1e9");
}

void RequireLine(const nlohmann::json& value, size_t max_bytes, const std::string& where) {
  const bool good = value.is_string() && !value.get_ref<const std::string&>().empty() && value.get_ref<const std::string&>().size() <= max_bytes;
  if (!good) throw Refused(where + " must be a text of 1 to " + std::to_string(max_bytes) + " bytes");
  const auto& text = value.get_ref<const std::string&>();
  if (std::any_of(text.begin(), text.end(), IsControl)) throw Refused(where + " must be one line");
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

}  // namespace skyquilt::base
