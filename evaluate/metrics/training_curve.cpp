#include "evaluate/metrics/training_curve.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>

#include "core/base/file.h"
#include "evaluate/measured.h"

namespace skyquilt::evaluate::metrics {

namespace {

std::vector<std::string> SplitLine(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream stream(line);
  for (std::string cell; std::getline(stream, cell, ',');) {
    cell.erase(0, std::min(cell.find_first_not_of(" \t\r"), cell.size()));
    cell.erase(cell.find_last_not_of(" \t\r") + 1);
    cells.push_back(cell);
  }
  return cells;
}

double ParseNumber(const std::string& text) {
  double value = kNotMeasured;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  return result.ec == std::errc() && result.ptr == text.data() + text.size() ? value : kNotMeasured;
}

}  // namespace

std::vector<CurvePoint> ParseCurve(const std::string& csv) {
  std::istringstream stream(csv);
  std::string line;
  if (!std::getline(stream, line)) return {};
  const std::vector<std::string> header = SplitLine(line);
  const auto column_of = [&](const char* name) {
    return static_cast<size_t>(std::distance(header.begin(), std::find(header.begin(), header.end(), name)));
  };
  const size_t step = column_of("step"), seconds = column_of("seconds"), loss = column_of("loss"), psnr = column_of("psnr");
  std::vector<CurvePoint> curve;
  while (std::getline(stream, line)) {
    const std::vector<std::string> cells = SplitLine(line);
    if (cells.size() < header.size()) continue;
    const auto cell = [&](size_t column) { return column < cells.size() ? ParseNumber(cells[column]) : kNotMeasured; };
    const CurvePoint point{cell(step), cell(seconds), cell(loss), cell(psnr)};
    if (std::isfinite(point.step) || std::isfinite(point.seconds)) curve.push_back(point);
  }
  return curve;
}

Curves ReadCurves(const std::filesystem::path& checkpoint_folder, const std::vector<std::string>& fields) {
  Curves curves;
  for (const std::string& name : fields) {
    for (const std::string& stem : {name, "block_" + name}) {
      const std::filesystem::path csv = checkpoint_folder / (stem + ".log.csv");
      std::error_code ignored;
      if (!std::filesystem::is_regular_file(csv, ignored)) continue;
      curves[name] = ParseCurve(base::ReadFile(csv));
      break;
    }
  }
  return curves;
}

}  // namespace skyquilt::evaluate::metrics
