#include "viewer/server/access.h"

#include <utility>

#include "viewer/server/secrets.h"

namespace skyquilt::viewer::server {
namespace {

std::string_view WithoutSpaces(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

}  // namespace

Access::Access(std::string cookie_name) : cookie_name_(std::move(cookie_name)), token_(NewSecret()) {}

std::string Access::token() const {
  const std::lock_guard lock(mutex_);
  return token_;
}

Access::Exchange Access::TryToken(std::string_view token, bool trusted, Clock::time_point now, std::string& set_cookie) {
  const std::lock_guard lock(mutex_);
  // First of all: strangers' guesses must not lock out whoever has the link. A token is too long to be guessed meanwhile.
  if (EqualInConstantTime(token, token_)) {
    token_ = NewSecret();
    sessions_.push_back(NewSecret());
    if (sessions_.size() > kMaxSessions) sessions_.pop_front();
    set_cookie = cookie_name_ + "=" + sessions_.back() + "; HttpOnly; SameSite=Strict; Path=/";
    return Exchange::kGranted;
  }
  if (trusted) return Exchange::kWrong;
  if (now < paused_until_) return Exchange::kTooManyGuesses;
  while (!wrong_.empty() && now - wrong_.front() >= kGuessPause) wrong_.pop_front();
  wrong_.push_back(now);
  if (wrong_.size() >= kMaxWrongTokens) {
    wrong_.clear();
    paused_until_ = now + kGuessPause;
  }
  return Exchange::kWrong;
}

bool Access::IsSession(std::string_view value) const {
  bool found = false;
  for (const std::string& session : sessions_) found |= EqualInConstantTime(value, session);
  return found;
}

bool Access::HasSession(const std::vector<std::string>& cookie_headers) const {
  const std::lock_guard lock(mutex_);
  for (const std::string& header : cookie_headers) {
    std::string_view rest = header;
    while (!rest.empty()) {
      const size_t end = rest.find(';');
      const std::string_view pair = WithoutSpaces(rest.substr(0, end));
      rest = end == std::string_view::npos ? std::string_view() : rest.substr(end + 1);
      if (pair.size() > cookie_name_.size() && pair.starts_with(cookie_name_) && pair[cookie_name_.size()] == '=' &&
          IsSession(pair.substr(cookie_name_.size() + 1))) {
        return true;
      }
    }
  }
  return false;
}

}  // namespace skyquilt::viewer::server
