// odm_report/stats.json: the figures that WebODM shows of a task, by OpenDroneMap's keys.
#pragma once

#include <cstdint>
#include <limits>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "core/survey/exif.h"
#include "core/survey/survey.h"

namespace skyquilt::odm {

struct StatsInput {
  const survey::Survey* survey = nullptr;
  const std::vector<survey::PhotoTags>* tags = nullptr;  // of its photos
  double seconds = 0.0;                                  // of all stages
  double gsd_m = std::numeric_limits<double>::quiet_NaN();
  double area_m2 = std::numeric_limits<double>::quiet_NaN();  // of the orthophoto
  int64_t cloud_points = -1;                                  // negative: there is no cloud
};

// Unknown figures are left out.
nlohmann::ordered_json StatsJson(const StatsInput& input);

}  // namespace skyquilt::odm
