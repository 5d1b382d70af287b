// Reads JSON that comes from outside: everything in it is untrusted. All functions throw Refused; `where` is the path of the value in the document,
// as in "stops[3].title".
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <stdexcept>
#include <string>
#include <string_view>

namespace skyquilt::base {

// What is wrong with a document, for the user.
class Refused : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Refuses what is not JSON, or is nested deeper than 32: programs that read it, ours among them, follow the nesting on their stack.
nlohmann::json ParseDocument(std::string_view text);
// A number that is finite and at most 1e9.
void RequireNumber(const nlohmann::json& value, const std::string& where);
// A text of 1 to max_bytes bytes without control characters.
void RequireLine(const nlohmann::json& value, size_t max_bytes, const std::string& where);

// Where a text of the document ends: behind the closing quote of that whose opening quote is at `begin`, or at the end of the document. For those
// who look through a document without parsing it.
size_t EndOfText(std::string_view document, size_t begin);

// Characters (code points) of valid UTF-8.
size_t CharactersIn(std::string_view utf8);
// Below space, or delete.
bool IsControl(char c);

}  // namespace skyquilt::base
