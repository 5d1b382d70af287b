#include "odm/option_table.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include "core/base/errors.h"
#include "core/base/json_text.h"
#include "core/base/text.h"

namespace skyquilt::odm {
namespace {

OptionKind KindNamed(const std::string& name) {
  if (name == "flag") return OptionKind::kFlag;
  if (name == "int") return OptionKind::kInt;
  if (name == "float") return OptionKind::kFloat;
  if (name == "choice") return OptionKind::kChoice;
  if (name == "text") return OptionKind::kText;
  if (name == "path") return OptionKind::kPath;
  SKYQUILT_CHECK(name == "json", "options.json: kind '" + name + "'");
  return OptionKind::kJson;
}

std::vector<OptionSpec> ReadOptions() {
  std::vector<OptionSpec> options;
  for (const nlohmann::json& entry : base::ParseJson(OptionsJson())) {
    OptionSpec option;
    option.name = entry.at("name").get<std::string>();
    option.short_name = entry.value("short", "");
    option.kind = KindNamed(entry.at("kind").get<std::string>());
    option.default_value = entry.value("default", "");
    if (entry.contains("choices")) option.choices = entry.at("choices").get<std::vector<std::string>>();
    option.domain = entry.value("domain", "");
    option.help = entry.at("help").get<std::string>();
    option.no_effect = entry.value("no_effect", "");
    option.refused = entry.value("refused", "");
    options.push_back(std::move(option));
  }
  return options;
}

// The whole text as a finite number.
std::optional<double> NumberOf(const std::string& text) {
  double value = 0.0;
  const char* end = text.data() + text.size();
  const std::from_chars_result read = std::from_chars(text.data(), end, value);
  if (read.ec != std::errc() || read.ptr != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

struct NumberRange {
  double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
  bool above_low = false;  // low itself is not allowed
};

NumberRange RangeOf(const std::string& domain) {
  NumberRange range;
  if (domain.starts_with("positive ")) range.low = 0.0;
  if (const size_t above = domain.find(" > "); above != std::string::npos) {
    range.low = NumberOf(domain.substr(above + 3)).value();
    range.above_low = true;
  }
  if (const size_t colon = domain.find(": "), between = domain.find(" <= x <= "); colon != std::string::npos && between != std::string::npos) {
    range.low = NumberOf(domain.substr(colon + 2, between - colon - 2)).value();
    range.high = NumberOf(domain.substr(between + 9)).value();
  }
  return range;
}

std::string NumberProblem(const OptionSpec& option, const std::string& text) {
  const std::optional<double> value = NumberOf(text);
  if (!value) return "must be a number, not '" + text + "'";
  // NodeODM reads integers from a page where people type 10.0 too.
  if (option.kind == OptionKind::kInt && (*value != std::floor(*value) || std::abs(*value) > 1e9)) return "must be a whole number, not " + text;
  const NumberRange range = RangeOf(option.domain);
  if (range.above_low ? *value > range.low : *value >= range.low) {
    if (*value <= range.high) return "";
    return fmt::format("must be from {} to {}, not {}", range.low, range.high, text);
  }
  return std::isinf(range.high) ? fmt::format("must be {} {}, not {}", range.above_low ? "above" : "at least", range.low, text)
                                : fmt::format("must be from {} to {}, not {}", range.low, range.high, text);
}

}  // namespace

const std::vector<OptionSpec>& Options() {
  static const std::vector<OptionSpec> options = ReadOptions();
  return options;
}

const OptionSpec* FindOption(const std::string& name) {
  const auto found = std::find_if(Options().begin(), Options().end(), [&name](const OptionSpec& option) {
    return option.name == name || (!option.short_name.empty() && option.short_name == name);
  });
  return found == Options().end() ? nullptr : &*found;
}

std::string ValueProblem(const OptionSpec& option, const std::string& value) {
  switch (option.kind) {
    case OptionKind::kInt:
    case OptionKind::kFloat:
      return NumberProblem(option, value);
    case OptionKind::kChoice:
      if (std::find(option.choices.begin(), option.choices.end(), value) != option.choices.end()) return "";
      return "must be one of " + base::Join(option.choices) + ", not '" + value + "'";
    case OptionKind::kFlag:
    case OptionKind::kText:
    case OptionKind::kPath:
    case OptionKind::kJson:
      return "";
  }
  return "";
}

std::string OptionsHelp() {
  std::string text;
  for (const OptionSpec& option : Options()) {
    text += "  " + (option.short_name.empty() ? "" : option.short_name + ", ") + option.name;
    if (option.kind == OptionKind::kChoice) {
      text += " " + base::Join(option.choices, "|");
    } else if (option.kind != OptionKind::kFlag) {
      text += " <" + option.domain + ">";
    }
    text += "\n      " + option.help;
    if (!option.default_value.empty()) text += " Default: " + option.default_value + ".";
    if (!option.no_effect.empty()) text += " Taken, without effect: " + option.no_effect + ".";
    if (!option.refused.empty()) text += " Refused: " + option.refused + ".";
    text += "\n";
  }
  return text;
}

}  // namespace skyquilt::odm
