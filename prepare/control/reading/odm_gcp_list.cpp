#include "prepare/control/reading/odm_gcp_list.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

namespace skyquilt::prepare::control {
namespace {

constexpr size_t kNumbers = 5;
constexpr const char* kGcpListFix = "Write per line: x, y, z, pixel x, pixel y, photo and, if you like, the point's name";

// The photo's name may have spaces: the shortest run of words that is the name of a photo, else the first word. `used`: number of its words.
std::string PhotoOf(const std::vector<std::string>& words, const models::PhotoNames& photos, size_t& used) {
  std::string name;
  for (size_t i = kNumbers; i < words.size(); ++i) {
    name += (i == kNumbers ? "" : " ") + words[i];
    if (!photos.Find(name)) continue;
    used = i + 1 - kNumbers;
    return name;
  }
  used = 1;
  return words[kNumbers];
}

using Coordinates = std::array<double, 3>;

// To compare: NaN is not equal to itself.
Coordinates CoordinatesOf(const RawPoint& point) {
  const double z = point.given.z();
  return {point.given.x(), point.given.y(), std::isnan(z) ? std::numeric_limits<double>::infinity() : z};
}

}  // namespace

bool LooksLikeGcpList(const tables::TextTable& table, const models::PhotoNames& photos) {
  if (table.rows.empty()) return false;
  const std::vector<std::string>& words = table.rows.front().fields;
  if (words.size() <= kNumbers) return false;
  for (size_t i = 0; i < kNumbers; ++i) {
    if (!tables::ParseTableNumber(words[i], table.decimal_comma) && !(i == 2 && tables::IsNoValue(words[i]))) return false;
  }
  // Six numbers are a table with accuracies; with commas and semicolons, so may five numbers and a remark be.
  if (table.separator == ',' || table.separator == ';') {
    return std::any_of(table.rows.begin(), table.rows.end(),
                       [&](const tables::TableRow& row) { return row.fields.size() > kNumbers && photos.Find(row.fields[kNumbers]); });
  }
  return !tables::ParseTableNumber(words[kNumbers], table.decimal_comma);
}

GcpList ReadGcpList(const tables::TextTable& table, const models::PhotoNames& photos) {
  GcpList list;
  RawControl& control = list.control;
  control.file = table.file;
  control.format = "OpenDroneMap's gcp_list.txt";
  control.crs = table.crs;
  control.crs_line = table.crs_line;
  std::map<std::pair<std::string, Coordinates>, size_t> by_name_or_place;
  size_t n_unnamed = 0;
  for (const tables::TableRow& row : table.rows) {
    const std::vector<std::string>& words = row.fields;
    const auto leave_out = [&](const std::string& found, const char* fix) { list.problems.push_back({row.line, found, fix}); };
    if (words.size() <= kNumbers) {
      leave_out("has " + std::to_string(words.size()) + " fields instead of 6 or more", kGcpListFix);
      continue;
    }
    std::array<double, kNumbers> numbers{};
    size_t n_read = 0;
    for (; n_read < kNumbers; ++n_read) {
      const bool no_height = n_read == 2 && tables::IsNoValue(words[2]);
      const auto number = no_height ? std::numeric_limits<double>::quiet_NaN() : tables::ParseTableNumber(words[n_read], table.decimal_comma);
      if (!number) break;
      numbers[n_read] = *number;
    }
    if (n_read < kNumbers) {
      leave_out("'" + words[n_read].substr(0, 60) + "' is not a number", kGcpListFix);
      continue;
    }
    RawPoint point;
    point.line = row.line;
    point.given = {numbers[0], numbers[1], numbers[2]};
    RawMark mark;
    mark.line = row.line;
    mark.pixel = {numbers[3], numbers[4]};
    mark.origin = PixelOrigin::kFirstPixel;
    size_t used = 0;
    mark.photo = PhotoOf(words, photos, used);
    point.label = words.size() > kNumbers + used ? words[kNumbers + used] : "";
    point.named = !point.label.empty();
    const Coordinates place = CoordinatesOf(point);
    const auto [found, is_new] = by_name_or_place.try_emplace({point.label, point.named ? Coordinates() : place}, control.points.size());
    if (is_new) {
      if (!point.named) point.label = "point " + std::to_string(++n_unnamed);
      control.points.push_back(point);
    }
    const RawPoint& first = control.points[found->second];
    if (CoordinatesOf(first) != place) {
      leave_out("gives " + first.label + " other coordinates than line " + std::to_string(first.line),
                "Give every point a name of its own, or the same coordinates on all its lines");
      continue;
    }
    mark.label = first.label;
    control.marks.push_back(std::move(mark));
  }
  return list;
}

}  // namespace skyquilt::prepare::control
