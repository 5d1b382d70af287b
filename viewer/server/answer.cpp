#include "viewer/server/answer.h"

#include <algorithm>

namespace skyquilt::viewer::server {
namespace {

const char* Reason(int status) {
  switch (status) {
    case 200:
      return "OK";
    case 201:
      return "Created";
    case 204:
      return "No Content";
    case 303:
      return "See Other";
    case 400:
      return "Bad Request";
    case 403:
      return "Forbidden";
    case 404:
      return "Not Found";
    case 405:
      return "Method Not Allowed";
    case 409:
      return "Conflict";
    case 411:
      return "Length Required";
    case 412:
      return "Precondition Failed";
    case 413:
      return "Payload Too Large";
    case 414:
      return "URI Too Long";
    case 415:
      return "Unsupported Media Type";
    case 422:
      return "Unprocessable Entity";
    case 426:
      return "Upgrade Required";
    case 429:
      return "Too Many Requests";
    case 431:
      return "Request Header Fields Too Large";
    case 500:
      return "Internal Server Error";
    case 503:
      return "Service Unavailable";
    case 507:
      return "Insufficient Storage";
    default:
      return "Status";
  }
}

bool IsPrintable(const std::string& text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return c >= ' ' && c <= '~'; });
}

}  // namespace

Answer PlainAnswer(int status, const std::string& text) {
  return {.status = status, .content_type = "text/plain; charset=utf-8", .body = std::make_shared<const std::string>(text + "\n"), .file = {}};
}

std::string EscapeHtml(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      case '\'':
        escaped += "&#39;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

Answer PageAnswer(int status, const std::string& title, const std::vector<std::string>& paragraphs, const std::string& link_text) {
  std::string html = "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" content=\"width=device-width\">";
  html += "<link rel=\"icon\" href=\"data:,\"><title>" + EscapeHtml(title) + "</title></head>\n<body><h1>" + EscapeHtml(title) + "</h1>\n";
  for (const std::string& paragraph : paragraphs) html += "<p>" + EscapeHtml(paragraph) + "</p>\n";
  if (!link_text.empty()) html += "<p><a href=\"/\">" + EscapeHtml(link_text) + "</a></p>\n";
  html += "</body></html>\n";
  return {.status = status, .content_type = "text/html; charset=utf-8", .body = std::make_shared<const std::string>(std::move(html)), .file = {}};
}

Answer DataAnswer(DataReply reply) {
  if (reply.status < 200 || reply.status > 599) return PlainAnswer(500, "the viewer made an invalid answer");
  Answer answer{.status = reply.status, .content_type = std::move(reply.content_type), .body = {}, .file = std::move(reply.file)};
  answer.body = reply.kept != nullptr ? std::move(reply.kept) : std::make_shared<const std::string>(std::move(reply.body));
  const bool is_tag = !reply.etag.empty() && IsPrintable(reply.etag) && reply.etag.find('"') == std::string::npos;
  if (is_tag) answer.headers.emplace_back("ETag", "\"" + reply.etag + "\"");
  answer.cache = reply.cache;
  return answer;
}

Headers SecurityHeaders(const std::string& host) {
  const std::string websocket = host.empty() ? "" : " ws://" + host;
  return {{"Content-Security-Policy", "default-src 'self'; connect-src 'self' blob:" + websocket +
                                          "; img-src 'self' blob: data:; style-src 'self'; script-src 'self'; worker-src 'self' blob:; "
                                          "object-src 'none'; base-uri 'none'; frame-ancestors 'none'; form-action 'none'"},
          {"X-Content-Type-Options", "nosniff"},
          {"Referrer-Policy", "no-referrer"},
          {"Cross-Origin-Opener-Policy", "same-origin"},
          {"Cross-Origin-Resource-Policy", "same-origin"}};
}

std::string FormatHead(const Answer& answer, uint64_t body_bytes, bool keep_alive, const std::string& host) {
  std::string head = "HTTP/1.1 " + std::to_string(answer.status) + " " + Reason(answer.status) + "\r\n";
  const auto add = [&head](const std::string& name, const std::string& value) { head.append(name).append(": ").append(value).append("\r\n"); };
  for (const auto& [name, value] : SecurityHeaders(host)) add(name, value);
  for (const auto& [name, value] : answer.headers) add(name, value);
  add("Cache-Control", answer.cache ? "private, max-age=3600" : "no-store");
  // 204 and 304 never have a body, and a length would make clients wait for one.
  if (answer.status != 204 && answer.status != 304) {
    add("Content-Type", answer.content_type.empty() || !IsPrintable(answer.content_type) ? "application/octet-stream" : answer.content_type);
    add("Content-Length", std::to_string(body_bytes));
  }
  add("Connection", keep_alive ? "keep-alive" : "close");
  return head + "\r\n";
}

}  // namespace skyquilt::viewer::server
