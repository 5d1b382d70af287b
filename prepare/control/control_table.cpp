#include "prepare/control/control_table.h"

#include <algorithm>
#include <sstream>
#include <string_view>

#include "core/base/checked_json.h"
#include "core/base/text.h"
#include "prepare/control/raw_control.h"

namespace skyquilt::prepare {
namespace {

constexpr size_t kMaxLineBytes = size_t{64} << 10;

std::string Trimmed(const std::string& text) {
  const size_t begin = text.find_first_not_of(" \t");
  return begin == std::string::npos ? "" : text.substr(begin, text.find_last_not_of(" \t") - begin + 1);
}

bool LooksLikeCrs(const std::string& line) {
  const std::string text = base::LowerCase(line);
  for (const char* start : {"epsg:", "+proj", "+init", "wgs84", "wgs 84", "esri:", "projcs[", "geogcs[", "compd_cs[", "projcrs[", "geogcrs[",
                            "compoundcrs[", "boundcrs["}) {
    if (text.starts_with(start)) return true;
  }
  return false;
}

char SeparatorOf(const std::string& line) {
  for (const char separator : {';', ',', '\t'}) {
    if (line.find(separator) != std::string::npos) return separator == '\t' ? ' ' : separator;
  }
  return ' ';
}

std::vector<std::string> WordsOf(const std::string& line) {
  std::istringstream in(line);
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

// A separator inside quotes belongs to the field; two quotes there are one.
std::vector<std::string> FieldsOf(const std::string& line, char separator) {
  if (separator == ' ') return WordsOf(line);
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"') {
      const bool escaped = quoted && i + 1 < line.size() && line[i + 1] == '"';
      if (escaped) fields.back() += line[i++];
      if (!escaped) quoted = !quoted;
    } else if (line[i] == separator && !quoted) {
      fields.emplace_back();
    } else {
      fields.back() += line[i];
    }
  }
  for (std::string& field : fields) field = Trimmed(field);
  return fields;
}

// Metashape writes "#CoordinateSystem: PROJCS[...]" above its table.
std::string CrsOfComment(const std::string& comment) {
  constexpr std::string_view kKey = "coordinatesystem:";
  const std::string text = Trimmed(comment);
  if (!base::LowerCase(text).starts_with(kKey)) return "";
  const std::string crs = Trimmed(text.substr(kKey.size()));
  return LooksLikeCrs(crs) ? crs : "";
}

}  // namespace

ControlTable ParseControlTable(const std::filesystem::path& file, const std::string& text) {
  ControlTable table;
  table.file = file;
  std::istringstream lines(text);
  int number = 0;
  std::string comment;
  bool separator_known = false;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    if (line.ends_with('\r')) line.pop_back();
    if (number == 1 && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);
    const bool control = std::any_of(line.begin(), line.end(), [](char c) { return c != '\t' && base::IsControl(c); });
    if (control || line.size() > kMaxLineBytes) {
      FailControlLine(file, number, control ? "has a character that text does not have" : "is longer than 64 KiB",
                      "Give a text file (UTF-8) with one point or mark per line");
    }
    line = Trimmed(line);
    if (line.empty()) continue;
    if (line.front() == '#') {
      if (!table.rows.empty()) continue;
      comment = line.substr(1);
      const std::string crs = CrsOfComment(comment);
      if (crs.empty()) continue;
      table.crs = crs;
      table.crs_line = number;
      comment.clear();
      continue;
    }
    if (table.rows.empty() && table.crs.empty() && LooksLikeCrs(line)) {
      table.crs = line;
      table.crs_line = number;
      continue;
    }
    if (!separator_known) {
      table.separator = SeparatorOf(line);
      separator_known = true;
      table.heading = FieldsOf(comment, table.separator);
      if (comment.empty()) table.heading.clear();
    }
    table.rows.push_back({number, FieldsOf(line, table.separator)});
  }
  return table;
}

}  // namespace skyquilt::prepare
