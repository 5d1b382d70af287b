// The target of a request, split and checked: nothing but plain characters gets further, whatever a client writes.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace skyquilt::viewer::server {

constexpr size_t kMaxTargetBytes = 2048;

struct RequestTarget {
  std::string path;   // decoded once; begins with "/"; characters A-Z a-z 0-9 _ . / - only, without ".." and "//"
  std::string query;  // the part after "?", as it was sent
};

// Nothing for a target that is not allowed.
std::optional<RequestTarget> ParseTarget(std::string_view target);
// The value of `key` in a query, as it was sent; nothing when the key is missing.
std::optional<std::string> QueryValue(std::string_view query, std::string_view key);

}  // namespace skyquilt::viewer::server
