#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <sstream>

#include "core/base/errors.h"
#include "core/config/options.h"

namespace skyquilt::config {
namespace {

std::string ValueText(bool value) {
  return value ? "true" : "false";
}

std::string ValueText(int value) {
  return std::to_string(value);
}

std::string ValueText(double value) {
  if (std::isnan(value)) return "nan";
  std::array<char, 40> buffer;
  const std::to_chars_result end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  std::string text(buffer.data(), end.ptr);
  // Without a decimal point it would be an integer in TOML.
  if (text.find_first_not_of("-0123456789") == std::string::npos) text += ".0";
  return text;
}

std::string ValueText(const std::string& value) {
  std::string text = "\"";
  for (const char letter : value) {
    const auto code = static_cast<unsigned char>(letter);
    if (letter == '"' || letter == '\\') {
      text += '\\';
      text += letter;
    } else if (code < 0x20 || code == 0x7f) {
      text += "\\u00";
      text += "0123456789abcdef"[code >> 4U];
      text += "0123456789abcdef"[code & 15U];
    } else {
      text += letter;
    }
  }
  return text + "\"";
}

std::string ValueText(const std::vector<double>& values) {
  std::string text = "[";
  for (size_t i = 0; i < values.size(); ++i) text += (i > 0 ? ", " : "") + ValueText(values[i]);
  return text + "]";
}

void WriteComment(std::ostream& out, const std::string& text) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) out << "# " << line << "\n";
}

bool IsBareKey(const std::string& key) {
  return !key.empty() && std::all_of(key.begin(), key.end(), [](char letter) {
    return (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') || (letter >= '0' && letter <= '9') || letter == '_' || letter == '-';
  });
}

}  // namespace

std::string TomlText(const Value& value) {
  return std::visit([](const auto* v) { return ValueText(*v); }, value);
}

std::string TomlText(const Option& option) {
  const auto* const number = std::get_if<int*>(&option.value);
  const std::optional<std::string> word = number != nullptr ? option.range.WordFor(**number) : std::nullopt;
  return word ? ValueText(*word) : TomlText(option.value);
}

std::string TomlText(const FixedOption& fixed) {
  return std::visit([](auto value) { return ValueText(value); }, fixed.value);
}

std::string WriteToml(const Sections& sections) {
  std::ostringstream out;
  for (const Sections::Entry& entry : sections.entries()) {
    if (out.tellp() > 0) out << "\n";
    WriteComment(out, entry.help);
    out << "[" << entry.name << "]\n";
    for (const Option& option : entry.options) {
      SKYQUILT_CHECK(IsBareKey(option.key), "option key '" + option.key + "'");
      const std::string value = TomlText(option);
      const Option* inherited = sections.Inherited(entry.name + "." + option.key);
      if (value == option.unwritten || (inherited != nullptr && value == TomlText(*inherited))) continue;
      WriteComment(out, option.help);
      const std::string range = option.range.Text();
      if (!range.empty()) WriteComment(out, "allowed: " + range);
      out << option.key << " = " << value << "\n";
    }
  }
  return out.str();
}

std::map<std::string, std::string> Flatten(const Sections& sections) {
  std::map<std::string, std::string> flat;
  for (const Sections::Entry& entry : sections.entries()) {
    for (const Option& option : entry.options) {
      const std::string key = entry.name + "." + option.key;
      SKYQUILT_CHECK(flat.emplace(key, TomlText(option)).second, "option '" + key + "' is described twice");
    }
  }
  for (const FixedOption& fixed : sections.fixed()) flat.emplace(fixed.key, TomlText(fixed));
  return flat;
}

}  // namespace skyquilt::config
