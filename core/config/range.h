// The allowed values of an option. Written once, beside the option: its help text, its check and its error message all come from it.
#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace skyquilt::config {

class Range {
 public:
  Range() = default;              // any value of the option's type
  Range(double min, double max);  // numbers from min to max, both included, without NaN and infinity; for a list: each of its numbers
  static Range AtLeast(double min);
  static Range OneOf(std::initializer_list<const char*> texts);
  static Range OneOf(std::vector<std::string> texts);
  static Range OneOf(std::initializer_list<double> numbers);

  // Also allows this number: Range{32, 8192}.Or(0) for an option where 0 means "no change".
  Range Or(double special) const;
  // Also allows this word, which is read as `special` and written instead of it: Range{16, 65536}.OrWord("auto", -1). `special` itself is not read.
  Range OrWord(std::string word, double special) const;
  // Also allows every negative number, for options where it means "not set".
  Range OrNegative() const;
  // Allows only multiples of `step` between min and max.
  Range MultipleOf(int step) const;

  bool Contains(double value) const;
  bool Contains(const std::string& text) const;
  // The number that a word stands for, and the word for a number; empty where there is none.
  std::optional<double> NumberOf(const std::string& word) const;
  std::optional<std::string> WordFor(double number) const;
  // In words: "0.25 to 16", "0 or 32 to 8192", "4 to 256 in steps of 4", "fp32, bf16 or fp16"; empty when every value is allowed.
  std::string Text() const;

 private:
  enum class Kind { kAnything, kNumbers, kTexts };
  Kind kind_ = Kind::kAnything;
  double min_ = 0.0;
  double max_ = 0.0;
  std::vector<double> special_;  // allowed in addition
  std::vector<std::pair<std::string, double>> words_;
  bool or_negative_ = false;
  int step_ = 0;  // 0: all numbers
  std::vector<std::string> choices_;
};

}  // namespace skyquilt::config
