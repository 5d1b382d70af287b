#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "app/commands/describe.h"
#include "core/base/json_text.h"

namespace skyquilt::app {
namespace {

using Json = nlohmann::ordered_json;

std::string Scalar(const Json& value) {
  if (value.is_null()) return "-";
  if (value.is_string()) return value.get<std::string>();
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
  return base::JsonText(value);
}

bool IsFlat(const Json& value) {
  return !value.is_structured() ||
         (value.is_array() && std::none_of(value.begin(), value.end(), [](const Json& entry) { return entry.is_structured(); }));
}

std::string FlatText(const Json& value) {
  if (!value.is_array()) return Scalar(value);
  if (value.empty()) return "none";
  std::string text;
  for (const Json& entry : value) text += (text.empty() ? "" : ", ") + Scalar(entry);
  return text;
}

// Longer texts are sentences: in columns they would make lines that no terminal can show.
constexpr size_t kWidestCell = 80;

bool IsRecords(const Json& value) {
  return value.is_array() && !value.empty() && std::all_of(value.begin(), value.end(), [](const Json& row) {
           return row.is_object() && std::all_of(row.begin(), row.end(), [](const Json& cell) { return IsFlat(cell); });
         });
}

// Records with the same short fields line up in columns.
bool IsTable(const Json& records) {
  return std::all_of(records.begin(), records.end(), [](const Json& row) {
    return std::all_of(row.begin(), row.end(), [](const Json& cell) { return FlatText(cell).size() <= kWidestCell; });
  });
}

void WriteTable(const Json& rows, const std::string& indent, std::ostream& out) {
  std::vector<std::string> columns;
  for (const Json& row : rows) {
    for (const auto& [key, cell] : row.items()) {
      if (std::find(columns.begin(), columns.end(), key) == columns.end()) columns.push_back(key);
    }
  }
  std::vector<std::vector<std::string>> lines = {columns};
  for (const Json& row : rows) {
    std::vector<std::string> line;
    line.reserve(columns.size());
    for (const std::string& column : columns) line.push_back(row.contains(column) ? FlatText(row.at(column)) : "");
    lines.push_back(line);
  }
  std::vector<size_t> width(columns.size(), 0);
  for (const std::vector<std::string>& line : lines) {
    for (size_t i = 0; i < line.size(); ++i) width[i] = std::max(width[i], line[i].size());
  }
  for (const std::vector<std::string>& line : lines) {
    std::string text = indent;
    for (size_t i = 0; i < line.size(); ++i) text += line[i] + std::string(width[i] - line[i].size() + 2, ' ');
    text.erase(text.find_last_not_of(' ') + 1);
    out << text << "\n";
  }
}

void WriteRecord(const Json& record, const std::string& indent, std::ostream& out) {
  const char* lead = "- ";
  for (const auto& [key, value] : record.items()) {
    out << indent << lead << key << ": " << FlatText(value) << "\n";
    lead = "  ";
  }
}

void Write(const Json& json, const std::string& indent, std::ostream& out) {
  for (const auto& [key, value] : json.items()) {
    if (IsFlat(value)) {
      const std::string text = FlatText(value);
      if (text.find('\n') == std::string::npos) {
        out << indent << key << ": " << text << "\n";
        continue;
      }
      out << indent << key << ":\n";
      std::istringstream lines(text);
      for (std::string line; std::getline(lines, line);) out << indent << "  | " << line << "\n";
    } else {
      out << indent << key << ":\n";
      if (IsRecords(value) && IsTable(value)) {
        WriteTable(value, indent + "  ", out);
      } else if (IsRecords(value)) {
        for (const Json& record : value) WriteRecord(record, indent + "  ", out);
      } else {
        Write(value, indent + "  ", out);
      }
    }
  }
}

}  // namespace

std::string FormatReadable(const nlohmann::ordered_json& json) {
  std::ostringstream out;
  Write(json, "", out);
  return out.str();
}

}  // namespace skyquilt::app
