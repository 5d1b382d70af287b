#include "prepare/tables/text_table.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <sstream>
#include <string_view>
#include <utility>

#include "core/base/checked_json.h"
#include "core/base/errors.h"
#include "core/base/text.h"

namespace skyquilt::prepare::tables {
namespace {

constexpr size_t kMaxLineBytes = size_t{64} << 10;

std::string Trimmed(const std::string& text) {
  const size_t begin = text.find_first_not_of(" \t");
  return begin == std::string::npos ? "" : text.substr(begin, text.find_last_not_of(" \t") - begin + 1);
}

// A spreadsheet gives a line that has one field the separators of all columns, and maybe quotes.
std::string WithoutPadding(const std::string& line) {
  std::string text = line.substr(0, line.find_last_not_of(",; \t") + 1);
  if (text.size() > 2 && text.front() == '"' && text.back() == '"') text = text.substr(1, text.size() - 2);
  return text;
}

// "IGNF:LAMB93", "OGC:CRS84".
bool IsAuthorityAndCode(const std::string& text) {
  const size_t colon = text.find(':');
  if (colon == std::string::npos || colon < 2 || colon + 1 == text.size()) return false;
  const auto is_word = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; };
  return std::all_of(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(colon), is_word) &&
         std::all_of(text.begin() + static_cast<std::ptrdiff_t>(colon) + 1, text.end(), is_word);
}

bool LooksLikeCrs(const std::string& line) {
  const std::string text = base::LowerCase(line);
  for (const char* start : {"epsg:", "+proj", "+init", "wgs84", "wgs 84", "esri:", "projcs[", "geogcs[", "compd_cs[", "projcrs[", "geogcrs[",
                            "compoundcrs[", "boundcrs[", "urn:ogc:def:crs:"}) {
    if (text.starts_with(start)) return true;
  }
  return IsAuthorityAndCode(text) || text.find(" / utm zone ") != std::string::npos;
}

std::vector<std::string> Split(const std::string& line, char separator) {
  std::vector<std::string> parts(1);
  for (const char c : line) {
    if (c == separator) {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

// Words between spaces and tabs; quotes around a word may enclose spaces.
std::vector<std::string> WordsOfLine(const std::string& line) {
  std::vector<std::string> words;
  size_t i = 0;
  while ((i = line.find_first_not_of(" \t", i)) != std::string::npos) {
    const size_t closing = line[i] == '"' ? line.find('"', i + 1) : std::string::npos;
    const bool quoted = closing != std::string::npos && (closing + 1 == line.size() || line[closing + 1] == ' ' || line[closing + 1] == '\t');
    const size_t end = quoted ? closing + 1 : std::min(line.find_first_of(" \t", i), line.size());
    words.push_back(quoted ? line.substr(i + 1, closing - i - 1) : line.substr(i, end - i));
    i = end;
  }
  return words;
}

// A separator inside quotes belongs to the field; two quotes there are one.
std::vector<std::string> FieldsOf(const std::string& line, char separator) {
  if (separator == ' ') return WordsOfLine(line);
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

using Lines = std::vector<std::pair<int, std::string>>;

// "a.jpg 8,4 47,1": commas only inside of numbers, and other separators between them.
bool HaveDecimalCommas(const Lines& lines) {
  size_t n = 0;
  for (const auto& [number, line] : lines) {
    if (line.find(',') == std::string::npos) continue;
    const std::vector<std::string> words = WordsOfLine(line);
    if (words.size() < 3) return false;
    for (const std::string& word : words) {
      const size_t comma = word.find(',');
      if (comma == std::string::npos) continue;
      // "1, 2, 3" has separators.
      const auto is_digit = [&](size_t i) { return i < word.size() && std::isdigit(static_cast<unsigned char>(word[i])) != 0; };
      if (comma == 0 || !is_digit(comma - 1) || !is_digit(comma + 1) || !ParseTableNumber(word, true)) return false;
      ++n;
    }
  }
  return n >= 2;
}

// Whether tabs alone separate. Rows that mix them with spaces, have them behind commas, or several of them between fields that no table can do
// without (a label and two coordinates, or two coordinates, a height and a pixel), say no.
bool AreTabbed(const Lines& lines, bool decimal_comma) {
  for (const auto& [number, line] : lines) {
    if (std::count(line.begin(), line.end(), '\t') < 2 || line.find(",\t") != std::string::npos || line.find("\t,") != std::string::npos)
      return false;
    const std::vector<std::string> fields = Split(line, '\t');
    const size_t n_needed = ParseTableNumber(Trimmed(fields.front()), decimal_comma) ? 5 : 3;
    for (size_t i = 0; i < std::min(n_needed, fields.size()); ++i) {
      if (Trimmed(fields[i]).empty()) return false;
    }
    for (const std::string& field : fields) {
      const std::vector<std::string> words = WordsOfLine(field);
      if (words.size() < 2 || field.find('"') != std::string::npos) continue;
      if (std::any_of(words.begin(), words.end(), [&](const std::string& word) { return ParseTableNumber(word, decimal_comma).has_value(); }))
        return false;
    }
  }
  return !lines.empty();
}

// Metashape writes "#CoordinateSystem: PROJCS[...]" above its table.
std::string CrsOfComment(const std::string& comment) {
  constexpr std::string_view kKey = "coordinatesystem:";
  const std::string text = Trimmed(comment);
  if (!base::LowerCase(text).starts_with(kKey)) return "";
  const std::string crs = Trimmed(text.substr(kKey.size()));
  return LooksLikeCrs(crs) ? crs : "";
}

void ChooseSeparator(const Lines& lines, TextTable& table) {
  if (lines.empty()) return;
  const std::string& first = lines.front().second;
  if (first.find(';') != std::string::npos) {
    table.separator = ';';
    table.decimal_comma = true;
    return;
  }
  table.decimal_comma = HaveDecimalCommas(lines);
  if (AreTabbed(lines, table.decimal_comma)) {
    table.separator = '\t';
  } else {
    table.separator = !table.decimal_comma && first.find(',') != std::string::npos ? ',' : ' ';
  }
}

}  // namespace

TextTable ParseTextTable(const std::filesystem::path& file, const std::string& text) {
  TextTable table;
  table.file = file;
  std::istringstream in(text);
  int number = 0;
  std::string comment;
  Lines lines;
  for (std::string line; std::getline(in, line);) {
    ++number;
    if (line.ends_with('\r')) line.pop_back();
    if (number == 1 && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);
    const bool control = std::any_of(line.begin(), line.end(), [](char c) { return c != '\t' && base::IsControl(c); });
    if (control || line.size() > kMaxLineBytes) {
      FailTableLine(file, number, control ? "has a character that text does not have" : "is longer than 64 KiB",
                    "Give a text file (UTF-8) with one point, mark or photo per line");
    }
    const std::string trimmed = Trimmed(line);
    if (trimmed.empty()) continue;
    if (trimmed.front() == '#') {
      if (!lines.empty()) continue;
      comment = trimmed.substr(1);
      const std::string crs = CrsOfComment(comment);
      if (crs.empty()) continue;
      table.crs = crs;
      table.crs_line = number;
      comment.clear();
      continue;
    }
    if (const std::string crs = WithoutPadding(trimmed); lines.empty() && table.crs.empty() && LooksLikeCrs(crs)) {
      table.crs = crs;
      table.crs_line = number;
      continue;
    }
    // Tabs at the end are empty fields.
    lines.emplace_back(number, line.substr(line.find(trimmed)));
  }
  ChooseSeparator(lines, table);
  if (!comment.empty() && !lines.empty()) table.heading = FieldsOf(Trimmed(comment), table.separator);
  if (!lines.empty()) table.first_row = Trimmed(lines.front().second);
  for (const auto& [at, line] : lines) table.rows.push_back({at, FieldsOf(table.separator == '\t' ? line : Trimmed(line), table.separator)});
  return table;
}

std::optional<double> ParseTableNumber(const std::string& text, bool decimal_comma) {
  std::string number = text.starts_with('+') ? text.substr(1) : text;
  if (decimal_comma && number.find('.') == std::string::npos && std::count(number.begin(), number.end(), ',') == 1) {
    number[number.find(',')] = '.';
  }
  double value = 0.0;
  const auto result = std::from_chars(number.data(), number.data() + number.size(), value);
  if (result.ec != std::errc() || result.ptr != number.data() + number.size() || !(std::abs(value) <= 1e9)) return std::nullopt;
  return value;
}

bool IsNoValue(const std::string& text) {
  const std::string word = base::LowerCase(text);
  return word.empty() || word == "nan" || word == "none" || word == "null" || word == "n/a";
}

void FailTableLine(const std::filesystem::path& file, int line, const std::string& found, const std::string& fix) {
  throw base::InputError(file, (line > 0 ? "line " + std::to_string(line) + ": " : "") + found, fix);
}

}  // namespace skyquilt::prepare::tables
