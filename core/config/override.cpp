#include "core/config/override.h"

#include <algorithm>
#include <cctype>

#include "core/base/errors.h"

namespace skyquilt::config {
namespace {

std::string Trim(const std::string& text) {
  const size_t first = text.find_first_not_of(" \t");
  if (first == std::string::npos) return "";
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

bool Encloses(const std::string& text, char open, char close) {
  return text.size() >= 2 && text.front() == open && text.back() == close;
}

// The value with the quotes or brackets that TOML needs for this option's type.
std::string InToml(const std::string& value, const Option& option) {
  const Value& type = option.value;
  if ((std::holds_alternative<std::string*>(type) || option.range.NumberOf(value)) && !Encloses(value, '"', '"')) {
    std::string text = value;
    return TomlText(&text);
  }
  if (std::holds_alternative<std::vector<double>*>(type) && !Encloses(value, '[', ']')) return "[" + value + "]";
  // As shells and other programs write switches.
  if (std::holds_alternative<bool*>(type) && (value == "1" || value == "yes")) return "true";
  if (std::holds_alternative<bool*>(type) && (value == "0" || value == "no")) return "false";
  return value;
}

}  // namespace

Override ParseOverride(const std::string& text) {
  const size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0) {
    throw base::UsageError("--set " + text + " is not understood: write section.key=value, for instance --set train.steps=4000");
  }
  return {Trim(text.substr(0, equals)), Trim(text.substr(equals + 1))};
}

void ApplyOverride(const Override& entry, const Sections& sections) {
  // TOML allows other spellings of a key, quotes and blanks, and comments: none of them is meant here.
  const bool is_plain =
      std::all_of(entry.key.begin(), entry.key.end(), [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '-' || c == '.'; });
  if (!is_plain) throw base::UsageError("'" + entry.key + "' is not an option: write section.key=value, for instance --set train.steps=4000");
  const Option* option = sections.Find(sections.CurrentName(entry.key, ""));
  const bool is_fixed = sections.FindFixed(entry.key) != nullptr;
  const std::string value = option != nullptr ? InToml(entry.value, *option) : is_fixed ? entry.value : "true";
  try {
    // Two lines would be two options.
    if ((entry.key + value).find('\n') != std::string::npos) throw base::InputError(entry.key, "has more than one line", "");
    ReadTomlText(entry.key + " = " + value, "", sections);
  } catch (const base::InputError&) {
    throw base::UsageError(entry.key + " = '" + entry.value + "' is not understood: write the value as in a TOML file, for instance " +
                           (option == nullptr ? "train.steps = 4000" : entry.key + " = " + TomlText(*option)));
  }
}

}  // namespace skyquilt::config
