// A made-up evaluation, complete enough to fill every part of the report page.
#pragma once

#include <filesystem>

#include "evaluate/brightness_report.h"
#include "evaluate/metrics.h"
#include "evaluate/report_page.h"

namespace skyquilt::evaluate {

struct SampleReport {
  Metrics metrics;
  survey::Survey survey;
  partition::BlockSet blocks;
  scene::TrainReport training;
  Curves curves;
  BrightnessReport brightness;
  ReportInput input;  // points into the above: do not copy

  // Writes the pictures under folder/images.
  explicit SampleReport(const std::filesystem::path& folder);
  SampleReport(const SampleReport&) = delete;
  SampleReport& operator=(const SampleReport&) = delete;

  // No GPS, no true depth, little coverage, most photos not placed, blocks that failed or were never trained: every warning but those of a
  // missing training record and of no scored photo at all.
  void MakePoor();
};

}  // namespace skyquilt::evaluate
