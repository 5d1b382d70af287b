// What values an option may take. Stands once, beside the option: help, check and message are written from it.
#pragma once

#include <initializer_list>
#include <string>
#include <vector>

namespace skyquilt::config {

class Range {
 public:
  Range() = default;              // anything of the option's type
  Range(double min, double max);  // numbers from min to max, both included; of a list: every number in it. Neither NaN nor infinity
  static Range AtLeast(double min);
  static Range OneOf(std::initializer_list<const char*> texts);
  static Range OneOf(std::vector<std::string> texts);
  static Range OneOf(std::initializer_list<double> numbers);

  // The same, and this number too: Range{32, 8192}.Or(0) for an option where 0 means "as it is".
  Range Or(double special) const;
  // The same, and every negative number too.
  Range OrNegative() const;
  // Of the numbers only multiples of this one.
  Range MultipleOf(int step) const;

  bool Contains(double value) const;
  bool Contains(const std::string& text) const;
  // For people: "0.25 to 16", "0 or 32 to 8192", "4 to 256 in steps of 4", "fp32, bf16 or fp16"; empty when anything goes.
  std::string Text() const;

 private:
  enum class Kind { kAnything, kNumbers, kTexts };
  Kind kind_ = Kind::kAnything;
  double min_ = 0.0;
  double max_ = 0.0;
  std::vector<double> special_;  // allowed besides
  bool or_negative_ = false;
  int step_ = 0;  // 0: all numbers
  std::vector<std::string> choices_;
};

}  // namespace skyquilt::config
