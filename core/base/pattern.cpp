#include "core/base/pattern.h"

#include <regex>

namespace skyquilt::base {
namespace {

PatternMatch Parts(const std::smatch& match) {
  PatternMatch parts;
  parts.reserve(match.size());
  for (const auto& part : match) parts.push_back(part.str());
  return parts;
}

std::regex Compiled(std::string_view pattern, std::regex::flag_type flags) {
  return {pattern.data(), pattern.size(), flags};
}

}  // namespace

std::optional<PatternMatch> MatchWhole(const std::string& text, std::string_view pattern, bool ignore_case) {
  std::smatch match;
  const std::regex expression = Compiled(pattern, ignore_case ? std::regex::ECMAScript | std::regex::icase : std::regex::ECMAScript);
  if (!std::regex_match(text, match, expression)) return std::nullopt;
  return Parts(match);
}

std::vector<PatternMatch> FindAll(const std::string& text, std::string_view pattern) {
  const std::regex expression = Compiled(pattern, std::regex::ECMAScript);
  std::vector<PatternMatch> found;
  for (std::sregex_iterator it(text.begin(), text.end(), expression), end; it != end; ++it) found.push_back(Parts(*it));
  return found;
}

}  // namespace skyquilt::base
