#include "evaluate/page/page_parts.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "evaluate/measured.h"

namespace skyquilt::evaluate::page {

std::string SectionBegin(const char* id, const char* title, const std::string& beside) {
  return fmt::format("<section id=\"{}\"><div class=\"heading\"><h2>{}</h2>{}</div>", id, title, beside);
}

std::string BlockBegin(const std::string& title, const std::string& lead) {
  return fmt::format("<div class=\"block\"><h3>{}</h3>{}", title, lead.empty() ? "" : Lead(lead));
}

std::string Headings(std::initializer_list<const char*> names) {
  std::string html;
  for (const char* name : names) html += fmt::format("<th>{}</th>", name);
  return html;
}

std::string NumberHeadings(std::initializer_list<const char*> names) {
  std::string html;
  for (const char* name : names) html += fmt::format("<th class=\"num\">{}</th>", name);
  return html;
}

std::string TableBegin(const std::string& headings, const std::string& css_class) {
  return fmt::format("<div class=\"card scroll\"><table{}><thead><tr>{}</tr></thead><tbody>",
                     css_class.empty() ? "" : fmt::format(" class=\"{}\"", css_class), headings);
}

std::string BarCell(double value, double share, const std::string& shown) {
  return fmt::format("<td class=\"num bar\" data-v=\"{}\"><i style=\"--share:{:.3f}\"></i>{}</td>", value, share, shown);
}

void FigureTable::Group(const char* name) {
  html_ += fmt::format("{}<tbody><tr class=\"group\"><th colspan=\"3\" scope=\"rowgroup\">{}</th></tr>", html_.empty() ? "" : "</tbody>", name);
}

void FigureTable::Row(const std::string& name, const std::string& value, const std::string& meaning) {
  html_ += "<tr>" + TextCell(name) + "<td class=\"num\">" + value + "</td>" + TextCell(meaning) + "</tr>";
}

std::string FigureTable::Html() const {
  return "<div class=\"card scroll\"><table class=\"figures\"><thead><tr>" + Headings({"Figure"}) + NumberHeadings({"Value"}) +
         Headings({"Meaning"}) + "</tr></thead>" + html_ + kTableEnd + "\n";
}

std::string Chip(const std::string& label, const std::string& value, const std::string& css_class) {
  return fmt::format("<span class=\"chip{}{}\"><b>{}</b>{}</span>", css_class.empty() ? "" : " ", css_class, value, EscapeHtml(label));
}

std::string Picture(const std::string& kind, const std::string& file, int width, int height, const std::string& caption, const std::string& legend) {
  if (file.empty()) return "";
  return fmt::format(
      "<figure class=\"pic {0}\"><img src=\"{1}\" width=\"{2}\" height=\"{3}\" loading=\"lazy\" alt=\"{4}\" data-kind=\"{0}\"><figcaption>{4}{5}"
      "</figcaption></figure>",
      kind, EscapeHtml(file), width, height, EscapeHtml(caption), legend);
}

std::string BarRow(const std::string& name, double percent, const std::string& value) {
  return fmt::format("<div class=\"row\">{}<span><i style=\"width:{:.1f}%\"></i></span><b>{}</b></div>", name, percent, value);
}

std::string Fact(const std::string& name, const std::string& value) {
  return fmt::format("<dt>{}</dt><dd>{}</dd>", EscapeHtml(name), value);
}

std::string RangeOf(const std::vector<double>& values, int decimals, const char* unit) {
  if (values.empty()) return FormatFixed(kNotMeasured, decimals);
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  const std::string low_text = FormatFixed(*low, decimals), high_text = FormatFixed(*high, decimals, unit);
  return FormatFixed(*low, decimals, unit) == high_text ? high_text : low_text + " \xE2\x80\x93 " + high_text;
}

std::string TwoDigits(double value, const char* unit) {
  const double size = std::abs(value);
  // Limits half a unit below the powers of ten: 9.96 becomes 10, not 10.0.
  int decimals = 0;
  for (double limit = 9.95; decimals < 4 && size < limit; limit /= 10.0) ++decimals;
  return FormatFixed(value, std::isfinite(value) && size > 0.0 ? decimals : 0, unit);
}

std::string ShownDuration(double seconds) {
  return skyquilt::page::FormatDuration(seconds);
}

std::string ShownDate(const std::string& utc_timestamp) {
  const bool known = utc_timestamp.size() == 20 && utc_timestamp[10] == 'T' && utc_timestamp[19] == 'Z';
  return known ? utc_timestamp.substr(0, 10) + " " + utc_timestamp.substr(11, 5) + " UTC" : utc_timestamp;
}

}  // namespace skyquilt::evaluate::page
