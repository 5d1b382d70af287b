#include "tests/viewer/server/raw_client.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <stdexcept>

namespace skyquilt::viewer {

int Frame::close_code() const {
  if (opcode != 8 || payload.size() < 2) return 0;
  return static_cast<unsigned char>(payload[0]) * 256 + static_cast<unsigned char>(payload[1]);
}

std::string MakeFrame(int opcode, std::string_view payload, const FrameOptions& options) {
  std::string frame;
  const auto add = [&frame](size_t byte) { frame += static_cast<char>(static_cast<unsigned char>(byte & 255U)); };
  add((options.fin ? 128U : 0U) | (static_cast<size_t>(options.reserved) << 4U) | static_cast<size_t>(opcode));
  const size_t mask_bit = options.masked ? 128U : 0U;
  if (payload.size() < 126) {
    add(mask_bit | payload.size());
  } else if (payload.size() < 65536) {
    add(mask_bit | 126U);
    add(payload.size() >> 8U);
    add(payload.size());
  } else {
    add(mask_bit | 127U);
    for (int shift = 56; shift >= 0; shift -= 8) add(payload.size() >> static_cast<unsigned>(shift));
  }
  constexpr std::string_view kMask = "\x12\x34\x56\x78";
  if (options.masked) frame += kMask;
  for (size_t i = 0; i < payload.size(); ++i) frame += static_cast<char>(options.masked ? payload[i] ^ kMask[i % 4] : payload[i]);
  return frame;
}

RawClient::RawClient(int port, int receive_buffer) : socket_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  const timeval timeout{.tv_sec = 5, .tv_usec = 0};
  setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &timeout, sizeof(timeout));
  setsockopt(socket_, SOL_SOCKET, SO_SNDTIMEO, &timeout, sizeof(timeout));
  if (receive_buffer > 0) setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &receive_buffer, sizeof(receive_buffer));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) throw std::runtime_error("cannot connect");
}

RawClient::~RawClient() {
  close(socket_);
}

bool RawClient::Send(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t sent = send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent <= 0) return false;
    bytes.remove_prefix(static_cast<size_t>(sent));
  }
  return true;
}

bool RawClient::Fill() {
  std::array<char, 65536> bytes{};
  const ssize_t got = recv(socket_, bytes.data(), bytes.size(), 0);
  if (got == 0 || (got < 0 && errno != EAGAIN && errno != EWOULDBLOCK)) ended_ = true;
  if (got <= 0) return false;
  input_.append(bytes.data(), static_cast<size_t>(got));
  return true;
}

bool RawClient::Need(size_t bytes) {
  while (input_.size() < bytes) {
    if (!Fill()) return false;
  }
  return true;
}

bool RawClient::ReadToEnd() {
  while (Fill()) input_.clear();
  return ended_;
}

bool RawClient::IsClosed() {
  char byte = 0;
  const ssize_t got = recv(socket_, &byte, 1, MSG_PEEK | MSG_DONTWAIT);
  return got == 0 || (got < 0 && errno != EAGAIN && errno != EWOULDBLOCK);
}

std::optional<HttpReply> RawClient::ReadReply(bool head) {
  size_t end = 0;
  while ((end = input_.find("\r\n\r\n")) == std::string::npos) {
    if (!Fill()) return {};
  }
  HttpReply reply;
  reply.status = std::atoi(input_.substr(9, 3).c_str());
  size_t at = input_.find("\r\n") + 2;
  while (at < end) {
    const size_t line_end = input_.find("\r\n", at), colon = input_.find(": ", at);
    std::string name = input_.substr(at, colon - at);
    for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    reply.headers[name] = input_.substr(colon + 2, line_end - colon - 2);
    at = line_end + 2;
  }
  input_.erase(0, end + 4);
  const size_t length = head || reply.headers.count("content-length") == 0 ? 0 : std::stoul(reply.headers["content-length"]);
  if (!Need(length)) return {};
  reply.body = input_.substr(0, length);
  input_.erase(0, length);
  return reply;
}

std::optional<Frame> RawClient::ReadFrame() {
  const auto byte = [this](size_t i) { return static_cast<size_t>(static_cast<unsigned char>(input_[i])); };
  if (!Need(2)) return {};
  Frame frame{.opcode = static_cast<int>(byte(0) & 15U), .fin = (byte(0) & 128U) != 0, .payload = {}};
  size_t length = byte(1) & 127U, header = 2;
  if (length >= 126) {
    const size_t digits = length == 126 ? 2 : 8;
    header += digits;
    if (!Need(header)) return {};
    length = 0;
    for (size_t i = 0; i < digits; ++i) length = length * 256 + byte(2 + i);
  }
  if (!Need(header + length)) return {};
  frame.payload = input_.substr(header, length);
  input_.erase(0, header + length);
  return frame;
}

}  // namespace skyquilt::viewer
