#include "merge/look.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>

#include "core/base/errors.h"
#include "core/base/text.h"
#include "core/checkpoint/archive.h"

namespace skyquilt::merge {
namespace {

constexpr size_t kNamesTold = 8;

[[noreturn]] void Refuse(const std::string& text, const std::string& why) {
  throw base::UsageError("merge.look = '" + text + "' is not understood: " + why + ". Give a photo or folder, or several as NAME:WEIGHT,NAME:WEIGHT");
}

std::string Trimmed(const std::string& text) {
  const size_t first = text.find_first_not_of(' ');
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(' ') - first + 1);
}

// Every name ends with a zero.
std::vector<std::string> NamesIn(const std::vector<uint8_t>& bytes) {
  std::vector<std::string> names(1);
  for (const uint8_t byte : bytes) {
    if (byte == 0) {
      names.emplace_back();
    } else {
      names.back().push_back(static_cast<char>(byte));
    }
  }
  names.pop_back();
  return names;
}

size_t RowOf(const std::string& wanted, const std::vector<std::string>& names) {
  const auto found = std::find(names.begin(), names.end(), wanted);
  if (found != names.end()) return static_cast<size_t>(found - names.begin());
  std::vector<std::string> told(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(std::min(names.size(), kNamesTold)));
  if (told.size() < names.size()) told.emplace_back("...");
  throw base::UsageError("merge.look names '" + wanted + "', but there are codes of " + base::Join(told) +
                         ". Give one of these; codes of folders need a training with train.appearance_of = folder");
}

}  // namespace

std::vector<LookPart> ParseLook(const std::string& text) {
  std::vector<LookPart> parts;
  if (Trimmed(text).empty()) return parts;
  std::istringstream stream(text);
  double sum = 0.0;
  for (std::string entry; std::getline(stream, entry, ',');) {
    LookPart part;
    const size_t colon = entry.rfind(':');
    part.name = Trimmed(entry.substr(0, colon));
    if (part.name.empty()) Refuse(text, "a part has no name");
    if (colon != std::string::npos) {
      const std::string number = Trimmed(entry.substr(colon + 1));
      const auto result = std::from_chars(number.data(), number.data() + number.size(), part.weight);
      const bool whole = result.ec == std::errc() && result.ptr == number.data() + number.size();
      if (!whole || !std::isfinite(part.weight) || part.weight < 0.0) Refuse(text, "'" + number + "' is no weight, a number from 0");
    }
    sum += part.weight;
    parts.push_back(std::move(part));
  }
  if (!(sum > 0.0)) Refuse(text, "all weights are 0");
  return parts;
}

std::vector<float> CodeOfLook(const std::vector<LookPart>& look, const std::filesystem::path& checkpoint) {
  const checkpoint::ArchiveReader reader(checkpoint);
  if (!reader.Has("appearance/codes") || !reader.Has("appearance/names")) {
    throw base::UsageError("merge.look needs codes of photos, which " + checkpoint.string() +
                           " has not: train with train.appearance_codes = N first, or leave merge.look empty");
  }
  const std::vector<std::string> names = NamesIn(reader.Bytes("appearance/names"));
  const std::vector<int64_t> shape = reader.Shape("appearance/codes");
  const std::vector<float> codes = reader.Floats("appearance/codes");
  if (shape.size() != 2 || shape[0] != static_cast<int64_t>(names.size())) {
    throw base::InputError(checkpoint, "its codes do not fit their names", "Train this field again with --restart");
  }
  const auto numbers = static_cast<size_t>(shape[1]);
  std::vector<double> mixed(numbers, 0.0);
  double sum = 0.0;
  for (const LookPart& part : look) {
    const size_t row = RowOf(part.name, names);
    for (size_t k = 0; k < numbers; ++k) mixed[k] += part.weight * static_cast<double>(codes[row * numbers + k]);
    sum += part.weight;
  }
  std::vector<float> code;
  code.reserve(mixed.size());
  for (const double value : mixed) code.push_back(static_cast<float>(value / sum));
  return code;
}

}  // namespace skyquilt::merge
