// A numerical check: what is expected, how to run it, and its result.
#pragma once

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace skyquilt::bench {

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();
constexpr double kEver = std::numeric_limits<double>::infinity();

// The largest of several errors. Once NaN, it stays NaN.
class Worst {
 public:
  void Take(double error) {
    if (!std::isnan(value_) && !(error <= value_)) value_ = error;
  }
  double value() const { return value_; }

 private:
  double value_ = 0.0;
};

// Result of a case. A case with a limit passes when `holds` is true and worst <= limit; a NaN never passes.
struct CaseResult {
  std::string seen = {};     // what was measured, in words
  double worst = kNoNumber;  // largest error, in the case's unit
  bool holds = true;         // whether everything else that was expected is true
};

struct NumericCase {
  std::string name = {};
  std::string expected = {};    // in words
  std::string unit = {};        // of the worst error; may be empty
  double limit = kNoNumber;     // largest error allowed; NaN: only `holds` counts
  bool for_comparison = false;  // shown but not judged, for instance a single-precision pipeline
  std::function<CaseResult()> run = {};
};

// Cases of one kind. charts: called after all cases of the group have run; returns HTML <figure> elements.
struct NumericGroup {
  std::string id = {}, title = {}, lead = {};
  std::vector<NumericCase> cases = {};
  std::function<std::vector<std::string>()> charts = {};
};

enum class Verdict { kPassed, kFailed, kShown };
const char* VerdictName(Verdict verdict);

struct NumericRow {
  std::string group, name, expected, seen, unit;
  double worst = kNoNumber, limit = kNoNumber;
  Verdict verdict = Verdict::kFailed;
  double seconds = 0.0;
};

// Runs a case. When it throws, the case fails and `seen` is the message; only base::Interrupted is not caught.
NumericRow RunCase(const std::string& group, const NumericCase& numeric_case);

// |a - b| over |b|, both as vectors of one length; |a| where b is zero.
double RelativeDistance(const std::vector<double>& a, const std::vector<double>& b);

// "3.1e-05 mm"; an en dash for NaN.
std::string FormatError(double value, const std::string& unit);

}  // namespace skyquilt::bench
