#include <algorithm>
#include <numeric>

#include "core/base/file.h"
#include "core/config/options.h"

namespace skyquilt::config {

namespace {

// Number of insertions, deletions, replacements and swaps of neighbouring letters (optimal string alignment); swaps are common typing errors.
size_t EditDistance(const std::string& a, const std::string& b) {
  std::vector<size_t> before_last(b.size() + 1);
  std::vector<size_t> last(b.size() + 1);
  std::vector<size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), size_t{0});
  for (size_t i = 1; i <= a.size(); ++i) {
    before_last.swap(last);
    last.swap(row);
    row[0] = i;
    for (size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] == b[j - 1] ? 0U : 1U)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) row[j] = std::min(row[j], before_last[j - 2] + 1);
    }
  }
  return row[b.size()];
}

}  // namespace

std::string Hash(const std::map<std::string, std::string>& flat) {
  std::string text;
  for (const auto& [key, value] : flat) text.append(key).append(" = ").append(value).append("\n");
  return base::HashHex(text);
}

std::vector<std::string> Differences(const std::map<std::string, std::string>& before, const std::map<std::string, std::string>& after) {
  std::map<std::string, std::pair<std::string, std::string>> sides;
  for (const auto& [key, value] : before) sides[key] = {value, "(none)"};
  for (const auto& [key, value] : after) {
    const auto [entry, is_new] = sides.try_emplace(key, "(none)", value);
    if (!is_new) entry->second.second = value;
  }
  std::vector<std::string> lines;
  for (const auto& [key, values] : sides) {
    if (values.first != values.second) lines.push_back(key + ": " + values.first + " -> " + values.second);
  }
  return lines;
}

std::string Nearest(const std::string& word, const std::vector<std::string>& candidates) {
  std::string nearest;
  size_t smallest = std::max<size_t>(2, word.size() / 3) + 1;
  for (const std::string& candidate : candidates) {
    const size_t distance = EditDistance(word, candidate);
    if (distance >= smallest) continue;
    smallest = distance;
    nearest = candidate;
  }
  return nearest;
}

}  // namespace skyquilt::config
