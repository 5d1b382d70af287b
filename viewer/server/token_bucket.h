// Limits a rate: so many events a second, with bursts of twice as many.
#pragma once

#include <algorithm>
#include <chrono>

namespace skyquilt::viewer::server {

class TokenBucket {
 public:
  using Clock = std::chrono::steady_clock;
  TokenBucket(double per_second, Clock::time_point now) : per_second_(per_second), tokens_(2.0 * per_second), last_(now) {}

  // False when the event is above the rate.
  bool Take(Clock::time_point now) {
    tokens_ = std::min(2.0 * per_second_, tokens_ + per_second_ * std::chrono::duration<double>(now - last_).count());
    last_ = now;
    if (tokens_ < 1.0) return false;
    tokens_ -= 1.0;
    return true;
  }

 private:
  double per_second_, tokens_;
  Clock::time_point last_;
};

}  // namespace skyquilt::viewer::server
