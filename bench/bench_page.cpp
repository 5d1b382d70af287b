#include "bench/bench_page.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "core/base/amounts.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/system.h"
#include "core/page/html.h"
#include "core/page/page_frame.h"

namespace skyquilt::bench {
namespace {

// Number of characters of a UTF-8 text.
size_t Width(const std::string& text) {
  return static_cast<size_t>(std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

std::string PadTo(const std::string& text, size_t width, bool right) {
  const std::string space(width - std::min(width, Width(text)), ' ');
  return right ? space + text : text + space;
}

// Columns with numbers are right-aligned.
bool IsNumeric(const BenchTable& table, size_t column) {
  return std::any_of(table.rows.begin(), table.rows.end(), [column](const auto& row) { return !std::isnan(row.at(column).value); });
}

std::string TextTable(const BenchTable& table) {
  std::vector<size_t> widths;
  for (size_t c = 0; c < table.columns.size(); ++c) {
    widths.push_back(Width(table.columns[c]));
    for (const auto& row : table.rows) widths[c] = std::max(widths[c], Width(row.at(c).shown));
  }
  const auto line = [&](const auto& cell_text) {
    std::string text = " ";
    for (size_t c = 0; c < table.columns.size(); ++c) text += " " + PadTo(cell_text(c), widths[c], IsNumeric(table, c)) + " ";
    return text.substr(0, text.find_last_not_of(' ') + 1) + "\n";
  };
  std::string text = table.title.empty() ? "" : table.title + "\n";
  text += line([&](size_t c) { return table.columns[c]; });
  for (const auto& row : table.rows) text += line([&](size_t c) { return row[c].shown; });
  return table.note.empty() ? text : text + "  " + table.note + "\n";
}

std::string HtmlTable(const BenchTable& table) {
  std::string html = table.title.empty() ? "" : "<h3>" + page::EscapeHtml(table.title) + "</h3>";
  html += "<div class=\"card scroll\"><table class=\"sortable\"><thead><tr>";
  for (size_t c = 0; c < table.columns.size(); ++c) {
    html += fmt::format("<th{}>{}</th>", IsNumeric(table, c) ? " class=\"num\"" : "", page::EscapeHtml(table.columns[c]));
  }
  html += "</tr></thead><tbody>";
  for (const auto& row : table.rows) {
    html += "<tr>";
    for (size_t c = 0; c < row.size(); ++c) {
      html += IsNumeric(table, c) ? page::NumberCell(row[c].value, page::EscapeHtml(row[c].shown)) : page::TextCell(row[c].shown);
    }
    html += "</tr>";
  }
  html += "</tbody></table></div>";
  return table.note.empty() ? html : html + "<p class=\"note\">" + page::EscapeHtml(table.note) + "</p>";
}

std::string HtmlPictures(const std::vector<BenchPicture>& pictures, bool magnified) {
  if (pictures.empty()) return "";
  std::string html = magnified ? "<div class=\"pics magnified\">" : "<div class=\"pics\">";
  for (const BenchPicture& picture : pictures) {
    html += fmt::format(
        "<figure class=\"pic\"><div class=\"pane\"><img src=\"{}\" alt=\"{}\" loading=\"lazy\"></div><figcaption>{}</figcaption></figure>",
        page::EscapeHtml(picture.file), page::EscapeHtml(picture.caption), page::EscapeHtml(picture.caption));
  }
  return html + "</div>";
}

std::string HtmlSection(const BenchSection& section) {
  std::string html =
      fmt::format("<section id=\"{}\"><div class=\"heading\"><h2>{}</h2></div>", page::EscapeHtml(section.id), page::EscapeHtml(section.title));
  if (!section.lead.empty()) html += "<p class=\"lead\">" + page::EscapeHtml(section.lead) + "</p>";
  if (!section.charts.empty()) {
    html += "<div class=\"chart-grid\">";
    for (const std::string& chart : section.charts) html += chart;
    html += "</div>";
  }
  for (const BenchTable& table : section.tables) html += "<div class=\"block\">" + HtmlTable(table) + "</div>";
  return html + HtmlPictures(section.pictures, section.magnified) + "</section>\n";
}

// In quotes when the text contains a comma, a quote or a line break; quotes in it are doubled.
std::string CsvText(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

}  // namespace

BenchCell BenchCell::Number(double value, int decimals, const std::string& unit) {
  return {page::FormatFixed(value, decimals, unit), value};
}

BenchCell BenchCell::Percent(double share, int decimals) {
  return {page::FormatPercent(share, decimals), share};
}

BenchCell BenchCell::Count(double value) {
  return {page::FormatLarge(value), value};
}

BenchCell BenchCell::Bytes(double bytes) {
  return {std::isfinite(bytes) ? page::FormatBytes(static_cast<int64_t>(bytes)) : page::FormatFixed(bytes, 0), bytes};
}

BenchCell BenchCell::Seconds(double seconds) {
  return {std::isfinite(seconds) ? base::FormatDuration(seconds) : page::FormatFixed(seconds, 0), seconds};
}

void BenchPage::SetOrigin(const std::string& command_line) {
  command = command_line;
  machine = base::MachineDescription();
  date = base::UtcTimestamp();
}

std::string BenchText(const BenchPage& page) {
  std::string text = page.title + "\n";
  for (const BenchFigure& figure : page.figures)
    text += fmt::format("  {}: {}{}\n", figure.label, figure.value, figure.note.empty() ? "" : " (" + figure.note + ")");
  for (const BenchSection& section : page.sections) {
    if (section.tables.empty()) continue;
    text += "\n" + section.title + "\n";
    for (const BenchTable& table : section.tables) text += TextTable(table);
  }
  if (!page.verdicts.empty()) text += "\n";
  for (const std::string& verdict : page.verdicts) text += "- " + verdict + "\n";
  return text;
}

std::string BenchHtml(const BenchPage& page) {
  page::PageFrame frame{
      .title = page.title, .window_title = "Skyquilt bench " + page.name, .subtitle = page.date + " \xC2\xB7 " + page.machine, .anchors = {}};
  for (const BenchSection& section : page.sections) frame.anchors.emplace_back(section.id, section.title);
  std::string html = page::PageBegin(frame);
  html += "<p class=\"lead\">" + page::EscapeHtml(page.lead) + "</p>\n";
  if (!page.figures.empty()) {
    html += "<section class=\"kpis\">";
    for (const BenchFigure& figure : page.figures)
      html += page::KeyFigure(figure.label, page::EscapeHtml(figure.value), page::EscapeHtml(figure.note));
    html += "</section>\n";
  }
  if (!page.verdicts.empty()) {
    html += "<div class=\"card prose verdicts\">";
    for (const std::string& verdict : page.verdicts) html += "<p>" + page::EscapeHtml(verdict) + "</p>";
    html += "</div>\n";
  }
  for (const BenchSection& section : page.sections) html += HtmlSection(section);
  html += "<section><details class=\"card config\"><summary>Command</summary><pre>" + page::EscapeHtml(page.command) + "</pre></details></section>\n";
  return html + page::PageEnd();
}

std::string BenchCsv(const BenchTable& table) {
  std::string csv;
  for (size_t c = 0; c < table.columns.size(); ++c) csv += (c > 0 ? "," : "") + CsvText(table.columns[c]);
  csv += "\n";
  for (const auto& row : table.rows) {
    SKYQUILT_CHECK(row.size() == table.columns.size(), table.title);
    for (size_t c = 0; c < row.size(); ++c) {
      const bool numeric = IsNumeric(table, c);
      const std::string value = std::isnan(row[c].value) ? "" : fmt::format("{}", row[c].value);
      csv += (c > 0 ? "," : "") + (numeric ? value : CsvText(row[c].shown));
    }
    csv += "\n";
  }
  return csv;
}

void WriteBench(const std::filesystem::path& folder, const BenchPage& page, const std::string& json) {
  base::RequireWritableFolder(folder);
  base::WriteFileAtomically(folder / (page.name + ".json"), json);
  for (const BenchSection& section : page.sections) {
    for (const BenchTable& table : section.tables) {
      base::WriteFileAtomically(folder / (page.name + (table.name.empty() ? "" : "_" + table.name) + ".csv"), BenchCsv(table));
    }
  }
  base::WriteFileAtomically(folder / (page.name + ".html"), BenchHtml(page));
}

}  // namespace skyquilt::bench
