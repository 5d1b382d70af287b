// The frame of every HTML page the program writes: head, bar with links, title, end. Style and script are embedded, so that a page can be opened
// offline.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace skyquilt::page {

struct PageFrame {
  std::string title;
  std::string window_title;                                  // follows the title in the browser's tab
  std::string subtitle;                                      // line under the title
  std::vector<std::pair<std::string, std::string>> anchors;  // id and name of the sections linked in the bar
};

// Everything before and after the sections. The texts of `frame` are escaped here.
std::string PageBegin(const PageFrame& frame);
std::string PageEnd();
// One number of a row of key figures (section.kpis); `value` and `note` are HTML, `label` is escaped.
std::string KeyFigure(const std::string& label, const std::string& value, const std::string& note);

std::string PageStyle();   // CSS
std::string PageScript();  // JavaScript

}  // namespace skyquilt::page
