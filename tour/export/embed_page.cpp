#include "tour/export/embed_page.h"

#include "core/page/html.h"

namespace skyquilt::tour {
namespace {

std::string Snippet(const std::string& address, const std::string& title) {
  return "<iframe src=\"" + page::EscapeHtml(address) + "\" title=\"" + page::EscapeHtml(title) +
         "\" width=\"960\" height=\"540\" allow=\"fullscreen\" style=\"border: 0; max-width: 100%\"></iframe>";
}

}  // namespace

std::string EmbedPage(const std::string& title) {
  const std::string name = title.empty() ? "Virtual tour" : title;
  return "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" content=\"width=device-width\">\n<title>" +
         page::EscapeHtml(name) +
         "</title>\n</head>\n<body>\n"
         "<p>To show this tour in a page of yours, put this folder on a web server, copy these lines into the page, and replace the address by that "
         "of "
         "the folder:</p>\n<pre>" +
         page::EscapeHtml(Snippet("https://example.org/tour/index.html", name)) + "</pre>\n<p>It then looks like this:</p>\n" +
         Snippet("index.html", name) + "\n</body>\n</html>\n";
}

}  // namespace skyquilt::tour
