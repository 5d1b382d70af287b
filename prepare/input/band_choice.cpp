#include "prepare/input/band_choice.h"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <optional>

#include "core/base/errors.h"
#include "core/base/text.h"

namespace skyquilt::prepare::input {
namespace {

std::string BandKey(const std::string& name) {
  std::string key;
  for (const char c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) key += c;
  }
  return base::LowerCase(key);
}

std::vector<std::string> ListedParts(const std::string& list) {
  std::vector<std::string> parts(1);
  for (const char c : list) {
    if (c == ',') {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  for (std::string& part : parts) {
    part.erase(0, std::min(part.find_first_not_of(" \t"), part.size()));
    part.erase(part.find_last_not_of(" \t") + 1);
  }
  return parts;
}

std::optional<int> WholeNumber(const std::string& text) {
  int number = 0;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), number);
  if (result.ec != std::errc() || result.ptr != text.data() + text.size()) return std::nullopt;
  return number;
}

// From 1; nothing when there is no such band.
std::optional<int> BandNamed(const std::vector<std::string>& names, const std::string& name) {
  const std::string key = BandKey(name);
  for (size_t i = 0; i < names.size(); ++i) {
    if (!key.empty() && BandKey(names[i]) == key) return static_cast<int>(i) + 1;
  }
  return std::nullopt;
}

std::string BandsFound(const image::PixelFormat& format, const std::vector<std::string>& names) {
  std::string text = std::to_string(format.bands) + " bands";
  if (std::all_of(names.begin(), names.end(), [](const std::string& name) { return name.empty(); })) return text + " without names";
  std::vector<std::string> shown;
  for (size_t i = 0; i < names.size(); ++i) shown.push_back(std::to_string(i + 1) + " " + (names[i].empty() ? "(no name)" : names[i]));
  return text + ": " + base::Join(shown);
}

}  // namespace

BandChoice ChooseBands(const image::PixelFormat& format, const std::vector<std::string>& names, const std::string& wanted) {
  BandChoice choice;
  const int colours = format.bands - std::min(format.alpha_bands, format.bands - 1);
  if (wanted.empty()) {
    if (colours == 1) {
      choice.bands = {1};
      return choice;
    }
    if (colours > 3) {
      const std::optional<int> red = BandNamed(names, "red"), green = BandNamed(names, "green"), blue = BandNamed(names, "blue");
      if (red && green && blue) {
        choice.bands = {*red, *green, *blue};
        return choice;
      }
    }
    if (colours == 3 || (colours > 3 && format.is_rgb)) {
      choice.bands = {1, 2, 3};
    } else {
      choice.problem = "has " + BandsFound(format, names) + ", and does not say which are red, green and blue";
    }
    return choice;
  }
  for (const std::string& part : ListedParts(wanted)) {
    const std::optional<int> number = WholeNumber(part);
    const std::optional<int> band = number ? number : BandNamed(names, part);
    if (!band || *band < 1 || *band > format.bands) {
      choice.problem = fmt::format("has no band {} (prepare.bands = \"{}\"), but {}", part, wanted, BandsFound(format, names));
      choice.bands.clear();
      return choice;
    }
    choice.bands.push_back(*band);
  }
  return choice;
}

void CheckBandsOption(const std::string& wanted) {
  if (wanted.empty()) return;
  const std::vector<std::string> parts = ListedParts(wanted);
  const bool good = (parts.size() == 1 || parts.size() == 3) && std::all_of(parts.begin(), parts.end(), [](const std::string& part) {
                      const std::optional<int> number = WholeNumber(part);
                      return number ? *number >= 1 : !BandKey(part).empty();
                    });
  if (good) return;
  throw base::UsageError(
      "prepare.bands is \"" + wanted +
      "\": name the bands for red, green and blue, or one for grey pictures, by numbers from 1 or by names, for instance \"3,2,1\"");
}

}  // namespace skyquilt::prepare::input
