#include "viewer/protocol/json_fields.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/base/checked_json.h"
#include "viewer/protocol/messages.h"

namespace skyquilt::viewer {
namespace {

using nlohmann::json;

constexpr int kMaxDepth = 4;
constexpr size_t kQuotedCharacters = 40;

// Counted before parsing, so that a parser's use of memory for nested values need not be trusted.
bool IsShallow(std::string_view text) {
  int depth = 0;
  for (size_t i = 0; i < text.size();) {
    const char c = text[i];
    if ((c == '{' || c == '[') && ++depth > kMaxDepth) return false;
    if (c == '}' || c == ']') --depth;
    i = c == '"' ? base::EndOfText(text, i) : i + 1;
  }
  return true;
}

std::string NumberText(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

std::string RangeText(double min, double max) {
  return "from " + NumberText(min) + " to " + NumberText(max);
}

// Nothing but finite numbers within the limits.
bool ReadNumber(const json& value, double min, double max, double* out) {
  if (!value.is_number()) return false;
  *out = value.get<double>();
  return *out >= min && *out <= max;
}

}  // namespace

std::string Quoted(std::string_view text) {
  std::string quoted(text.substr(0, kQuotedCharacters));
  std::replace_if(
      quoted.begin(), quoted.end(), [](char c) { return c < 0x20 || c > 0x7E || c == '"' || c == '\\'; }, '?');
  return "\"" + quoted + "\"" + (text.size() > kQuotedCharacters ? "..." : "");
}

struct JsonFields::Object {
  json value;

  const json* Find(std::string_view key) const {
    const auto at = value.find(key);
    return at == value.end() ? nullptr : &*at;
  }
};

JsonFields::JsonFields(std::string_view text, size_t max_bytes) : object_(std::make_unique<Object>()) {
  if (text.size() > max_bytes) throw BadMessage("a message has at most " + std::to_string(max_bytes) + " bytes");
  if (!IsShallow(text)) throw BadMessage("a message has at most " + std::to_string(kMaxDepth) + " levels of brackets");
  std::set<std::string> keys;
  std::string twice;
  // A repeated key would silently replace the first.
  const auto check = [&](int depth, json::parse_event_t event, json& parsed) {
    if (event == json::parse_event_t::key && depth == 1 && !keys.insert(parsed.get<std::string>()).second) twice = Quoted(parsed.get<std::string>());
    return true;
  };
  object_->value = json::parse(text.begin(), text.end(), check, false);
  if (object_->value.is_discarded()) throw BadMessage("the message is not valid JSON");
  if (!object_->value.is_object()) throw BadMessage("a message is a JSON object");
  if (!twice.empty()) throw BadMessage("the key " + twice + " occurs twice");
}

JsonFields::~JsonFields() = default;

bool JsonFields::Has(const char* key) const {
  return object_->Find(key) != nullptr;
}

std::string JsonFields::Text(const char* key) {
  taken_.insert(key);
  const json* value = object_->Find(key);
  if (value == nullptr || !value->is_string()) Refuse(key, "must be a text");
  std::string text = value->get<std::string>();
  if (type_.empty() && std::string_view(key) == "type" && text.size() <= kQuotedCharacters) type_ = text;
  return text;
}

size_t JsonFields::OneOf(const char* key, std::initializer_list<std::string_view> allowed) {
  taken_.insert(key);
  const json* value = object_->Find(key);
  if (value != nullptr && value->is_string()) {
    const auto at = std::find(allowed.begin(), allowed.end(), value->get_ref<const std::string&>());
    if (at != allowed.end()) return static_cast<size_t>(at - allowed.begin());
  }
  std::string names;
  for (const std::string_view name : allowed) names += (names.empty() ? "" : ", ") + std::string(name);
  Refuse(key, "must be one of " + names);
}

int64_t JsonFields::Integer(const char* key, int64_t min, int64_t max) {
  taken_.insert(key);
  const json* value = object_->Find(key);
  if (value != nullptr && value->is_number_integer()) {
    // Numbers from 2^63 on are kept as unsigned ones.
    const bool fits = !value->is_number_unsigned() || value->get<uint64_t>() <= uint64_t{std::numeric_limits<int64_t>::max()};
    if (fits && value->get<int64_t>() >= min && value->get<int64_t>() <= max) return value->get<int64_t>();
  }
  Refuse(key, "must be a whole number from " + std::to_string(min) + " to " + std::to_string(max));
}

uint32_t JsonFields::U32(const char* key) {
  return static_cast<uint32_t>(Integer(key, 0, std::numeric_limits<uint32_t>::max()));
}

double JsonFields::Number(const char* key, double min, double max) {
  taken_.insert(key);
  const json* value = object_->Find(key);
  double number = 0.0;
  if (value == nullptr || !ReadNumber(*value, min, max, &number)) Refuse(key, "must be a number " + RangeText(min, max));
  return number;
}

void JsonFields::Numbers(const char* key, double limit, std::span<double> out) {
  taken_.insert(key);
  const json* value = object_->Find(key);
  bool good = value != nullptr && value->is_array() && value->size() == out.size();
  for (size_t i = 0; good && i < out.size(); ++i) good = ReadNumber((*value)[i], -limit, limit, &out[i]);
  if (!good) Refuse(key, "must be " + std::to_string(out.size()) + " numbers " + RangeText(-limit, limit));
}

std::vector<Eigen::Vector2d> JsonFields::Points(const char* key, int min_count, int max_count, double limit) {
  taken_.insert(key);
  const json* value = object_->Find(key);
  std::vector<Eigen::Vector2d> points;
  bool good =
      value != nullptr && value->is_array() && value->size() >= static_cast<size_t>(min_count) && value->size() <= static_cast<size_t>(max_count);
  for (size_t i = 0; good && i < value->size(); ++i) {
    const json& pair = (*value)[i];
    Eigen::Vector2d point;
    good = pair.is_array() && pair.size() == 2 && ReadNumber(pair[0], -limit, limit, &point.x()) && ReadNumber(pair[1], -limit, limit, &point.y());
    points.push_back(point);
  }
  if (!good) {
    Refuse(key, "must be " + std::to_string(min_count) + " to " + std::to_string(max_count) + " pairs of numbers " + RangeText(-limit, limit));
  }
  return points;
}

void JsonFields::RefuseOthers() const {
  for (const auto& [key, value] : object_->value.items()) {
    if (!taken_.contains(key)) throw BadMessage((type_.empty() ? "" : type_ + ": ") + "the key " + Quoted(key) + " is not allowed here");
  }
}

void JsonFields::Refuse(const char* key, const std::string& why) const {
  throw BadMessage((type_.empty() ? "" : type_ + ".") + key + ": " + why);
}

}  // namespace skyquilt::viewer
