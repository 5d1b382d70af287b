#include "prepare/holdout.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <set>
#include <sstream>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "prepare/models/photo_names.h"

namespace skyquilt::prepare {
namespace {

[[noreturn]] void FailUsage(const std::string& text) {
  throw base::UsageError("prepare.holdout = '" + text +
                         "' is not understood: use every:N (N >= 2), every:N:offset (0 <= offset < N), list:FILE or none");
}

int ParseInt(const std::string& digits, const std::string& text) {
  int value = 0;
  const auto result = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (digits.empty() || result.ec != std::errc() || result.ptr != digits.data() + digits.size()) FailUsage(text);
  return value;
}

void MarkList(const std::filesystem::path& file, survey::Survey& survey) {
  std::vector<std::string> all;
  for (const survey::Photo& photo : survey.photos) all.push_back(photo.name);
  all.insert(all.end(), survey.unregistered.begin(), survey.unregistered.end());
  const models::PhotoNames names(all);
  std::istringstream lines(base::ReadFile(file));
  bool first_line = true;
  for (std::string line; std::getline(lines, line);) {
    if (first_line && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);
    first_line = false;
    const size_t first = line.find_first_not_of(" \t\r");
    if (first == std::string::npos || line[first] == '#') continue;
    const std::string name = line.substr(first, line.find_last_not_of(" \t\r") - first + 1);
    const std::optional<size_t> found = names.Find(name);
    if (found && *found < survey.photos.size()) {
      survey.photos[*found].is_test = true;
    } else if (found) {
      base::LogWarning("{}: '{}' has no pose, so it is not used as a test photo", file.string(), name);
    } else {
      throw base::InputError(file, "names '" + name + "', which is none of the photos, or several have this file name",
                             "Write names relative to the photo folder, as in survey.json");
    }
  }
}

}  // namespace

Holdout ParseHoldout(const std::string& text) {
  Holdout holdout;
  if (text == "none") return holdout;
  if (text.starts_with("list:") && text.size() > 5) {
    holdout.list = text.substr(5);
    return holdout;
  }
  if (!text.starts_with("every:")) FailUsage(text);
  const std::string numbers = text.substr(6);
  const size_t colon = numbers.find(':');
  holdout.every = ParseInt(numbers.substr(0, colon), text);
  if (colon != std::string::npos) holdout.offset = ParseInt(numbers.substr(colon + 1), text);
  if (holdout.every < 2 || holdout.offset < 0 || holdout.offset >= holdout.every) FailUsage(text);
  return holdout;
}

void MarkHoldout(const Holdout& holdout, survey::Survey& survey) {
  for (survey::Photo& photo : survey.photos) photo.is_test = false;
  if (!holdout.list.empty()) MarkList(holdout.list, survey);
  if (holdout.every > 0) {
    for (size_t i = 0; i < survey.photos.size(); ++i) {
      survey.photos[i].is_test = i % static_cast<size_t>(holdout.every) == static_cast<size_t>(holdout.offset);
    }
  }
  const bool any_train = std::any_of(survey.photos.begin(), survey.photos.end(), [](const survey::Photo& photo) { return !photo.is_test; });
  if (!survey.photos.empty() && !any_train)
    throw base::UsageError("prepare.holdout keeps every photo for testing, so none is left to train on: hold out fewer");
}

void MarkHoldout(const Holdout& holdout, const std::map<std::string, std::string>& shot_of_photo, survey::Survey& survey) {
  const auto shot_of = [&](const std::string& photo) {
    const auto shot = shot_of_photo.find(photo);
    return shot == shot_of_photo.end() ? photo : shot->second;
  };
  std::set<std::string> names;
  for (const survey::Photo& photo : survey.photos) {
    names.insert(shot_of(photo.name));
    if (!holdout.list.empty()) names.insert(photo.name);
  }
  survey::Survey counted;
  for (const std::string& name : names) counted.photos.emplace_back().name = name;
  counted.unregistered = survey.unregistered;
  MarkHoldout(holdout, counted);
  std::set<std::string> held_out;
  for (const survey::Photo& photo : counted.photos) {
    if (photo.is_test) held_out.insert(shot_of(photo.name));
  }
  for (survey::Photo& photo : survey.photos) photo.is_test = held_out.contains(shot_of(photo.name));
  const bool any_train = std::any_of(survey.photos.begin(), survey.photos.end(), [](const survey::Photo& photo) { return !photo.is_test; });
  if (!survey.photos.empty() && !any_train) {
    throw base::UsageError("prepare.holdout keeps photos of every shot for testing, so none is left to train on: hold out fewer shots");
  }
}

}  // namespace skyquilt::prepare
