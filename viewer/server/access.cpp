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

Access::Access(std::string cookie_name, const std::vector<Right>& rights) : cookie_name_(std::move(cookie_name)) {
  for (const Right right : rights) tokens_[right] = NewSecret();
}

std::string Access::token(Right right) const {
  const std::lock_guard lock(mutex_);
  return tokens_.at(right);
}

Access::Exchange Access::TryToken(std::string_view token, bool trusted, Clock::time_point now, Grant& grant) {
  const std::lock_guard lock(mutex_);
  // First of all: strangers' guesses must not lock out whoever has the link. A token is too long to be guessed meanwhile.
  for (auto& [right, secret] : tokens_) {
    if (!EqualInConstantTime(token, secret)) continue;
    secret = NewSecret();
    sessions_.push_back({.secret = NewSecret(), .right = right});
    if (sessions_.size() > kMaxSessions) sessions_.pop_front();
    grant = {.set_cookie = cookie_name_ + "=" + sessions_.back().secret + "; HttpOnly; SameSite=Strict; Path=/", .right = right};
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

std::optional<Right> Access::RightOf(std::string_view secret) const {
  std::optional<Right> right;
  for (const Session& session : sessions_) {
    if (EqualInConstantTime(secret, session.secret)) right = session.right;
  }
  return right;
}

std::optional<Right> Access::SessionRight(const std::vector<std::string>& cookie_headers) const {
  const std::lock_guard lock(mutex_);
  for (const std::string& header : cookie_headers) {
    std::string_view rest = header;
    while (!rest.empty()) {
      const size_t end = rest.find(';');
      const std::string_view pair = WithoutSpaces(rest.substr(0, end));
      rest = end == std::string_view::npos ? std::string_view() : rest.substr(end + 1);
      if (pair.size() <= cookie_name_.size() || !pair.starts_with(cookie_name_) || pair[cookie_name_.size()] != '=') continue;
      if (const auto right = RightOf(pair.substr(cookie_name_.size() + 1))) return right;
    }
  }
  return {};
}

}  // namespace skyquilt::viewer::server
