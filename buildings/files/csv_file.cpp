// buildings.csv: RFC 4180, so lines end with CR LF; UTF-8; a point before decimals.
#include <string>
#include <variant>

#include "buildings/files/building_files.h"
#include "buildings/files/building_table.h"
#include "core/base/file.h"

namespace skyquilt::buildings {
namespace {

std::string Quoted(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char letter : text) {
    if (letter == '"') quoted += '"';
    quoted += letter;
  }
  return quoted + "\"";
}

std::string CellText(const gis::FieldValue& value) {
  if (const auto* whole = std::get_if<int64_t>(&value)) return std::to_string(*whole);
  if (const auto* real = std::get_if<double>(&value)) return NumberText(*real);
  if (const auto* text = std::get_if<std::string>(&value)) return Quoted(*text);
  return "";
}

}  // namespace

void WriteCsv(const BuildingSet& set, const surface::MapFrame& frame, const std::filesystem::path& file) {
  const BuildingTable table = TableOf(set, FileFrame(set, frame));
  std::string content;
  for (size_t column = 0; column < table.fields.size(); ++column) content += (column == 0 ? "" : ",") + Quoted(table.fields[column].name);
  content += "\r\n";
  for (const std::vector<gis::FieldValue>& row : table.rows) {
    for (size_t column = 0; column < row.size(); ++column) content += (column == 0 ? "" : ",") + CellText(row[column]);
    content += "\r\n";
  }
  base::WriteFileAtomically(file, content);
}

}  // namespace skyquilt::buildings
