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

void Sections::Check() const {
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
