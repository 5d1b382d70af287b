// Training curves, from the one <field>.log.csv per field that stands beside its checkpoint.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace skyquilt::evaluate {

struct CurvePoint {
  double step = 0.0;
  double seconds = 0.0;
  double loss = 0.0;     // NaN when the column is absent or unreadable
  double psnr_db = 0.0;  // of the training batches
};

using Curves = std::map<std::string, std::vector<CurvePoint>>;  // by field: "context" or a block's name

// Of these fields; those without a file are left out. Throws base::InputError for a file that cannot be read.
Curves ReadCurves(const std::filesystem::path& checkpoint_folder, const std::vector<std::string>& fields);
// Columns by the names in the header: step, seconds, loss, psnr. Lines that do not parse (a write cut short) are skipped.
std::vector<CurvePoint> ParseCurve(const std::string& csv);

}  // namespace skyquilt::evaluate
