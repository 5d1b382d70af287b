#include "prepare/models/json_document.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/checked_json.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"

namespace skyquilt::prepare::models {
namespace {

using Offsets = std::unordered_map<const nlohmann::json*, size_t>;

// Follows the text and the values read from it side by side until it meets one value: the parser does not keep positions. The text is valid JSON, and
// not nested deeply.
class JsonLocator {
 public:
  // With `offsets` the positions of all values on the way are kept there.
  JsonLocator(std::string_view text, const nlohmann::json* target, Offsets* offsets = nullptr) : text_(text), target_(target), offsets_(offsets) {}

  // False when the value is not there. `node`: what was read at this place; null where a repeated key hides it.
  bool Walk(const nlohmann::json* node, const std::string& path) {
    SkipSpace();
    if (offsets_ != nullptr && node != nullptr) offsets_->emplace(node, at_);
    if (target_ != nullptr && node == target_) {
      path_ = path;
      return true;
    }
    const char c = Peek();
    if (c == '{') return WalkObject(node != nullptr && node->is_object() ? node : nullptr, path);
    if (c == '[') return WalkList(node != nullptr && node->is_array() ? node : nullptr, path);
    if (c == '"') {
      SkipString();
    } else {
      while (at_ < text_.size() && std::string_view(",]} \t\r\n").find(Peek()) == std::string_view::npos) ++at_;
    }
    return false;
  }
  size_t offset() const { return at_; }
  const std::string& path() const { return path_; }

 private:
  char Peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }
  void SkipSpace() { at_ = std::min(text_.find_first_not_of(" \t\r\n", at_), text_.size()); }
  std::string SkipString() {
    const size_t begin = at_;
    at_ = base::EndOfText(text_, begin);
    const nlohmann::json value = base::TryParseJson(text_.substr(begin, at_ - begin));
    return value.is_string() ? value.get<std::string>() : std::string();
  }
  // After a member; true at the end of the list or object.
  bool Ends() {
    SkipSpace();
    return at_ >= text_.size() || text_[at_++] != ',';
  }
  bool WalkObject(const nlohmann::json* node, const std::string& path) {
    ++at_;
    SkipSpace();
    if (Peek() == '}') {
      ++at_;
      return false;
    }
    do {
      SkipSpace();
      const std::string key = SkipString();
      SkipSpace();
      ++at_;  // colon
      const auto child = node == nullptr ? nlohmann::json::const_iterator() : node->find(key);
      const bool known = node != nullptr && child != node->end();
      if (Walk(known ? &*child : nullptr, path.empty() ? key : path + "." + key)) return true;
    } while (!Ends());
    return false;
  }
  bool WalkList(const nlohmann::json* node, const std::string& path) {
    ++at_;
    SkipSpace();
    if (Peek() == ']') {
      ++at_;
      return false;
    }
    size_t index = 0;
    do {
      const bool known = node != nullptr && index < node->size();
      if (Walk(known ? &(*node)[index] : nullptr, path + "[" + std::to_string(index) + "]")) return true;
      ++index;
    } while (!Ends());
    return false;
  }

  std::string_view text_;
  const nlohmann::json* target_;
  Offsets* offsets_;
  size_t at_ = 0;
  std::string path_;
};

// For a message: long lists are cut off.
std::string ShownJson(const nlohmann::json& value) {
  std::string text = value.is_structured() ? value.type_name() : base::JsonText(value);
  if (text.size() > 60) text = text.substr(0, 57) + "...";
  return text;
}

// Python's json writes these, which are not JSON; and numbers of as many bytes that JsonValue::Number refuses.
constexpr std::array<std::pair<std::string_view, std::string_view>, 3> kNoNumbers = {
    {{"-Infinity", "-9.00e+99"}, {"Infinity", "9.00e+99"}, {"NaN", "9e9"}}};

// The text with such numbers in their place, so that all offsets stay; nothing when there are none.
std::optional<std::string> WithNumbers(const std::string& text) {
  std::optional<std::string> changed;
  for (size_t i = 0; i < text.size();) {
    if (text[i] == '"') {
      i = base::EndOfText(text, i);
      continue;
    }
    const auto no_number =
        std::find_if(kNoNumbers.begin(), kNoNumbers.end(), [&](const auto& one) { return text.compare(i, one.first.size(), one.first) == 0; });
    if (no_number == kNoNumbers.end()) {
      ++i;
      continue;
    }
    if (!changed) changed = text;
    changed->replace(i, no_number->second.size(), no_number->second);
    i += no_number->first.size();
  }
  return changed;
}

}  // namespace

size_t LineOf(std::string_view text, size_t offset) {
  const std::string_view before = text.substr(0, offset);
  return 1 + static_cast<size_t>(std::count(before.begin(), before.end(), '\n'));
}

JsonDocument::JsonDocument(const std::filesystem::path& file, const std::string& fix) : file_(file), fix_(fix), text_(base::ReadFile(file)) {
  try {
    json_ = base::ParseDocument(text_);
    return;
  } catch (const base::Refused& refused) {
    if (std::string(refused.what()).find("nested") != std::string::npos) throw base::InputError(file, refused.what(), fix);
  }
  if (const std::optional<std::string> text = WithNumbers(text_)) {
    json_ = base::TryParseJson(*text);
    has_nan_ = !json_.is_discarded();
    if (has_nan_) return;
  }
  try {
    json_ = base::ParseJson(text_);
  } catch (const nlohmann::json::parse_error& error) {
    const size_t offset = std::min(error.byte == 0 ? 0 : error.byte - 1, text_.size());
    const std::string found = offset >= text_.size() ? ": the file ends too early" : "";
    throw base::InputError(file, "line " + std::to_string(LineOf(text_, offset)) + ": is not JSON" + found, fix);
  } catch (const nlohmann::json::exception&) {
    throw base::InputError(file, "has a number that is too large", fix);
  }
}

