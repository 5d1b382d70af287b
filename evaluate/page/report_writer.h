// Writes the results of an evaluation: the folder report/ with its page, images, brightness.json and metrics.json.
#pragma once

#include <vector>

#include "evaluate/buildings/buildings_report.h"
#include "evaluate/evaluate_input.h"
#include "evaluate/metrics/metrics.h"
#include "evaluate/ortho/ortho_scores.h"
#include "evaluate/page/brightness_report.h"
#include "evaluate/page/report_page.h"
#include "evaluate/page/written_pictures.h"
#include "evaluate/photos/held_out_scorer.h"

namespace skyquilt::evaluate::page {

// Images of the held-out photos. Written as soon as a photo is scored, because together they may not fit in memory.
class ReportPictures {
 public:
  // Chooses the photos to show. `input` must outlive it.
  ReportPictures(const EvaluateInput& input, const std::vector<int>& held_out);

  // Whether Write needs ScoredPhoto::normal of this photo.
  bool ShowsNormal(int photo) const;
  // Call for every scored photo in order, also those that are not shown. Throws base::InputError when a file cannot be written.
  void Write(const photos::ScoredPhoto& scored);

  // What was written so far, to save the list and to go on from a saved one.
  WrittenPictures& written() { return written_; }
  const WrittenPictures& written() const { return written_; }
  BrightnessReport Brightness() const;  // with the views so far

 private:
  void WriteView(const photos::ScoredPhoto& scored, size_t view);

  const EvaluateInput& input_;
  std::vector<int> pictured_, contrasted_, with_mesh_;
  WrittenPictures written_;
  BrightnessReport brightness_;  // without views
};

// Writes all other files, pictures of the buildings included (null: none were searched), but those of marks; metrics.json last, so that it exists
// only when the evaluation is complete. Throws base::InputError when a file cannot be written.
void WriteReport(const EvaluateInput& input, const metrics::Metrics& metrics, const ReportPictures& pictures, std::vector<control::MarkPicture> marks,
                 buildings::BuildingsReport* found, const std::vector<ortho::OrthoCrop>& ortho_crops);

}  // namespace skyquilt::evaluate::page
