// An answer to an HTTP request, and its head as text.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "viewer/server/server.h"

namespace skyquilt::viewer::server {

using Headers = std::vector<std::pair<std::string, std::string>>;

struct Answer {
  int status = 200;
  std::string content_type;
  std::shared_ptr<const std::string> body;  // null: empty
  std::filesystem::path file;               // sent instead of the body when not empty
  bool cache = false;
  Headers headers = {};  // beside those that every answer has
};

Answer PlainAnswer(int status, const std::string& text);
// A small page without script and style. Title and paragraphs are plain text, which is escaped; link: a fixed path with its text.
Answer PageAnswer(int status, const std::string& title, const std::vector<std::string>& paragraphs, const std::string& link_text = "");
Answer DataAnswer(DataReply reply);

std::string EscapeHtml(const std::string& text);

// What every answer carries. host: the Host header once it has been checked, else empty; it names the WebSocket in the content security policy.
Headers SecurityHeaders(const std::string& host);

// Status line and headers up to the empty line.
std::string FormatHead(const Answer& answer, uint64_t body_bytes, bool keep_alive, const std::string& host);

}  // namespace skyquilt::viewer::server
