// Random secrets for tokens and cookies.
#pragma once

#include <string>
#include <string_view>

namespace skyquilt::viewer::server {

// 32 bytes from the system's random generator as 64 hex digits. Throws std::system_error.
std::string NewSecret();
// Takes the same time wherever the texts differ, so that a secret cannot be found digit by digit. Only their lengths can be learned.
bool EqualInConstantTime(std::string_view a, std::string_view b);

}  // namespace skyquilt::viewer::server
