// Who may use the viewer: a token in the launch link works once and is exchanged for a session, which the browser keeps as a cookie.
#pragma once

#include <chrono>
#include <deque>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

namespace skyquilt::viewer::server {

constexpr size_t kMaxSessions = 64;     // the oldest is dropped
constexpr size_t kMaxWrongTokens = 20;  // within kGuessPause; then wrong ones are answered with kTooManyGuesses for kGuessPause
constexpr std::chrono::seconds kGuessPause{60};

// Thread-safe.
class Access {
 public:
  using Clock = std::chrono::steady_clock;
  enum class Exchange { kGranted, kWrong, kTooManyGuesses };

  // Cookies of two viewers on one machine share their host, so the name must tell them apart.
  explicit Access(std::string cookie_name);

  // The token that works now.
  std::string token() const;
  // kGranted: `token` is used up, there is a new one, and set_cookie is the value of the Set-Cookie header. `trusted`: the request has a valid
  // cookie, so a wrong token is an old link and no guess. The right token is always granted.
  Exchange TryToken(std::string_view token, bool trusted, Clock::time_point now, std::string& set_cookie);
  // Whether one of the Cookie headers holds a session.
  bool HasSession(const std::vector<std::string>& cookie_headers) const;

 private:
  bool IsSession(std::string_view value) const;

  const std::string cookie_name_;
  mutable std::mutex mutex_;
  std::string token_;
  std::deque<std::string> sessions_;  // oldest first
  std::deque<Clock::time_point> wrong_;
  Clock::time_point paused_until_{};
};

}  // namespace skyquilt::viewer::server
