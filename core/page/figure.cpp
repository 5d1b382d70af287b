#include "core/page/figure.h"

#include <fmt/core.h>

#include "core/page/html.h"

namespace skyquilt::page {

namespace {

std::string Caption(const std::string& title, const std::string& css_class) {
  return fmt::format("<figure class=\"chart card{}{}\"><figcaption>{}</figcaption>", css_class.empty() ? "" : " ", css_class, EscapeHtml(title));
}

const char* NameOf(Anchor anchor) {
  return anchor == Anchor::kStart ? "start" : anchor == Anchor::kMiddle ? "middle" : "end";
}

}  // namespace

std::string FigureBegin(const Figure& figure) {
  return Caption(figure.title, figure.css_class) + fmt::format("<svg viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\" aria-label=\"{}\">", figure.width_px,
                                                               figure.height_px, EscapeHtml(figure.spoken.empty() ? figure.title : figure.spoken));
}

std::string FigureEnd(const std::string& legend) {
  return "</svg>" + (legend.empty() ? "" : "<div class=\"legend\">" + legend + "</div>") + "</figure>\n";
}

std::string EmptyFigure(const std::string& title) {
  return Caption(title, "") + "<p class=\"empty\">No data.</p></figure>\n";
}

std::string LegendEntry(const std::string& css_class, const std::string& name) {
  return fmt::format("<span><i class=\"{}\"></i>{}</span>", css_class, EscapeHtml(name));
}

std::string SvgLine(const char* css_class, double x1_px, double x2_px, double y1_px, double y2_px) {
  return fmt::format("<line class=\"{}\" x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/>", css_class, x1_px, x2_px, y1_px, y2_px);
}

std::string SvgText(const char* css_class, double x_px, double y_px, Anchor anchor, const std::string& text) {
  return fmt::format("<text class=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>", css_class, x_px, y_px, NameOf(anchor),
                     EscapeHtml(text));
}

std::string SvgPath(const std::string& css_class, const std::string& steps, const std::string& title) {
  return fmt::format("<path class=\"{}\" d=\"{}\"><title>{}</title></path>", css_class, steps, EscapeHtml(title));
}

}  // namespace skyquilt::page
