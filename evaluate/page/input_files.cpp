#include "evaluate/page/input_files.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>
#include <optional>
#include <string_view>
#include <utility>

#include "core/base/errors.h"
#include "core/base/file.h"

namespace skyquilt::evaluate::page {

namespace {

constexpr size_t kExamples = 3;
constexpr std::ptrdiff_t kMostReasons = 3;  // of a kind; more of them, such as one per file, become one

// Files that nobody takes for photos.
constexpr std::array<std::string_view, 3> kNoPictures = {"hidden or system", "camera model", "other file"};

bool IsPicture(const InputGroup& group) {
  return std::find(kNoPictures.begin(), kNoPictures.end(), group.kind) == kNoPictures.end();
}

// The fields of the record that begins at `at`, which is moved behind it. Quoted fields may have commas and line breaks.
std::vector<std::string> NextRecord(const std::string& csv, size_t& at) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  while (at < csv.size()) {
    const char c = csv[at++];
    if (quoted) {
      if (c != '"') {
        fields.back() += c;
      } else if (at < csv.size() && csv[at] == '"') {
        fields.back() += csv[at++];
      } else {
        quoted = false;
      }
    } else if (c == '"' && fields.back().empty()) {
      quoted = true;
    } else if (c == ',') {
      fields.emplace_back();
    } else if (c == '\n') {
      break;
    } else if (c == '\r' && at < csv.size() && csv[at] == '\n') {
      continue;
    } else {
      fields.back() += c;
    }
  }
  return fields;
}

std::optional<size_t> ColumnOf(const std::vector<std::string>& heading, std::string_view name) {
  const auto found = std::find(heading.begin(), heading.end(), name);
  return found == heading.end() ? std::nullopt : std::optional(static_cast<size_t>(found - heading.begin()));
}

void AddExamples(const std::vector<std::string>& names, InputGroup& group) {
  for (const std::string& name : names) {
    if (group.examples.size() < kExamples) group.examples.push_back(name);
  }
}

void AddFile(const std::string& file, InputGroup one, std::vector<InputGroup>& groups) {
  const auto known = std::find_if(groups.begin(), groups.end(), [&](const InputGroup& group) {
    return group.taken == one.taken && group.kind == one.kind && (group.several || group.reason == one.reason);
  });
  InputGroup& group = known != groups.end() ? *known : groups.emplace_back(std::move(one));
  ++group.n;
  AddExamples({file}, group);
  const auto is_like = [like = std::pair(group.taken, group.kind)](const InputGroup& other) { return std::pair(other.taken, other.kind) == like; };
  if (std::count_if(groups.begin(), groups.end(), is_like) <= kMostReasons) return;
  const auto first = std::find_if(groups.begin(), groups.end(), is_like);
  first->several = true;
  for (auto other = std::next(first); other != groups.end(); ++other) {
    if (!is_like(*other)) continue;
    first->n += other->n;
    AddExamples(other->examples, *first);
  }
  groups.erase(std::remove_if(std::next(first), groups.end(), is_like), groups.end());
}

}  // namespace

bool InputFiles::Remarkable() const {
  return std::any_of(groups.begin(), groups.end(), IsPicture);
}

InputFiles ParseInputFiles(const std::string& csv) {
  InputFiles files;
  size_t at = 0;
  const std::vector<std::string> heading = NextRecord(csv, at);
  const auto file = ColumnOf(heading, "file"), taken = ColumnOf(heading, "taken"), kind = ColumnOf(heading, "kind"),
             reason = ColumnOf(heading, "reason");
  if (!file || !taken || !kind || !reason) return files;
  while (at < csv.size()) {
    const std::vector<std::string> fields = NextRecord(csv, at);
    if (fields.size() != heading.size()) continue;
    InputGroup one{.taken = fields[*taken] == "yes", .kind = fields[*kind], .reason = fields[*reason], .examples = {}};
    ++(one.taken ? files.n_taken : files.n_left_out);
    if (one.taken && one.reason.empty()) continue;
    AddFile(fields[*file], std::move(one), files.groups);
  }
  std::stable_sort(files.groups.begin(), files.groups.end(),
                   [](const InputGroup& a, const InputGroup& b) { return std::pair(IsPicture(a), a.n) > std::pair(IsPicture(b), b.n); });
  return files;
}

InputFiles ReadInputFiles(const std::filesystem::path& csv) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(csv, ignored)) return {};
  try {
    return ParseInputFiles(base::ReadFile(csv));
  } catch (const base::InputError&) {
    return {};  // the report is about the scene: it does not fail for this
  }
}

}  // namespace skyquilt::evaluate::page
