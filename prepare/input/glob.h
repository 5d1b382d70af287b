// Patterns of file names, as shells have them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace skyquilt::prepare::input {

// Commas separate patterns; spaces around them do not count. Throws base::UsageError when there is nothing between commas at all.
std::vector<std::string> ParsePatterns(const std::string& text);

// Whether a pattern is that of a file. `name`: relative to the photo folder, '/' separated.
//   *   any bytes without '/'        **  any bytes        ?   one byte that is not '/'
// A pattern without '/' is compared with the file name alone, in whatever folder. Upper and lower case are the same in the extension (what follows
// the last '.'), and differ elsewhere. Takes the product of both lengths at most.
bool MatchesPattern(std::string_view pattern, std::string_view name);
bool MatchesAny(const std::vector<std::string>& patterns, std::string_view name);

}  // namespace skyquilt::prepare::input
