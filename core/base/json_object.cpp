#include "core/base/json_object.h"

#include <algorithm>

#include "core/base/checked_json.h"

namespace skyquilt::base {
namespace {

using Json = nlohmann::json;

// Nothing but finite numbers within the limits.
bool ReadNumber(const Json& value, double limit, double* out) {
  if (!value.is_number()) return false;
  *out = value.get<double>();
  return *out >= -limit && *out <= limit;
}

bool ReadNumbers(const Json& list, double limit, std::span<double> out) {
  bool good = list.is_array() && list.size() == out.size();
  for (size_t i = 0; good && i < out.size(); ++i) good = ReadNumber(list[i], limit, &out[i]);
  return good;
}

bool IsLine(const Json& value, size_t min, size_t max) {
  if (!value.is_string()) return false;
  const auto& text = value.get_ref<const std::string&>();
  const size_t n = CharactersIn(text);
  // Unicode's separators of lines and paragraphs (U+2028 and U+2029), too.
  const bool separated = text.find("\xE2\x80\xA8") != std::string::npos || text.find("\xE2\x80\xA9") != std::string::npos;
  return n >= min && n <= max && !separated && std::none_of(text.begin(), text.end(), IsControl);
}

std::string LineRule(size_t min, size_t max) {
  return "must be one line of " + std::to_string(min) + " to " + std::to_string(max) + " characters";
}

}  // namespace

JsonObject::JsonObject(const JsonValue& object) : object_(object) {
  if (!object_.IsObject()) object_.Fail("must be an object");
}

std::optional<JsonValue> JsonObject::Find(const std::string& key) {
  taken_.insert(key);
  return object_.Member(key);
}

std::optional<JsonValue> JsonObject::FindUnlessNull(const std::string& key) {
  taken_.insert(key);
  return object_.Find(key);
}

JsonValue JsonObject::Need(const std::string& key) {
  std::optional<JsonValue> value = Find(key);
  if (!value) Refuse(key, "is missing");
  return *std::move(value);
}

std::string JsonObject::Line(const std::string& key, size_t max) {
  const JsonValue value = Need(key);
  if (!IsLine(value.json(), 1, max)) value.Fail(LineRule(1, max));
  return value.json().get<std::string>();
}

uint64_t JsonObject::Count(const std::string& key) {
  const JsonValue value = Need(key);
  if (!value.json().is_number_unsigned() || value.json().get<uint64_t>() == 0) value.Fail("must be a whole number above 0");
  return value.json().get<uint64_t>();
}

void JsonObject::Numbers(const std::string& key, double limit, std::span<double> out) {
  const JsonValue value = Need(key);
  if (!ReadNumbers(value.json(), limit, out)) value.Fail("must be " + std::to_string(out.size()) + " numbers " + RangeText(-limit, limit));
}

std::vector<std::array<double, 2>> JsonObject::Pairs(const std::string& key, size_t min_count, size_t max_count, double limit) {
  const JsonValue value = Need(key);
  const Json& list = value.json();
  bool good = list.is_array() && list.size() >= min_count && list.size() <= max_count;
  std::vector<std::array<double, 2>> pairs(good ? list.size() : 0);
  for (size_t i = 0; good && i < pairs.size(); ++i) good = ReadNumbers(list[i], limit, pairs[i]);
  if (!good)
    value.Fail("must be " + std::to_string(min_count) + " to " + std::to_string(max_count) + " pairs of numbers " + RangeText(-limit, limit));
  return pairs;
}

size_t JsonObject::OneOf(const std::string& key, std::initializer_list<std::string_view> allowed) {
  const JsonValue value = Need(key);
  if (value.json().is_string()) {
    const auto at = std::find(allowed.begin(), allowed.end(), value.json().get_ref<const std::string&>());
    if (at != allowed.end()) return static_cast<size_t>(at - allowed.begin());
  }
  std::string names;
  for (const std::string_view name : allowed) names += (names.empty() ? "" : ", ") + std::string(name);
  value.Fail("must be one of " + names);
}

std::string JsonObject::LineOrEmpty(const std::string& key, size_t max) {
  const std::optional<JsonValue> value = Find(key);
  if (!value) return "";
  if (!IsLine(value->json(), 0, max)) value->Fail(LineRule(0, max));
  return value->json().get<std::string>();
}

std::string JsonObject::Paragraphs(const std::string& key, size_t max) {
  const std::optional<JsonValue> value = Find(key);
  if (!value) return "";
  const auto allowed = [](char c) { return !IsControl(c) || c == '\n' || c == '\r' || c == '\t'; };
  const auto* text = value->json().get_ptr<const std::string*>();
  if (text == nullptr || CharactersIn(*text) > max || !std::all_of(text->begin(), text->end(), allowed)) {
    value->Fail("must be a text of at most " + std::to_string(max) + " characters, without control characters but line breaks and tabs");
  }
  return *text;
}

std::vector<JsonValue> JsonObject::List(const std::string& key, size_t max) {
  std::vector<JsonValue> values;
  const std::optional<JsonValue> list = Find(key);
  if (!list) return values;
  if (!list->json().is_array() || list->json().size() > max) list->Fail("must be a list of at most " + std::to_string(max));
  for (size_t i = 0; i < list->Size(); ++i) values.push_back(list->At(i));
  return values;
}

std::vector<std::string> JsonObject::Lines(const std::string& key, size_t max_count, size_t max) {
  std::vector<std::string> lines;
  for (const JsonValue& value : List(key, max_count)) {
    if (!IsLine(value.json(), 1, max)) Refuse(key, "must be a list of lines of 1 to " + std::to_string(max) + " characters");
    lines.push_back(value.json().get<std::string>());
  }
  return lines;
}

std::vector<std::string> JsonObject::Rest() const {
  std::vector<std::string> rest;
  for (const auto& [key, value] : object_.json().items()) {
    if (!taken_.contains(key)) rest.push_back(key);
  }
  return rest;
}

}  // namespace skyquilt::base
