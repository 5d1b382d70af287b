// JSON that comes from outside: everything in it is untrusted. JsonValue and JsonObject take its values out.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <nlohmann/json_fwd.hpp>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

namespace skyquilt::base {

// What is wrong with a document, for the user.
class Refused : public std::runtime_error {
 public:
  explicit Refused(const std::string& sentence) : std::runtime_error(sentence), rule_(sentence) {}
  // place: of a value in the document, as in "stops[3].title"; empty for the whole. rule: what it breaks, as in "must be one line".
  Refused(std::string place, const std::string& rule)
      : std::runtime_error((place.empty() ? "it" : place) + " " + rule), place_(std::move(place)), rule_(rule) {}
  const std::string& place() const { return place_; }
  const std::string& rule() const { return rule_; }

 private:
  std::string place_, rule_;
};

enum class RepeatedKeys : uint8_t { kLastCounts, kRefused };

// Throws Refused for what is not JSON, or is nested deeper than 32: programs that read it, ours among them, follow the nesting on their stack.
nlohmann::json ParseDocument(std::string_view text, RepeatedKeys repeated = RepeatedKeys::kLastCounts);
// How deep lists and objects are nested, without following them.
int NestingOf(std::string_view text);

// Where a text of the document ends: behind the closing quote of that whose opening quote is at `begin`, or at the end of the document. For those
// who look through a document without parsing it.
size_t EndOfText(std::string_view document, size_t begin);

// Characters (code points) of valid UTF-8.
size_t CharactersIn(std::string_view utf8);
// Below space, or delete.
bool IsControl(char c);
// The beginning of a text from outside, at most 40 characters, plain ASCII: safe to show and to log.
std::string ShownStart(std::string_view text);

// For files of our own, whose figures may be missing: `otherwise` when the value is no object or has no such number.
double NumberIn(const nlohmann::json& json, const std::string& key, double otherwise = std::numeric_limits<double>::quiet_NaN());

}  // namespace skyquilt::base
