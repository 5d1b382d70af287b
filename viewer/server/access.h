// Who may use the viewer, and what for: a token in a launch link works once and is exchanged for a session with the link's right, which the browser
// keeps as a cookie.
#pragma once

#include <chrono>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "viewer/server/server.h"

namespace skyquilt::viewer::server {

constexpr size_t kMaxSessions = 64;     // the oldest is dropped
constexpr size_t kMaxWrongTokens = 20;  // within kGuessPause; then wrong ones are answered with kTooManyGuesses for kGuessPause
constexpr std::chrono::seconds kGuessPause{60};

// Thread-safe.
class Access {
 public:
  using Clock = std::chrono::steady_clock;
  enum class Exchange { kGranted, kWrong, kTooManyGuesses };
  struct Grant {
    std::string set_cookie;  // value of the Set-Cookie header
    Right right = Right::kPlay;
  };

  // Cookies of two viewers on one machine share their host, so the name must tell them apart. There is a token for each of the rights.
  explicit Access(std::string cookie_name, const std::vector<Right>& rights = {Right::kView});

  // The token that gives this right now.
  std::string token(Right right) const;
  // kGranted: `token` is used up, there is a new one of the same right, and `grant` is filled in. `trusted`: the request has a valid cookie, so a
  // wrong token is an old link and no guess. The right token is always granted.
  Exchange TryToken(std::string_view token, bool trusted, Clock::time_point now, Grant& grant);
  // The right of the first session that one of the Cookie headers holds; nothing without a session.
  std::optional<Right> SessionRight(const std::vector<std::string>& cookie_headers) const;

 private:
  struct Session {
    std::string secret;
    Right right;
  };
  std::optional<Right> RightOf(std::string_view secret) const;

  const std::string cookie_name_;
  mutable std::mutex mutex_;
  std::map<Right, std::string> tokens_;
  std::deque<Session> sessions_;  // oldest first
  std::deque<Clock::time_point> wrong_;
  Clock::time_point paused_until_{};
};

// For tokens and cookies: 32 bytes from the system's random generator as 64 hex digits. Throws std::system_error.
std::string NewSecret();
// Takes the same time wherever the texts differ, so that a secret cannot be found digit by digit. Only their lengths can be learned.
bool EqualInConstantTime(std::string_view a, std::string_view b);

}  // namespace skyquilt::viewer::server
