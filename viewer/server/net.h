// The types of Boost.Asio and Boost.Beast that the connections use.
#pragma once

// <utility> first: asio 1.74 forgets it.
#include <utility>
//
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/basic_stream.hpp>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace skyquilt::viewer::server {

namespace asio = boost::asio;
namespace beast = boost::beast;
using tcp = asio::ip::tcp;

// Limits nothing; counts what passes, so that a connection without progress is seen in the middle of a message.
class Traffic {
 public:
  uint64_t received() const { return received_; }
  uint64_t sent() const { return sent_; }

 private:
  friend class beast::rate_policy_access;
  static size_t available_read_bytes() { return std::numeric_limits<size_t>::max(); }
  static size_t available_write_bytes() { return std::numeric_limits<size_t>::max(); }
  void transfer_read_bytes(size_t bytes) { received_ += bytes; }
  void transfer_write_bytes(size_t bytes) { sent_ += bytes; }
  void on_timer() {}

  uint64_t received_ = 0, sent_ = 0;
};

using Stream = beast::basic_stream<tcp, asio::any_io_executor, Traffic>;

inline std::chrono::nanoseconds Seconds(double seconds) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::duration<double>(seconds));
}

}  // namespace skyquilt::viewer::server
