// An invented evaluation with data for every part of the report page.
#pragma once

#include <filesystem>

#include "evaluate/metrics/metrics.h"
#include "evaluate/page/brightness_report.h"
#include "evaluate/page/report_page.h"

namespace skyquilt::evaluate::page {

// Of nothing.
struct ReportParts {
  metrics::Metrics metrics;
  survey::Survey survey;
  partition::BlockSet blocks;
  scene::TrainReport training;
  ReportInput input;  // points to the members above: do not copy

  ReportParts() {
    input.metrics = &metrics;
    input.survey = &survey;
    input.blocks = &blocks;
    input.training = &training;
  }
  ReportParts(const ReportParts&) = delete;
  ReportParts& operator=(const ReportParts&) = delete;
};

struct SampleReport : ReportParts {
  metrics::Curves curves;
  BrightnessReport brightness;

  // Writes the images to folder/images.
  explicit SampleReport(const std::filesystem::path& folder);

  // No GPS, no true depth, little coverage, most photos not placed, blocks that failed or were never trained: every warning but those of a
  // missing training record and of no scored photo at all.
  void MakePoor();
};

}  // namespace skyquilt::evaluate::page
