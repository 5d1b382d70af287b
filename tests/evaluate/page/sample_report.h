// An invented evaluation with data for every part of the report page.
#pragma once

#include <filesystem>

#include "evaluate/metrics/metrics.h"
#include "evaluate/page/brightness_report.h"
#include "evaluate/page/report_page.h"

namespace skyquilt::evaluate::page {

struct SampleReport {
  metrics::Metrics metrics;
  survey::Survey survey;
  partition::BlockSet blocks;
  scene::TrainReport training;
  metrics::Curves curves;
  BrightnessReport brightness;
  ReportInput input;  // points to the members above: do not copy

  // Writes the images to folder/images.
  explicit SampleReport(const std::filesystem::path& folder);
  SampleReport(const SampleReport&) = delete;
  SampleReport& operator=(const SampleReport&) = delete;

  // No GPS, no true depth, little coverage, most photos not placed, blocks that failed or were never trained: every warning but those of a
  // missing training record and of no scored photo at all.
  void MakePoor();
};

}  // namespace skyquilt::evaluate::page
