// Writes what an evaluation found: the folder report/ with its page, its pictures, brightness.json and metrics.json.
#pragma once

#include <vector>

#include "evaluate/brightness_report.h"
#include "evaluate/evaluate_input.h"
#include "evaluate/held_out_scorer.h"
#include "evaluate/metrics.h"
#include "evaluate/report_page.h"

namespace skyquilt::evaluate {

// The pictures of the held-out photos. They are written as the photos are scored: all together would not fit in memory.
class ReportPictures {
 public:
  // Chooses whom to show. `input` must outlive it.
  ReportPictures(const EvaluateInput& input, const std::vector<int>& held_out);

  // Whether Write wants the photo at normal brightness.
  bool ShowsNormal(int photo) const;
  // Every scored photo in turn, also those that are not shown. Throws base::InputError.
  void Write(const ScoredPhoto& scored);

  const std::vector<PhotoImages>& images() const { return images_; }  // one per photo, empty where it is not shown
  const BrightnessReport& brightness() const { return brightness_; }  // views included

 private:
  void WriteView(const ScoredPhoto& scored, size_t view);

  const EvaluateInput& input_;
  std::vector<int> pictured_, contrasted_;
  std::vector<PhotoImages> images_;
  BrightnessReport brightness_;
};

// Everything but those pictures; metrics.json last, because its presence says that the evaluation is complete. Throws base::InputError.
void WriteReport(const EvaluateInput& input, const Metrics& metrics, const ReportPictures& pictures);

}  // namespace skyquilt::evaluate
