#include "core/config/override.h"

#include <charconv>
#include <cmath>
#include <sstream>

#include "core/base/errors.h"

namespace skyquilt::config {
namespace {

std::string Trim(const std::string& text) {
  const size_t first = text.find_first_not_of(" \t");
  if (first == std::string::npos) return "";
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

// Writes one value, given as text, into the field with the wanted key.
class SetVisitor : public OptionVisitor {
 public:
  SetVisitor(const Override& entry, const std::string& key) : entry_(entry), key_(key) {}

  void Field(const std::string& key, bool& value, const std::string& /*help*/) override {
    if (!Matches(key)) return;
    if (entry_.value == "true" || entry_.value == "1" || entry_.value == "yes") {
      value = true;
    } else if (entry_.value == "false" || entry_.value == "0" || entry_.value == "no") {
      value = false;
    } else {
      Fail("true or false");
    }
  }
  void Field(const std::string& key, int& value, const std::string& /*help*/) override {
    if (Matches(key)) value = Number<int>(entry_.value, "a whole number");
  }
  void Field(const std::string& key, double& value, const std::string& /*help*/) override {
    if (Matches(key)) value = Number<double>(entry_.value, "a number");
  }
  void Field(const std::string& key, std::string& value, const std::string& /*help*/) override {
    if (!Matches(key)) return;
    const std::string& text = entry_.value;
    const bool quoted = text.size() >= 2 && text.front() == '"' && text.back() == '"';
    value = quoted ? text.substr(1, text.size() - 2) : text;
  }
  void Field(const std::string& key, std::vector<double>& value, const std::string& /*help*/) override {
    if (!Matches(key)) return;
    std::string list = Trim(entry_.value);
    if (list.size() >= 2 && list.front() == '[' && list.back() == ']') list = list.substr(1, list.size() - 2);
    value.clear();
    std::istringstream stream(list);
    for (std::string part; std::getline(stream, part, ',');) value.push_back(Number<double>(Trim(part), "numbers separated by commas"));
  }

  bool found() const { return found_; }
  const std::vector<std::string>& known() const { return known_; }

 private:
  bool Matches(const std::string& key) {
    known_.push_back(key);
    if (key != key_) return false;
    found_ = true;
    return true;
  }
  [[noreturn]] void Fail(const std::string& wanted) const {
    throw base::UsageError(entry_.key + " = '" + entry_.value + "' cannot be: " + wanted + " is needed");
  }
  template <typename T>
  T Number(const std::string& text, const std::string& wanted) const {
    T value{};
    const char* first = text.data() + (!text.empty() && text.front() == '+' ? 1 : 0);
    const auto result = std::from_chars(first, text.data() + text.size(), value);
    if (result.ec != std::errc() || result.ptr != text.data() + text.size()) Fail(wanted);
    if constexpr (std::is_same_v<T, double>) {
      if (!std::isfinite(value)) Fail(wanted);
    }
    return value;
  }

  const Override& entry_;
  std::string key_;
  std::vector<std::string> known_;
  bool found_ = false;
};

std::string DidYouMean(const std::string& nearest) {
  return nearest.empty() ? "" : ". Did you mean '" + nearest + "'?";
}

}  // namespace

Override ParseOverride(const std::string& text) {
  const size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0) {
    throw base::UsageError("--set " + text + " cannot be: section.key=value is needed, for instance --set train.steps=4000");
  }
  return {Trim(text.substr(0, equals)), Trim(text.substr(equals + 1))};
}

void ApplyOverride(const Override& entry, Sections& sections) {
  if (sections.IsRetired(entry.key, "--set")) return;
  const size_t dot = entry.key.find('.');
  const std::string section = entry.key.substr(0, dot);
  std::vector<std::string> section_names;
  for (const Sections::Entry& candidate : sections.entries()) {
    section_names.push_back(candidate.name);
    if (candidate.name != section || dot == std::string::npos) continue;
    SetVisitor visitor(entry, entry.key.substr(dot + 1));
    candidate.visit(visitor);
    if (visitor.found()) return;
    std::string nearest = Nearest(entry.key.substr(dot + 1), visitor.known());
    if (!nearest.empty()) nearest.insert(0, section + ".");
    throw base::UsageError("unknown option '" + entry.key + "'" + DidYouMean(nearest));
  }
  throw base::UsageError("unknown section in '" + entry.key + "'" + DidYouMean(Nearest(section, section_names)));
}

}  // namespace skyquilt::config
