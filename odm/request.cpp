#include "odm/request.h"

#include <algorithm>
#include <cstdlib>

#include "core/base/errors.h"
#include "core/config/options.h"
#include "odm/option_table.h"

namespace skyquilt::odm {
namespace {

[[noreturn]] void RefuseUnknown(const std::string& name) {
  std::vector<std::string> known = {"--help", "--version"};
  for (const OptionSpec& option : Options()) known.push_back(option.name);
  const std::string nearest = config::Nearest(name, known);
  throw base::UsageError("unknown option " + name + (nearest.empty() ? "" : ". Did you mean " + nearest + "?") +
                         " 'skyquilt odm --help' lists all options");
}

}  // namespace

void Request::TakeOption(const std::vector<std::string>& words, size_t* at) {
  const std::string& word = words[*at];
  const size_t equals = word.starts_with("--") ? word.find('=') : std::string::npos;
  const std::string name = word.substr(0, equals);
  const OptionSpec* option = FindOption(name);
  if (option == nullptr) RefuseUnknown(name);
  std::string value;
  if (option->kind == OptionKind::kFlag) {
    if (equals != std::string::npos) throw base::UsageError(name + " takes no value. Leave it out to switch it off");
  } else if (equals != std::string::npos) {
    value = word.substr(equals + 1);
  } else {
    if (*at + 1 >= words.size()) throw base::UsageError(name + " needs a value");
    value = words[++*at];
  }
  // Pages send options that were left empty.
  if (value.empty() && option->kind != OptionKind::kFlag && option->kind != OptionKind::kInt && option->kind != OptionKind::kFloat) {
    given_.erase(option->name);
    return;
  }
  const std::string problem = ValueProblem(*option, value);
  if (!problem.empty()) throw base::UsageError(option->name + " " + problem);
  if (!option->refused.empty() && (option->kind == OptionKind::kFlag || value != option->default_value)) {
    throw base::UsageError(option->name + " cannot be used: " + option->refused);
  }
  given_[option->name] = value;
}

Request Request::Parse(const std::vector<std::string>& words) {
  Request request;
  const auto is = [&words](const char* name) { return std::find(words.begin(), words.end(), name) != words.end(); };
  request.help_ = is("--help") || is("-h");
  request.version_ = is("--version");
  if (request.help_ || request.version_) return request;
  bool named = false;
  for (size_t i = 0; i < words.size(); ++i) {
    if (words[i].starts_with("-") && words[i].size() > 1) {
      request.TakeOption(words, &i);
    } else if (named) {
      throw base::UsageError("'" + words[i] + "': the dataset is already named '" + request.name_ + "'. Put quotes around values with spaces");
    } else if (!words[i].empty()) {
      request.name_ = words[i];
      named = true;
    }
  }
  if (!request.Has("--project-path")) throw base::UsageError("--project-path is missing: the folder that holds the folder '" + request.name_ + "'");
  if (request.name_ == "." || request.name_ == ".." || request.name_.find('/') != std::string::npos) {
    throw base::UsageError("the dataset '" + request.name_ + "' must be the name of a folder, not a path. Give its parent as --project-path");
  }
  return request;
}

std::filesystem::path Request::Folder() const {
  return std::filesystem::absolute(Text("--project-path")).lexically_normal() / name_;
}

std::string Request::Text(const std::string& option) const {
  if (const auto found = given_.find(option); found != given_.end()) return found->second;
  const OptionSpec* spec = FindOption(option);
  SKYQUILT_CHECK(spec != nullptr, option);
  return spec->default_value;
}

double Request::Number(const std::string& option) const {
  const std::string text = Text(option);
  SKYQUILT_CHECK(!text.empty(), option + " has no number");
  return std::strtod(text.c_str(), nullptr);
}

std::vector<std::string> Request::Notes() const {
  std::vector<std::string> notes;
  for (const OptionSpec& option : Options()) {
    const auto found = given_.find(option.name);
    if (found == given_.end() || option.no_effect.empty()) continue;
    if (option.kind != OptionKind::kFlag && found->second == option.default_value) continue;
    notes.push_back(option.name + ": taken, without effect: " + option.no_effect);
  }
  return notes;
}

}  // namespace skyquilt::odm
