// A made-up evaluation, complete enough to fill every part of the report page.
#pragma once

#include <filesystem>

#include "coordinator/report/brightness_report.h"
#include "coordinator/report/metrics.h"
#include "coordinator/report/report_page.h"
#include "coordinator/report/train_log.h"

namespace skyquilt::report {

struct SampleReport {
  Metrics metrics;
  survey::Survey survey;
  partition::BlockSet blocks;
  TrainLog log;
  BrightnessReport brightness;
  ReportInput input;  // points into the above: do not copy

  // Writes the pictures under folder/images.
  explicit SampleReport(const std::filesystem::path& folder);
  SampleReport(const SampleReport&) = delete;
  SampleReport& operator=(const SampleReport&) = delete;
};

}  // namespace skyquilt::report
