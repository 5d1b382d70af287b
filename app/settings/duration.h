// Durations as people write them: "90s", "10min", "1h30m", "2.5h", "1:30:00" and plain seconds "600".
#pragma once

#include <string>

namespace skyquilt::app {

// Seconds, finite and > 0. Throws base::UsageError quoting the text and showing examples.
double ParseDurationSeconds(const std::string& text);

}  // namespace skyquilt::app
