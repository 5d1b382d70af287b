// The frame of a chart with two axes: maps values to pixels, and draws grid, ticks and labels.
#pragma once

#include <string>
#include <vector>

namespace skyquilt::page {

// Positions of the ticks of an axis. About `count` round numbers (multiples of 1, 2 or 5 times a power of ten) inside [low, high]. Empty for an empty
// or infinite range.
std::vector<double> RoundTicks(double low, double high, int count);
// Decimal logarithms of round numbers inside the range: powers of ten, and numbers between them when there are only few.
std::vector<double> LogTicks(double low_log10, double high_log10);
// "10", "0.05", "25.0 k": as many digits as the number needs.
std::string TickLabel(double value);

struct PlotAxis {
  std::string label = {};  // with unit
  double low = 0.0, high = 1.0;
  int ticks = 5;             // approximate number
  bool logarithmic = false;  // low, high and all drawn values are decimal logarithms

  void Include(double value);  // extends the axis to the value
  void Pad(double by);         // extends both ends
};

struct PlotFrame {
  // Distances from the edges of the drawing to the axes.
  static constexpr double kLeft_px = 52.0, kRight_px = 14.0, kTop_px = 14.0, kBottom_px = 42.0;

  std::string title = {};
  PlotAxis x = {}, y = {};
  double width_px = 560.0, height_px = 300.0;
  std::string css_class = {};
  bool zero_stands_out = false;  // draw the line at y = 0 like an axis

  double right_px() const { return width_px - kRight_px; }
  double bottom_px() const { return height_px - kBottom_px; }
  // Position of a value in the drawing.
  double X(double value) const { return kLeft_px + (value - x.low) / (x.high - x.low) * (right_px() - kLeft_px); }
  double Y(double value) const { return bottom_px() - (value - y.low) / (y.high - y.low) * (bottom_px() - kTop_px); }
};

// Opens the figure and draws everything but the data. Append the data, then FigureEnd.
std::string PlotBegin(const PlotFrame& frame);

}  // namespace skyquilt::page
