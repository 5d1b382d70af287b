#include "core/page/page_frame.h"

#include <fmt/core.h>

#include "core/page/html.h"

namespace skyquilt::page {
namespace {

constexpr const char* kLogo =
    "<svg class=\"logo\" viewBox=\"0 0 24 24\" aria-hidden=\"true\"><path class=\"q1\" d=\"M2 2h9v9H2z\"/><path class=\"q2\" d=\"M13 2h9v9h-9z\"/>"
    "<path class=\"q3\" d=\"M2 13h9v9H2z\"/><path class=\"q4\" d=\"M13 13h9v9h-9z\"/></svg>";

}  // namespace

std::string PageBegin(const PageFrame& frame) {
  const std::string title = EscapeHtml(frame.title);
  std::string links;
  for (const auto& [id, name] : frame.anchors) links += fmt::format("<a href=\"#{}\">{}</a>", EscapeHtml(id), EscapeHtml(name));
  return "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">"
         "<meta name=\"color-scheme\" content=\"light dark\"><title>" +
         title + " \xC2\xB7 " + EscapeHtml(frame.window_title) + "</title><style>" + PageStyle() + "</style></head><body>\n" +
         fmt::format(
             "<div class=\"topbar\"><div class=\"inner\"><a class=\"brand\" href=\"#top\">{}<b>Skyquilt</b></a><nav>{}</nav>"
             "<button id=\"theme\" title=\"Switch between light and dark\" aria-label=\"Switch between light and dark\">"
             "<svg viewBox=\"0 0 24 24\"><path d=\"M12 3a9 9 0 1 0 9 9 7 7 0 0 1-9-9z\"/></svg></button></div></div><main id=\"top\">\n"
             "<header class=\"title\"><h1>{}</h1><p>{}</p></header>\n",
             kLogo, links, title, EscapeHtml(frame.subtitle));
}

std::string PageEnd() {
  return "</main><dialog id=\"viewer\"><button aria-label=\"Close\">\xC3\x97</button><div></div><p></p></dialog><script>" + PageScript() +
         "</script></body></html>\n";
}

std::string KeyFigure(const std::string& label, const std::string& value, const std::string& note) {
  return fmt::format("<div class=\"kpi\"><span>{}</span><strong>{}</strong><small>{}</small></div>", EscapeHtml(label), value, note);
}

}  // namespace skyquilt::page
