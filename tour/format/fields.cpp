#include "tour/format/fields.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/json_text.h"

namespace skyquilt::tour {
namespace {

using Json = nlohmann::json;

constexpr size_t kMaxIdCharacters = 40;
constexpr size_t kMaxLineCharacters = 200;
constexpr double kMaxCoordinate = 1e9;
constexpr const char* kIdForm = "a name of 1 to 40 letters, digits, - or _";

// 200, 0.0001.
std::string Shown(double value) {
  return value == std::floor(value) ? std::to_string(static_cast<int64_t>(value)) : base::JsonText(Json(value));
}

// The names of members come from outside: shown short and in one line.
std::string ShownKey(const std::string& key) {
  std::string shown;
  for (const char c : key.substr(0, 40)) shown += c >= ' ' && c <= '~' ? c : '?';
  return shown;
}

bool IsLine(const Json& value, size_t min, size_t max) {
  if (!value.is_string()) return false;
  const auto& text = value.get_ref<const std::string&>();
  const size_t n = base::CharactersIn(text);
  // Unicode's separators of lines and paragraphs (U+2028 and U+2029), too.
  const bool separated = text.find("\xE2\x80\xA8") != std::string::npos || text.find("\xE2\x80\xA9") != std::string::npos;
  return n >= min && n <= max && !separated && std::none_of(text.begin(), text.end(), base::IsControl);
}

std::string LineRule(size_t min, size_t max) {
  return "must be one line of " + std::to_string(min) + " to " + std::to_string(max) + " characters";
}

}  // namespace

bool IsId(std::string_view text) {
  const auto is_good = [](char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-' || c == '_'; };
  return !text.empty() && text.size() <= kMaxIdCharacters && std::all_of(text.begin(), text.end(), is_good);
}

Fields::Fields(const Json& object, std::string where, Reading* reading) : object_(object), where_(std::move(where)), reading_(reading) {
  if (!object_.is_object()) throw base::Refused((where_.empty() ? "it" : where_) + " must be an object");
}

std::string Fields::Path(const char* key) const {
  return where_.empty() ? key : where_ + "." + key;
}

void Fields::Refuse(const char* key, const std::string& rule) const {
  throw base::Refused(Path(key) + " " + rule);
}

const Json* Fields::Find(const char* key) {
  taken_.insert(key);
  const auto at = object_.find(key);
  return at == object_.end() ? nullptr : &*at;
}

const Json* Fields::FindUnlessNull(const char* key) {
  const Json* value = Find(key);
  return value == nullptr || value->is_null() ? nullptr : value;
}

const Json& Fields::Need(const char* key) {
  const Json* value = Find(key);
  if (value == nullptr) Refuse(key, "is missing");
  return *value;
}

std::string Fields::Id(const char* key) {
  const Json& value = Need(key);
  if (!value.is_string() || !IsId(value.get_ref<const std::string&>())) Refuse(key, std::string("must be ") + kIdForm);
  return value.get<std::string>();
}

std::optional<std::string> Fields::OptionalId(const char* key) {
  const Json* value = FindUnlessNull(key);
  if (value == nullptr) return {};
  if (!value->is_string() || !IsId(value->get_ref<const std::string&>())) Refuse(key, std::string("must be null or ") + kIdForm);
  return value->get<std::string>();
}

std::string Fields::Line(const char* key, size_t max) {
  const Json& value = Need(key);
  if (!IsLine(value, 1, max)) Refuse(key, LineRule(1, max));
  return value.get<std::string>();
}

std::string Fields::LineOrEmpty(const char* key, size_t max) {
  const Json* value = Find(key);
  if (value == nullptr) return "";
  if (!IsLine(*value, 0, max)) Refuse(key, LineRule(0, max));
  return value->get<std::string>();
}

std::string Fields::Text(const char* key, size_t max) {
  const Json* value = Find(key);
  if (value == nullptr) return "";
  const auto allowed = [](char c) { return !base::IsControl(c) || c == '\n' || c == '\r' || c == '\t'; };
  const bool good = value->is_string() && base::CharactersIn(value->get_ref<const std::string&>()) <= max &&
                    std::all_of(value->get_ref<const std::string&>().begin(), value->get_ref<const std::string&>().end(), allowed);
  if (!good) Refuse(key, "must be a text of at most " + std::to_string(max) + " characters, without control characters but line breaks and tabs");
  return value->get<std::string>();
}

double Fields::Number(const char* key, double min, double max) {
  const Json& value = Need(key);
  if (!value.is_number() || !(value.get<double>() >= min && value.get<double>() <= max)) {
    Refuse(key, "must be a number from " + Shown(min) + " to " + Shown(max));
  }
  return value.get<double>();
}

double Fields::NumberOrZero(const char* key, double max) {
  return Find(key) == nullptr ? 0.0 : Number(key, 0.0, max);
}

Eigen::Vector3d Fields::Position(const char* key) {
  const Json& value = Need(key);
  const auto is_coordinate = [](const Json& number) { return number.is_number() && std::abs(number.get<double>()) <= kMaxCoordinate; };
  if (!value.is_array() || value.size() != 3 || !std::all_of(value.begin(), value.end(), is_coordinate)) {
    Refuse(key, "must be 3 numbers from -1e9 to 1e9");
  }
  return {value[0].get<double>(), value[1].get<double>(), value[2].get<double>()};
}

bool Fields::Flag(const char* key) {
  const Json& value = Need(key);
  if (!value.is_boolean()) Refuse(key, "must be true or false");
  return value.get<bool>();
}

const Json* Fields::List(const char* key, size_t max) {
  const Json* value = Find(key);
  if (value != nullptr && (!value->is_array() || value->size() > max)) Refuse(key, "must be a list of at most " + std::to_string(max));
  return value;
}

std::vector<std::string> Fields::Lines(const char* key, size_t max) {
  std::vector<std::string> lines;
  const Json* list = List(key, max);
  if (list == nullptr) return lines;
  for (const Json& value : *list) {
    if (!IsLine(value, 1, kMaxLineCharacters)) Refuse(key, "must be a list of lines of 1 to 200 characters");
    lines.push_back(value.get<std::string>());
  }
  return lines;
}

std::vector<std::string> Fields::Ids(const char* key, size_t max) {
  std::vector<std::string> ids = Lines(key, max);
  if (!std::all_of(ids.begin(), ids.end(), IsId)) Refuse(key, "must be a list of names of 1 to 40 letters, digits, - or _");
  return ids;
}

void Fields::End() {
  for (const auto& [key, ignored] : object_.items()) {
    if (taken_.contains(key)) continue;
    const std::string path = Path(ShownKey(key).c_str());
    if (reading_->strict) throw base::Refused(path + " is not known: leave it out");
    // One sentence about the other version stands for all its new members.
    if (!reading_->other_version) reading_->missing.push_back(path + " is not known and is left out.");
  }
}

}  // namespace skyquilt::tour
