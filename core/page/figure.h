// The parts of every chart: the figure around it, lines and texts as inline SVG, and the legend. Coloured by the page's style sheet.
// Titles, names and texts are escaped here. Lengths are in pixels of the drawing, y downwards.
#pragma once

#include <string>

namespace skyquilt::page {

struct Figure {
  std::string title = {};
  double width_px = 560.0, height_px = 300.0;
  std::string css_class = {};  // in addition to the classes of all charts
  std::string spoken = {};     // text for screen readers; empty: the title
};

// Opens the figure and its <svg>.
std::string FigureBegin(const Figure& figure);
// Closes the <svg> and the figure. legend: HTML made by LegendEntry; empty: no legend.
std::string FigureEnd(const std::string& legend = "");
// A complete figure with the text "No data".
std::string EmptyFigure(const std::string& title);
std::string LegendEntry(const std::string& css_class, const std::string& name);

enum class Anchor { kStart, kMiddle, kEnd };

std::string SvgLine(const char* css_class, double x1_px, double x2_px, double y1_px, double y2_px);
std::string SvgText(const char* css_class, double x_px, double y_px, Anchor anchor, const std::string& text);
// steps: path data in SVG syntax. title: shown as a tooltip.
std::string SvgPath(const std::string& css_class, const std::string& steps, const std::string& title);

}  // namespace skyquilt::page
