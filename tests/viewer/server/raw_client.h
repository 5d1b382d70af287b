// A blocking client that sends any bytes, for tests of the viewer's server.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace skyquilt::viewer {

struct HttpReply {
  int status = 0;
  std::map<std::string, std::string> headers;  // names in lower case
  std::string body;
};

struct Frame {
  int opcode = 0;  // 1 text, 2 binary, 8 close, 9 ping, 10 pong
  bool fin = false;
  std::string payload;
  int close_code() const;  // 0 when it is none
};

struct FrameOptions {
  bool fin = true;
  bool masked = true;
  int reserved = 0;  // the three reserved bits
};
// A frame as a client sends it.
std::string MakeFrame(int opcode, std::string_view payload, const FrameOptions& options = {});

class RawClient {
 public:
  // receive_buffer: of the socket, 0: the system's. Reading fails after 5 s.
  explicit RawClient(int port, int receive_buffer = 0);
  ~RawClient();
  RawClient(const RawClient&) = delete;
  RawClient& operator=(const RawClient&) = delete;

  // False when the server has closed the connection.
  bool Send(std::string_view bytes);
  // Nothing when the connection was closed, or nothing came. head: the answer has no body.
  std::optional<HttpReply> ReadReply(bool head = false);
  std::optional<Frame> ReadFrame();
  // Reads until the server closes; false when it does not. A close by reset counts, too.
  bool ReadToEnd();
  // Whether the server has closed, without waiting.
  bool IsClosed();

 private:
  bool Fill();
  bool Need(size_t bytes);
  int socket_ = -1;
  bool ended_ = false;
  std::string input_;
};

}  // namespace skyquilt::viewer
