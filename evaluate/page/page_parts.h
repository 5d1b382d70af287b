// Pieces of HTML that several sections of the report's page are made of. Values and legends are HTML; other texts are escaped here.
#pragma once

#include <string>
#include <vector>

#include "core/page/html.h"

namespace skyquilt::evaluate::page {

using namespace skyquilt::page;  // This page is made of the parts of every page of the program, and of those here.

inline constexpr const char* kDegree = "\xC2\xB0";

// A table of figures in groups: name, value and what it means in one sentence. Values are HTML.
class FigureTable {
 public:
  void Group(const char* name);
  void Row(const std::string& name, const std::string& value, const std::string& meaning);
  std::string Html() const;

 private:
  std::string html_;
};

// A small figure with its name, in a row of such.
std::string Chip(const std::string& label, const std::string& value, const std::string& css_class = "");
// A picture with its caption; nothing without a file. kind: its class, by which the page's script finds it.
std::string Picture(const std::string& kind, const std::string& file, int width, int height, const std::string& caption,
                    const std::string& legend = "");
// A bar of `percent` of the room there is, between a name (HTML) and a value.
std::string BarRow(const std::string& name, double percent, const std::string& value);
// An entry of a list of facts (<dl>).
std::string Fact(const std::string& name, const std::string& value);
// One figure for equal values, otherwise the range; an en dash for none.
std::string RangeOf(const std::vector<double>& values, int decimals, const char* unit);
// With two digits, as an uncertainty deserves: "0.0034 m", "1.6 m", "120 m"; an en dash for NaN.
std::string TwoDigits(double value, const char* unit);
// "24.5 s", "10 min 24 s", "2 h 05 min"; an en dash for what is not measured.
std::string ShownDuration(double seconds);
// "2026-01-31T12:00:00Z" as "2026-01-31 12:00 UTC"; other texts stay as they are.
std::string ShownDate(const std::string& utc_timestamp);

}  // namespace skyquilt::evaluate::page
