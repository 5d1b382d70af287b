// Reads training curves for the report, from the <field>.log.csv beside each field's checkpoint.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace skyquilt::evaluate::metrics {

struct CurvePoint {
  double step = 0.0;
  double seconds = 0.0;  // of training so far
  double loss = 0.0;     // NaN when the column is absent or unreadable
  double psnr_db = 0.0;  // of the training batches
};

using Curves = std::map<std::string, std::vector<CurvePoint>>;  // by field: "context" or a block's name

// Curves of the given fields. Fields without a file are left out. Throws base::InputError for a file that cannot be read.
Curves ReadCurves(const std::filesystem::path& checkpoint_folder, const std::vector<std::string>& fields);
// Finds columns by the names in the header: step, seconds, loss, psnr. Skips lines that cannot be parsed, such as an incomplete last line.
std::vector<CurvePoint> ParseCurve(const std::string& csv);

}  // namespace skyquilt::evaluate::metrics
