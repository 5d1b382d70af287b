#include "bench/numerics/numeric_case.h"

#include <fmt/core.h>

#include <chrono>

#include "core/base/cancel.h"
#include "core/base/errors.h"

namespace skyquilt::bench {

const char* VerdictName(Verdict verdict) {
  switch (verdict) {
    case Verdict::kPassed:
      return "passed";
    case Verdict::kFailed:
      return "FAILED";
    case Verdict::kShown:
      return "for comparison";
  }
  return "";
}

NumericRow RunCase(const std::string& group, const NumericCase& numeric_case) {
  base::ThrowIfCancelled();
  NumericRow row{.group = group,
                 .name = numeric_case.name,
                 .expected = numeric_case.expected,
                 .seen = "",
                 .unit = numeric_case.unit,
                 .worst = kNoNumber,
                 .limit = numeric_case.limit,
                 .verdict = Verdict::kFailed,
                 .seconds = 0.0};
  const auto start = std::chrono::steady_clock::now();
  try {
    const CaseResult finding = numeric_case.run();
    row.seen = finding.seen;
    row.worst = finding.worst;
    const bool within = std::isnan(row.limit) || row.worst <= row.limit;
    row.verdict = finding.holds && within ? Verdict::kPassed : Verdict::kFailed;
  } catch (const base::Interrupted&) {
    throw;
  } catch (const std::exception& error) {
    row.seen = std::string("ended with an error: ") + error.what();
  }
  if (numeric_case.for_comparison) row.verdict = Verdict::kShown;
  row.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return row;
}

double RelativeDistance(const std::vector<double>& a, const std::vector<double>& b) {
  double apart = 0.0, size = 0.0;
  for (size_t i = 0; i < a.size(); ++i) {
    apart += (a[i] - b[i]) * (a[i] - b[i]);
    size += b[i] * b[i];
  }
  return std::sqrt(size > 0.0 ? apart / size : apart);
}

std::string FormatError(double value, const std::string& unit) {
  if (std::isnan(value)) return "\xE2\x80\x93";
  const bool plain = std::abs(value) >= 100.0 && std::abs(value) < 1e6;
  const std::string number = plain ? fmt::format("{:.0f}", value) : fmt::format("{:.2g}", value);
  return unit.empty() ? number : number + " " + unit;
}

}  // namespace skyquilt::bench
