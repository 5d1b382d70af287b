// Pieces of HTML that several sections of the report's page are made of. Titles, headings, sentences, values and legends are HTML; other texts are
// escaped here.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>
#include <vector>

#include "core/page/html.h"

namespace skyquilt::evaluate::page {

using namespace skyquilt::page;  // This page is made of the parts of every page of the program, and of those here.

inline constexpr const char* kDegree = "\xC2\xB0";

// Opens a <section> of the page with its title, and `beside` on the same line.
std::string SectionBegin(const char* id, const char* title, const std::string& beside = "");
// Opens a <div> of a section with its title, and what is to be known first.
std::string BlockBegin(const std::string& title, const std::string& lead = "");
// Paragraphs: what is to be known first, what is said below, and that there is nothing to show.
inline std::string Lead(const std::string& sentences) {
  return "<p class=\"lead\">" + sentences + "</p>";
}
inline std::string Note(const std::string& sentences) {
  return "<p class=\"note\">" + sentences + "</p>";
}
inline std::string EmptyCard(const std::string& sentence) {
  return "<p class=\"card empty\">" + sentence + "</p>";
}
// A row of small figures: what Chip made.
inline std::string Chips(const std::string& chips) {
  return "<div class=\"chips\">" + chips + "</div>";
}

// Headings of columns of texts, and of numbers.
std::string Headings(std::initializer_list<const char*> names);
std::string NumberHeadings(std::initializer_list<const char*> names);
// Opens a table up to its first row. css_class: sortable where the reader can sort it by a column.
std::string TableBegin(const std::string& headings, const std::string& css_class = "sortable");
inline constexpr const char* kTableEnd = "</tbody></table></div>";
// Cells of numbers, by which the table sorts, as FormatFixed, FormatInteger and FormatPercent show them.
inline std::string FixedCell(double value, int decimals, const char* unit = "") {
  return NumberCell(value, FormatFixed(value, decimals, unit));
}
inline std::string CountCell(int64_t count) {
  return NumberCell(static_cast<double>(count), FormatInteger(count));
}
inline std::string PercentCell(double share, int decimals = 1) {
  return NumberCell(share, FormatPercent(share, decimals));
}
// With a bar over this share of the cell.
std::string BarCell(double value, double share, const std::string& shown);
// A word about the state of something. kind: good, warn, bad or idle.
inline std::string State(const std::string& kind, const std::string& word) {
  return "<span class=\"state " + kind + "\">" + word + "</span>";
}

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