void JsonDocument::Fail(const nlohmann::json& value, const std::string& found, const std::string& fix) const {
  JsonLocator locator(text_, &value);
  std::string where;
  if (locator.Walk(&json_, "")) {
    where = "line " + std::to_string(LineOf(text_, locator.offset())) + ": " + (locator.path().empty() ? "the file" : locator.path()) + " ";
  }
  throw base::InputError(file_, where + found, fix.empty() ? fix_ : fix);
}

int JsonDocument::LineOfValue(const nlohmann::json& value) const {
  if (offsets_.empty()) JsonLocator(text_, nullptr, &offsets_).Walk(&json_, "");
  const auto found = offsets_.find(&value);
  return found == offsets_.end() ? 0 : static_cast<int>(LineOf(text_, found->second));
}

std::string JsonDocument::Shown(const nlohmann::json& value) const {
  if (has_nan_) {
    JsonLocator locator(text_, &value);
    if (locator.Walk(&json_, "")) {
      for (const auto& [word, number] : kNoNumbers) {
        if (text_.compare(locator.offset(), word.size(), word) == 0) return std::string(word);
      }
    }
  }
  return ShownJson(value);
}

std::string JsonValue::Shown() const {
  return document_->Shown(*value_);
}

int JsonValue::Line() const {
  return document_->LineOfValue(*value_);
}

void JsonValue::Fail(const std::string& found, const std::string& fix) const {
  document_->Fail(*value_, found, fix);
}

JsonValue JsonValue::At(const std::string& key) const {
  const std::optional<JsonValue> value = Find(key);
  if (!value) Fail("has no \"" + key + "\"");
  return *value;
}

std::optional<JsonValue> JsonValue::Find(const std::string& key) const {
  if (!value_->is_object()) Fail("must be an object in braces, not " + Shown());
  const auto found = value_->find(key);
  if (found == value_->end() || found->is_null()) return std::nullopt;
  return JsonValue(*document_, *found);
}

JsonValue JsonValue::At(size_t index) const {
  if (index >= Size()) Fail("has only " + std::to_string(Size()) + " entries");
  return {*document_, (*value_)[index]};
}

size_t JsonValue::Size() const {
  if (!value_->is_array()) Fail("must be a list in brackets, not " + Shown());
  return value_->size();
}

std::vector<std::pair<std::string, JsonValue>> JsonValue::Members() const {
  if (!value_->is_object()) Fail("must be an object in braces, not " + Shown());
  std::vector<std::pair<std::string, JsonValue>> members;
  members.reserve(value_->size());
  for (const auto& [key, member] : value_->items()) members.emplace_back(key, JsonValue(*document_, member));
  return members;
}

double JsonValue::Number() const {
  if (!value_->is_number() || !(std::abs(value_->get<double>()) <= 1e9)) Fail("must be a number from -1e9 to 1e9, not " + Shown());
  return value_->get<double>();
}

double JsonValue::Positive() const {
  const double number = Number();
  if (!(number > 0.0)) Fail("must be more than 0, not " + Shown());
  return number;
}

int JsonValue::Pixels() const {
  const double number = Number();
  if (!(number >= 1.0 && number <= 1e6) || number != std::floor(number)) Fail("must be a whole number of pixels, not " + Shown());
  return static_cast<int>(number);
}

uint64_t JsonValue::Id() const {
  if (value_->is_number_unsigned()) return value_->get<uint64_t>();
  // Some programs write the upper half of the unsigned numbers as negative ones.
  if (value_->is_number_integer()) return static_cast<uint64_t>(value_->get<int64_t>());
  Fail("must be a whole number, not " + Shown());
}

bool JsonValue::Boolean() const {
  if (!value_->is_boolean()) Fail("must be true or false, not " + Shown());
  return value_->get<bool>();
}

std::string JsonValue::Text() const {
  const bool good = value_->is_string() && !value_->get_ref<const std::string&>().empty() && value_->get_ref<const std::string&>().size() <= 4096;
  if (!good) Fail("must be a text, not " + Shown());
  const auto& text = value_->get_ref<const std::string&>();
  if (std::any_of(text.begin(), text.end(), base::IsControl)) Fail("must be one line of text");
  return text;
}

std::vector<double> JsonValue::Numbers(size_t count) const {
  if (Size() != count) Fail("must have " + std::to_string(count) + " numbers, not " + std::to_string(Size()));
  std::vector<double> numbers;
  numbers.reserve(count);
  for (size_t i = 0; i < count; ++i) numbers.push_back(At(i).Number());
  return numbers;
}

Eigen::Vector3d JsonValue::Vector3() const {
  const std::vector<double> numbers = Numbers(3);
  return {numbers[0], numbers[1], numbers[2]};
}

double JsonValue::NumberOr0(const std::string& key) const {
  const std::optional<JsonValue> value = Find(key);
  return value ? value->Number() : 0.0;
}

}  // namespace skyquilt::prepare::models
