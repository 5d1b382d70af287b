#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <sstream>

#include "core/base/errors.h"
#include "core/config/options.h"

namespace skyquilt::config {
namespace {

// A value as TOML writes it; numbers in the shortest form that reads back to the same bits.
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
  // Without a point it would be an integer to other readers.
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

// Hands every field on as (key, text, help).
class TextVisitor : public OptionVisitor {
 public:
  using Sink = std::function<void(const std::string& key, const std::string& text, const std::string& help)>;
  explicit TextVisitor(Sink sink) : sink_(std::move(sink)) {}
  void Field(const std::string& key, bool& value, const std::string& help) override { sink_(key, ValueText(value), help); }
  void Field(const std::string& key, int& value, const std::string& help) override { sink_(key, ValueText(value), help); }
  void Field(const std::string& key, double& value, const std::string& help) override { sink_(key, ValueText(value), help); }
  void Field(const std::string& key, std::string& value, const std::string& help) override { sink_(key, ValueText(value), help); }
  void Field(const std::string& key, std::vector<double>& value, const std::string& help) override { sink_(key, ValueText(value), help); }

 private:
  Sink sink_;
};

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

std::string WriteToml(Sections& sections) {
  std::ostringstream out;
  for (const Sections::Entry& entry : sections.entries()) {
    if (out.tellp() > 0) out << "\n";
    WriteComment(out, entry.help);
    if (!entry.name.empty()) {
      out << "[" << entry.name << "]\n";
    } else {
      SKYQUILT_CHECK(&entry == sections.entries().data(), "keys without a section must come first in TOML");
    }
    TextVisitor visitor([&out](const std::string& key, const std::string& text, const std::string& help) {
      SKYQUILT_CHECK(IsBareKey(key), "option key '" + key + "'");
      WriteComment(out, help);
      out << key << " = " << text << "\n";
    });
    entry.visit(visitor);
  }
  return out.str();
}

std::map<std::string, std::string> Flatten(Sections& sections) {
  std::map<std::string, std::string> flat;
  for (const Sections::Entry& entry : sections.entries()) {
    const std::string prefix = entry.name.empty() ? "" : entry.name + ".";
    TextVisitor visitor([&](const std::string& key, const std::string& text, const std::string&) {
      SKYQUILT_CHECK(flat.emplace(prefix + key, text).second, "option '" + prefix + key + "' is described twice");
    });
    entry.visit(visitor);
  }
  return flat;
}

}  // namespace skyquilt::config
