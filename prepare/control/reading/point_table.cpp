#include "prepare/control/reading/point_table.h"

#include <array>
#include <cmath>
#include <map>

#include "core/base/errors.h"
#include "prepare/control/reading/control_columns.h"

namespace skyquilt::prepare::control {
namespace {

constexpr const char* kPointFix =
    "Write per line: label, x (east or longitude), y (north or latitude), height; or say what the columns are with "
    "prepare.gcp_columns, for instance label,east,north,up";
constexpr const char* kMarkFix = "Write per line: photo, label, x and y in pixels; or name the columns in a first line";

// Reads the rows of one table by the meaning of its columns.
class RowReader {
 public:
  RowReader(const tables::TextTable& table, ControlColumns columns, const char* fix) : table_(&table), columns_(columns), fix_(fix) {}

  std::string Text(const tables::TableRow& row, ControlColumn column, const char* what) const {
    const std::string text = columns_.Field(row.fields, column);
    if (text.empty() || text.size() > 4096) tables::FailTableLine(table_->file, row.line, std::string("has no ") + what, fix_);
    return text;
  }
  double Number(const tables::TableRow& row, ControlColumn column, const char* what) const {
    const std::string text = Text(row, column, what);
    const std::optional<double> value = tables::ParseTableNumber(text, table_->decimal_comma);
    if (!value) tables::FailTableLine(table_->file, row.line, std::string(what) + " '" + text.substr(0, 60) + "' is not a number", fix_);
    return *value;
  }
  // Nothing for an empty field; an accuracy of zero means that it is not known.
  std::optional<double> Sigma(const tables::TableRow& row, ControlColumn column) const {
    if (tables::IsNoValue(columns_.Field(row.fields, column))) return std::nullopt;
    const double value = Number(row, column, "accuracy");
    if (value < 0.0) tables::FailTableLine(table_->file, row.line, "has a negative accuracy", "Write it in metres, or leave it empty");
    return value > 0.0 ? std::optional(value) : std::nullopt;
  }
  RawPoint Point(const tables::TableRow& row) const {
    RawPoint point;
    point.line = row.line;
    point.label = Text(row, ControlColumn::kLabel, "label");
    const bool no_height = tables::IsNoValue(columns_.Field(row.fields, ControlColumn::kZ));
    point.given = {Number(row, ControlColumn::kX, "x"), Number(row, ControlColumn::kY, "y"),
                   no_height ? std::numeric_limits<double>::quiet_NaN() : Number(row, ControlColumn::kZ, "height")};
    point.horizontal_sigma_m = Sigma(row, ControlColumn::kSigma);
    point.vertical_sigma_m = point.horizontal_sigma_m;
    if (const std::optional<double> sigma = Sigma(row, ControlColumn::kHorizontalSigma)) point.horizontal_sigma_m = sigma;
    if (const std::optional<double> sigma = Sigma(row, ControlColumn::kVerticalSigma)) point.vertical_sigma_m = sigma;
    return point;
  }
  RawMark Mark(const tables::TableRow& row) const {
    RawMark mark;
    mark.line = row.line;
    mark.label = Text(row, ControlColumn::kLabel, "label");
    mark.photo = Text(row, ControlColumn::kPhoto, "photo");
    mark.pixel = {Number(row, ControlColumn::kPixelX, "pixel x"), Number(row, ControlColumn::kPixelY, "pixel y")};
    if (columns_.Has(ControlColumn::kPhotoWidth) && columns_.Has(ControlColumn::kPhotoHeight)) {
      mark.photo_size = {Pixels(row, ControlColumn::kPhotoWidth), Pixels(row, ControlColumn::kPhotoHeight)};
    }
    return mark;
  }

 private:
  int Pixels(const tables::TableRow& row, ControlColumn column) const {
    const double value = Number(row, column, "size of the photo");
    if (!(value >= 1.0 && value <= 1e6) || value != std::floor(value)) {
      tables::FailTableLine(table_->file, row.line, "has a size of the photo that is not a number of pixels", fix_);
    }
    return static_cast<int>(value);
  }

