#include "viewer/server/access.h"

#include <sys/random.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <system_error>
#include <utility>

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

std::string NewSecret() {
  std::array<uint8_t, 32> bytes{};
  size_t filled = 0;
  while (filled < bytes.size()) {
    const ssize_t got = getrandom(bytes.data() + filled, bytes.size() - filled, 0);
    if (got < 0 && errno != EINTR) throw std::system_error(errno, std::generic_category(), "cannot get random numbers from the system");
    if (got > 0) filled += static_cast<size_t>(got);
  }
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  for (const uint8_t byte : bytes) {
    text += kDigits[byte >> 4U];
    text += kDigits[byte & 15U];
  }
  return text;
}

bool EqualInConstantTime(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  // volatile keeps the compiler from leaving the loop early.
  volatile unsigned difference = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    difference = difference | (static_cast<unsigned char>(a[i]) ^ static_cast<unsigned>(static_cast<unsigned char>(b[i])));
  }
  return difference == 0;
}

}  // namespace skyquilt::viewer::server
