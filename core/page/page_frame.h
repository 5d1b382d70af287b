// The frame of every page the program writes: head, bar with links, title, end. Style and script are inside, so that a page opens offline.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace skyquilt::page {

struct PageFrame {
  std::string title;
  std::string window_title;                                  // of the browser's tab, behind the title
  std::string subtitle;                                      // a line under the title
  std::vector<std::pair<std::string, std::string>> anchors;  // id and name of the sections in the bar
};

// Everything before and after the sections. Texts are escaped here.
std::string PageBegin(const PageFrame& frame);
std::string PageEnd();
// One figure of a row of key figures (section.kpis); `value` and `note` are HTML.
std::string KeyFigure(const std::string& label, const std::string& value, const std::string& note);

std::string PageStyle();   // CSS
std::string PageScript();  // JavaScript

}  // namespace skyquilt::page
