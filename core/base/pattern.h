// Regular expressions (ECMAScript), compiled in one place: each file that uses std::regex costs seconds of compilation.
// std::regex recurses with the length of what it matches: give it short texts, or patterns that match short parts.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace skyquilt::base {

// What matched: the whole, then each group (empty: it took no part).
using PatternMatch = std::vector<std::string>;

// Of all of `text`; nullopt when it does not match.
std::optional<PatternMatch> MatchWhole(const std::string& text, std::string_view pattern, bool ignore_case = false);
// All places where it matches, in their order.
std::vector<PatternMatch> FindAll(const std::string& text, std::string_view pattern);

}  // namespace skyquilt::base
