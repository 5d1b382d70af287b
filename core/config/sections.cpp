#include <algorithm>

#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/config/options.h"

namespace skyquilt::config {

std::string WhyForbidden(const Option& option) {
  bool is_allowed = true;
  Value value = option.value;
  std::string place;
  if (const auto* number = std::get_if<int*>(&option.value)) {
    is_allowed = option.range.Contains(static_cast<double>(**number));
  } else if (const auto* real = std::get_if<double*>(&option.value)) {
    is_allowed = option.range.Contains(**real);
  } else if (const auto* text = std::get_if<std::string*>(&option.value)) {
    is_allowed = option.range.Contains(**text);
  } else if (const auto* numbers = std::get_if<std::vector<double>*>(&option.value)) {
    for (size_t i = 0; i < (*numbers)->size() && is_allowed; ++i) {
      is_allowed = option.range.Contains((**numbers)[i]);
      value = &(**numbers)[i];
      place = "[" + std::to_string(i) + "]";
    }
  }
  if (is_allowed) return "";
  return place.append(" = ").append(TomlText(value)).append(" is not allowed: it must be ").append(option.range.Text());
}

void CheckRanges(const std::string& section, const std::vector<Option>& options) {
  for (const Option& option : options) {
    if (const std::string why = WhyForbidden(option); !why.empty())
      throw base::UsageError(std::string(section).append(".").append(option.key).append(why));
  }
}

const Option* Sections::Find(const std::string& key) const {
  for (const Entry& entry : entries_) {
    if (key.rfind(entry.name + ".", 0) != 0) continue;
    for (const Option& option : entry.options) {
      if (key.compare(entry.name.size() + 1, std::string::npos, option.key) == 0) return &option;
    }
  }
  return nullptr;
}

const Option* Sections::Inherited(const std::string& key) const {
  for (const Inheritance& one : inheritances_) {
    if (!key.starts_with(one.name + ".")) continue;
    const std::string bare = key.substr(one.name.size() + 1);
    return one.own.contains(bare) ? nullptr : Find(one.from + "." + bare);
  }
  return nullptr;
}

void Sections::PassOn(const std::set<std::string>& given) const {
  for (const Inheritance& one : inheritances_) {
    const auto entry = std::find_if(entries_.begin(), entries_.end(), [&one](const Entry& section) { return section.name == one.name; });
    for (const Option& option : entry->options) {
      if (given.contains(one.name + "." + option.key)) one.named->insert(option.key);
      if (one.own.contains(option.key) || one.named->contains(option.key) || !given.contains(one.from + "." + option.key)) continue;
      const Value& source = Find(one.from + "." + option.key)->value;
      std::visit([&source](auto* value) { *value = *std::get<decltype(value)>(source); }, option.value);
    }
  }
}

const FixedOption* Sections::FindFixed(const std::string& key) const {
  const auto found = std::find_if(fixed_.begin(), fixed_.end(), [&key](const FixedOption& fixed) { return fixed.key == key; });
  return found == fixed_.end() ? nullptr : &*found;
}

void Sections::Check() const {
  // A wrong value is named where it was given, not where it is inherited.
  for (const Inheritance& one : inheritances_) {
    for (const Entry& entry : entries_) {
      if (entry.name == one.from) entry.check();
    }
  }
  for (const Entry& entry : entries_) entry.check();
}

bool Sections::IsRetired(const std::string& key, const std::string& origin) const {
  const auto retired = retired_.find(key);
  if (retired == retired_.end()) return false;
  base::LogWarning("{}: option '{}' no longer has an effect ({}); remove it", origin, key, retired->second);
  return true;
}

std::string Sections::CurrentName(const std::string& key, const std::string& origin) const {
  const auto renamed = renamed_.find(key);
  if (renamed == renamed_.end()) return key;
  if (!origin.empty()) base::LogWarning("{}: option '{}' is now called '{}'; use the new name", origin, key, renamed->second);
  return renamed->second;
}

}  // namespace skyquilt::config
