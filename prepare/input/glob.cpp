#include "prepare/input/glob.h"

#include <algorithm>
#include <sstream>

#include "core/base/errors.h"
#include "core/base/text.h"

namespace skyquilt::prepare::input {
namespace {

// Lower case from the last '.' of the file name on.
std::string WithLowerExtension(std::string_view text) {
  const size_t dot = text.rfind('.'), slash = text.rfind('/');
  std::string result(text);
  if (dot == std::string_view::npos || (slash != std::string_view::npos && dot < slash)) return result;
  return result.substr(0, dot) + base::LowerCase(result.substr(dot));
}

// Row by row over the pattern: which beginnings of `name` what was read of it matches. Trying all ways would take exponential time.
bool MatchesAll(std::string_view pattern, std::string_view name) {
  std::vector<char> before(name.size() + 1, 0), after(name.size() + 1, 0);
  before[0] = 1;
  for (size_t i = 0; i < pattern.size(); ++i) {
    const bool star = pattern[i] == '*';
    const bool any = star && i + 1 < pattern.size() && pattern[i + 1] == '*';
    if (any) ++i;
    after[0] = star ? before[0] : 0;
    for (size_t k = 1; k <= name.size(); ++k) {
      const char c = name[k - 1];
      if (star) {
        after[k] = before[k] != 0 || (after[k - 1] != 0 && (any || c != '/')) ? 1 : 0;
      } else {
        after[k] = before[k - 1] != 0 && (pattern[i] == '?' ? c != '/' : pattern[i] == c) ? 1 : 0;
      }
    }
    std::swap(before, after);
  }
  return before.back() != 0;
}

}  // namespace

std::vector<std::string> ParsePatterns(const std::string& text) {
  std::vector<std::string> patterns;
  std::istringstream in(text);
  for (std::string one; std::getline(in, one, ',');) {
    const size_t first = one.find_first_not_of(" \t");
    if (first == std::string::npos) continue;
    one = one.substr(first, one.find_last_not_of(" \t") + 1 - first);
    if (one.starts_with("./")) one.erase(0, 2);
    if (!one.empty()) patterns.push_back(one);
  }
  if (patterns.empty()) throw base::UsageError("prepare.photos = '" + text + "' has no pattern: give one such as *.JPG or flight1/*");
  return patterns;
}

bool MatchesPattern(std::string_view pattern, std::string_view name) {
  if (pattern.find('/') == std::string_view::npos) name = name.substr(name.rfind('/') + 1);  // npos + 1 is 0
  return MatchesAll(WithLowerExtension(pattern), WithLowerExtension(name));
}

bool MatchesAny(const std::vector<std::string>& patterns, std::string_view name) {
  return std::any_of(patterns.begin(), patterns.end(), [name](const std::string& pattern) { return MatchesPattern(pattern, name); });
}

}  // namespace skyquilt::prepare::input
