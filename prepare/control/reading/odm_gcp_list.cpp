#include "prepare/control/reading/odm_gcp_list.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

#include "core/base/errors.h"

namespace skyquilt::prepare::control {
namespace {

constexpr size_t kNumbers = 5;
constexpr const char* kGcpListFix = "Write per line: x, y, z, pixel x, pixel y, photo and, if you like, the point's name";

// The photo's name may have spaces: the shortest run of words that is the name of a photo, else the first word. `used`: number of its words.
std::string PhotoOf(const std::vector<std::string>& words, const ControlPhotos& photos, size_t& used) {
  std::string name;
  for (size_t i = kNumbers; i < words.size(); ++i) {
    name += (i == kNumbers ? "" : " ") + words[i];
    if (photos.Find(name) == nullptr) continue;
    used = i + 1 - kNumbers;
    return name;
  }
  used = 1;
  return words[kNumbers];
}

}  // namespace

bool LooksLikeGcpList(const tables::TextTable& table, const ControlPhotos& photos) {
  if (table.rows.empty()) return false;
  const std::vector<std::string>& words = table.rows.front().fields;
  if (words.size() <= kNumbers) return false;
  for (size_t i = 0; i < kNumbers; ++i) {
    if (!tables::ParseTableNumber(words[i], table.decimal_comma) && !(i == 2 && tables::IsNoValue(words[i]))) return false;
  }
  // Six numbers are a table with accuracies; with commas and semicolons, so may five numbers and a remark be.
  if (table.separator == ',' || table.separator == ';') {
    return std::any_of(table.rows.begin(), table.rows.end(),
                       [&](const tables::TableRow& row) { return row.fields.size() > kNumbers && photos.Find(row.fields[kNumbers]) != nullptr; });
  }
  return !tables::ParseTableNumber(words[kNumbers], table.decimal_comma);
}

RawControl ReadGcpList(const tables::TextTable& table, const ControlPhotos& photos) {
  RawControl control;
  control.file = table.file;
  control.format = "OpenDroneMap's gcp_list.txt";
  control.crs = table.crs;
  control.crs_line = table.crs_line;
  std::map<std::string, size_t> by_name;
  std::map<std::tuple<double, double, double>, size_t> by_place;
  size_t n_unnamed = 0;
  for (const tables::TableRow& row : table.rows) {
    const std::vector<std::string>& words = row.fields;
    if (words.size() <= kNumbers)
      tables::FailTableLine(table.file, row.line, "has " + std::to_string(words.size()) + " fields instead of 6 or more", kGcpListFix);
    const auto number = [&](size_t i) {
      const std::optional<double> value = tables::ParseTableNumber(words[i], table.decimal_comma);
      if (!value) tables::FailTableLine(table.file, row.line, "'" + words[i].substr(0, 60) + "' is not a number", kGcpListFix);
      return *value;
    };
    RawPoint point;
    point.line = row.line;
    const double z = tables::IsNoValue(words[2]) ? std::numeric_limits<double>::quiet_NaN() : number(2);
    point.given = {number(0), number(1), z};
    RawMark mark;
    mark.line = row.line;
    mark.pixel = {number(3), number(4)};
    mark.origin = PixelOrigin::kFirstPixel;
    size_t used = 0;
    mark.photo = PhotoOf(words, photos, used);
    const bool named = words.size() > kNumbers + used && !words[kNumbers + used].empty();
    // NaN is not equal to itself.
    const std::tuple key(point.given.x(), point.given.y(), std::isnan(z) ? std::numeric_limits<double>::infinity() : z);
    const size_t next = control.points.size();
    const auto [found, is_new] = named ? [&] {
      const auto [entry, added] = by_name.emplace(words[kNumbers + used], next);
      return std::pair(entry->second, added);
    }() : [&] {
      const auto [entry, added] = by_place.emplace(key, next);
      return std::pair(entry->second, added);
    }();
    if (is_new) {
      point.label = named ? words[kNumbers + used] : "point " + std::to_string(++n_unnamed);
      control.points.push_back(point);
    } else if (named) {
      const RawPoint& first = control.points[found];
      const std::tuple first_key(first.given.x(), first.given.y(),
                                 std::isnan(first.given.z()) ? std::numeric_limits<double>::infinity() : first.given.z());
      if (first_key != key) {
        tables::FailTableLine(table.file, row.line, "gives " + first.label + " other coordinates than line " + std::to_string(first.line),
                              "Give every point a name of its own, or the same coordinates on all its lines");
      }
    }
    mark.label = control.points[found].label;
    control.marks.push_back(std::move(mark));
  }
  return control;
}

}  // namespace skyquilt::prepare::control
