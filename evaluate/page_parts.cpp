#include "evaluate/page_parts.h"

#include <spdlog/fmt/fmt.h>

#include "core/page/html.h"

namespace skyquilt::evaluate {

std::string Chip(const std::string& label, const std::string& value, const std::string& css_class) {
  return fmt::format("<span class=\"chip{}{}\"><b>{}</b>{}</span>", css_class.empty() ? "" : " ", css_class, value, page::EscapeHtml(label));
}

std::string Picture(const std::string& kind, const std::string& file, int width, int height, const std::string& caption, const std::string& legend) {
  if (file.empty()) return "";
  return fmt::format(
      "<figure class=\"pic {0}\"><img src=\"{1}\" width=\"{2}\" height=\"{3}\" loading=\"lazy\" alt=\"{4}\" data-kind=\"{0}\"><figcaption>{4}{5}"
      "</figcaption></figure>",
      kind, page::EscapeHtml(file), width, height, page::EscapeHtml(caption), legend);
}

std::string BarRow(const std::string& name, double percent, const std::string& value) {
  return fmt::format("<div class=\"row\">{}<span><i style=\"width:{:.1f}%\"></i></span><b>{}</b></div>", name, percent, value);
}

std::string Fact(const std::string& name, const std::string& value) {
  return fmt::format("<dt>{}</dt><dd>{}</dd>", page::EscapeHtml(name), value);
}

}  // namespace skyquilt::evaluate