  const tables::TextTable* table_;
  ControlColumns columns_;
  const char* fix_;
};

// The names of the columns: a comment or a first row. `rows_from`: where the points begin.
std::vector<std::string> Heading(const tables::TextTable& table, TableKind kind, size_t& rows_from) {
  rows_from = 0;
  if (!table.heading.empty() && ControlColumns(table.heading, kind).IsComplete(kind)) return table.heading;
  if (table.rows.empty() || !ControlColumns(table.rows.front().fields, kind).IsComplete(kind)) return {};
  rows_from = 1;
  return table.rows.front().fields;
}

// Of Pix4D and Metashape, by the number of fields.
std::vector<std::string> UsualPointColumns(const tables::TextTable& table) {
  const size_t n = table.rows.front().fields.size();
  if (n < 3 || n > 6) {
    tables::FailTableLine(table.file, table.rows.front().line,
                          "has " + std::to_string(n) + (n == 1 ? " field" : " fields") + ", and no line says what they are", kPointFix);
  }
  std::vector<std::string> names = {"label", "x", "y", "z", n == 6 ? "horizontal accuracy" : "accuracy", "vertical accuracy"};
  names.resize(n);
  return names;
}

void CheckColumns(const std::vector<std::string>& names, const std::string& columns) {
  for (const std::string& name : names) {
    if (!name.empty() && !ColumnOfName(name, TableKind::kPoints)) {
      throw base::UsageError(
          "gcp_columns: '" + name +
          "' is no column; there are label, east or lon, north or lat, up, accuracy, horizontal_accuracy, vertical_accuracy, image, px, py, "
          "image_width, image_height and skip");
    }
  }
  if (!ControlColumns(names, TableKind::kPoints).IsComplete(TableKind::kPoints)) {
    throw base::UsageError("gcp_columns: '" + columns + "' must name at least label, east and north (or lon and lat)");
  }
}

bool SamePlace(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return a.head<2>() == b.head<2>() && (a.z() == b.z() || (std::isnan(a.z()) && std::isnan(b.z())));
}

}  // namespace

RawControl ReadPointTable(const tables::TextTable& table, const std::string& columns) {
  if (table.rows.empty()) throw base::InputError(table.file, "has no control points", kPointFix);
  RawControl control;
  control.file = table.file;
  control.format = "a table of points";
  control.crs = table.crs;
  control.crs_line = table.crs_line;
  size_t begin = 0;
  std::vector<std::string> names = Heading(table, TableKind::kPoints, begin);
  const bool has_heading = !names.empty();
  if (!columns.empty()) {
    names = SplitNames(columns);
    CheckColumns(names, columns);
  } else if (!has_heading) {
    names = UsualPointColumns(table);
  }
  const ControlColumns meaning(names, TableKind::kPoints);
  control.order_known = has_heading || !columns.empty();
  const RowReader reader(table, meaning, kPointFix);
  std::map<std::string, size_t> seen;
  for (size_t i = begin; i < table.rows.size(); ++i) {
    const tables::TableRow& row = table.rows[i];
    RawPoint point = reader.Point(row);
    if (meaning.HasMarks()) control.marks.push_back(reader.Mark(row));
    const auto [found, is_new] = seen.emplace(point.label, control.points.size());
    if (is_new) {
      control.points.push_back(std::move(point));
      continue;
    }
    const RawPoint& first = control.points[found->second];
    if (!SamePlace(first.given, point.given)) {
      tables::FailTableLine(table.file, row.line, "gives " + point.label + " other coordinates than line " + std::to_string(first.line),
                            "Give every point a label of its own");
    }
  }
  return control;
}

RawControl ReadMarkTable(const tables::TextTable& table) {
  RawControl control;
  control.file = table.file;
  control.format = "a table of marks";
  size_t begin = 0;
  std::vector<std::string> names = Heading(table, TableKind::kMarks, begin);
  if (names.empty()) names = {"image", "label", "x", "y"};
  const RowReader reader(table, ControlColumns(names, TableKind::kMarks), kMarkFix);
  for (size_t i = begin; i < table.rows.size(); ++i) control.marks.push_back(reader.Mark(table.rows[i]));
  if (control.marks.empty()) throw base::InputError(table.file, "has no marks", kMarkFix);
  return control;
}

}  // namespace skyquilt::prepare::control
