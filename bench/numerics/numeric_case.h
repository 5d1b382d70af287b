// One statement about numbers at the extremes, and what running it showed.
#pragma once

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace skyquilt::bench {

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();
constexpr double kEver = std::numeric_limits<double>::infinity();

// The largest of some errors. A NaN among them stays.
class Worst {
 public:
  void Take(double error) {
    if (!std::isnan(value_) && !(error <= value_)) value_ = error;
  }
  double value() const { return value_; }

 private:
  double value_ = 0.0;
};

// What a case saw. A case with a limit passes when `holds` and worst <= limit; a NaN never does.
struct Finding {
  std::string seen = {};
  double worst = kNoNumber;  // in the case's unit
  bool holds = true;         // whatever else was expected beside the limit
};

struct NumericCase {
  std::string name = {};
  std::string expected = {};    // in words
  std::string unit = {};        // of the worst error; may be empty
  double limit = kNoNumber;     // largest error allowed; NaN: only `holds` counts
  bool for_comparison = false;  // a pipeline that is not ours: shown, never judged
  std::function<Finding()> run = {};
};

// Cases of one kind. `charts` is asked for <figure>s after all of the group's cases have run.
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

// Runs a case. An exception that a case throws is its failure, with the message as what was seen; base::Interrupted passes through.
NumericRow RunCase(const std::string& group, const NumericCase& numeric_case);

// "3.1e-05 mm"; an en dash for NaN.
std::string FormatError(double value, const std::string& unit);

}  // namespace skyquilt::bench
