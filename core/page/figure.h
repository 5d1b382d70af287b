// What every chart is made of: the figure around it, its lines and texts as inline SVG, its legend. Coloured by the page's style sheet.
// Titles, names and texts are escaped here; lengths are in pixels of the drawing, y downwards.
#pragma once

#include <string>

namespace skyquilt::page {

struct Figure {
  std::string title = {};
  double width_px = 560.0, height_px = 300.0;
  std::string css_class = {};  // beside those of all charts
  std::string spoken = {};     // read out instead of the title where that says too little
};

// Up to the opened <svg>.
std::string FigureBegin(const Figure& figure);
// From the end of the <svg>; `legend` is HTML, of LegendEntry. Without it there is no legend.
std::string FigureEnd(const std::string& legend = "");
// A whole figure that says "no data".
std::string EmptyFigure(const std::string& title);
std::string LegendEntry(const std::string& css_class, const std::string& name);

enum class Anchor { kStart, kMiddle, kEnd };

std::string SvgLine(const char* css_class, double x1_px, double x2_px, double y1_px, double y2_px);
std::string SvgText(const char* css_class, double x_px, double y_px, Anchor anchor, const std::string& text);
// `steps` is the path's data; `title` shows where the mouse rests.
std::string SvgPath(const std::string& css_class, const std::string& steps, const std::string& title);

}  // namespace skyquilt::page
