#include "core/config/range.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <utility>

#include "core/base/errors.h"

namespace skyquilt::config {
namespace {

constexpr double kNoLimit = std::numeric_limits<double>::infinity();

std::string NumberText(double value) {
  // Writes 4096, not 4.096e+03.
  std::array<char, 400> buffer;
  const bool plain = value == 0.0 || (std::abs(value) >= 1e-4 && std::abs(value) < 1e7);
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, plain ? std::chars_format::fixed : std::chars_format::general);
  return std::string(buffer.data(), end.ptr);
}

std::string Alternatives(const std::vector<std::string>& words) {
  std::string text;
  for (size_t i = 0; i < words.size(); ++i) {
    if (i > 0) text += i + 1 == words.size() ? " or " : ", ";
    text += words[i];
  }
  return text;
}

}  // namespace

Range::Range(double min, double max) : kind_(Kind::kNumbers), min_(min), max_(max) {
  SKYQUILT_CHECK(min <= max, "the minimum of a range is above its maximum");
}

Range Range::AtLeast(double min) {
  return {min, kNoLimit};
}

Range Range::OneOf(std::initializer_list<const char*> texts) {
  return OneOf(std::vector<std::string>(texts.begin(), texts.end()));
}

Range Range::OneOf(std::vector<std::string> texts) {
  Range range;
  range.kind_ = Kind::kTexts;
  range.choices_ = std::move(texts);
  return range;
}

Range Range::OneOf(std::initializer_list<double> numbers) {
  Range range;
  range.kind_ = Kind::kNumbers;
  range.min_ = kNoLimit;  // nothing between the choices
  range.max_ = -kNoLimit;
  range.special_ = numbers;
  return range;
}

Range Range::Or(double special) const {
  Range wider = *this;
  wider.special_.push_back(special);
  return wider;
}

Range Range::OrWord(std::string word, double special) const {
  Range wider = *this;
  wider.words_.emplace_back(std::move(word), special);
  return wider;
}

Range Range::OrNegative() const {
  Range wider = *this;
  wider.or_negative_ = true;
  return wider;
}

Range Range::MultipleOf(int step) const {
  Range narrower = *this;
  narrower.step_ = step;
  return narrower;
}

bool Range::Contains(double value) const {
  if (kind_ == Kind::kAnything || WordFor(value)) return true;
  if (kind_ == Kind::kTexts || !std::isfinite(value)) return false;
  if (std::find(special_.begin(), special_.end(), value) != special_.end() || (or_negative_ && value < 0.0)) return true;
  return value >= min_ && value <= max_ && (step_ == 0 || std::fmod(value, step_) == 0.0);
}

bool Range::Contains(const std::string& text) const {
  return kind_ == Kind::kAnything || std::find(choices_.begin(), choices_.end(), text) != choices_.end();
}

std::optional<double> Range::NumberOf(const std::string& word) const {
  const auto found = std::find_if(words_.begin(), words_.end(), [&word](const auto& one) { return one.first == word; });
  return found == words_.end() ? std::nullopt : std::optional(found->second);
}

std::optional<std::string> Range::WordFor(double number) const {
  const auto found = std::find_if(words_.begin(), words_.end(), [number](const auto& one) { return one.second == number; });
  return found == words_.end() ? std::nullopt : std::optional(found->first);
}

std::string Range::Text() const {
  if (kind_ == Kind::kAnything) return "";
  if (kind_ == Kind::kTexts) return Alternatives(choices_);
  std::vector<std::string> words;
  for (const auto& [word, number] : words_) words.push_back(word);
  for (const double special : special_) words.push_back(NumberText(special));
  if (or_negative_) words.emplace_back("negative");
  if (min_ <= max_) {
    words.push_back(NumberText(min_) + (max_ == kNoLimit ? " or more" : " to " + NumberText(max_)));
    if (step_ != 0) words.back() += " in steps of " + std::to_string(step_);
  }
  return Alternatives(words);
}

}  // namespace skyquilt::config
