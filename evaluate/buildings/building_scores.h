// Figures about the found buildings, as in metrics.json. NaN where nothing was measured.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "evaluate/measured.h"

namespace skyquilt::evaluate::buildings {

// How much of what is there was found, and how much of what was found is there. Per building, and per square metre of footprint.
struct BuildingDetection {
  std::string size;  // "all", "10 to 50 m2", "over 50 m2"
  int64_t outlines = 0, matched = 0, missed = 0, invented = 0;
  double completeness = kNotMeasured;  // matched / (matched + missed)
  double correctness = kNotMeasured;   // matched / (matched + invented)
  double quality = kNotMeasured;       // matched / (matched + missed + invented)
  double completeness_area = kNotMeasured;
  double correctness_area = kNotMeasured;
  double quality_area = kNotMeasured;
};

// Errors of one measure, found minus true, in metres, square metres or degrees.
struct BuildingErrors {
  std::string measure;  // "ground", "eave", "ridge", "deck", "height", "length", "width", "yaw", "footprint"
  int64_t n = 0;
  double bias = kNotMeasured;  // mean
  double rmse = kNotMeasured;
  double nmad = kNotMeasured;
  double median_abs = kNotMeasured;
  double p90_abs = kNotMeasured;
  int64_t with_sigma = 0;              // of them, those whose uncertainty is known
  double within_sigma = kNotMeasured;  // share of those that are within 1.96 sigma: 0.95 when sigma is right
};

// Matched buildings of one true kind of roof.
struct BuildingRoofScores {
  std::string roof;  // "all", "flat", "gable", "hip"
  int64_t matched = 0;
  double roof_right = kNotMeasured;    // share whose kind of roof was found
  std::vector<BuildingErrors> errors;  // one per measure that any has
};

// What became of one true outline that counts, or an invented building.
struct BuildingOutcome {
  enum class Fate : uint8_t { kMatched, kMissed, kInvented };
  // Of one measure: found minus true, and the uncertainty that was claimed (NaN: not known).
  struct Error {
    std::string measure;
    double error = 0.0;
    double sigma = kNotMeasured;
  };

  Fate fate = Fate::kMissed;
  int truth_id = -1, found_id = -1;        // -1: there is none
  std::string roof = {}, roof_found = {};  // kinds; empty: there is none
  double area_m2 = kNotMeasured;           // of the outline; of the footprint of an invented building
  double overlap = kNotMeasured;           // intersection over union of a matched one
  std::vector<Error> errors = {};          // of a matched one, those that are finite
};

// What is only known with the truth.
struct BuildingTruthScores {
  int64_t outlines_not_counted = 0, found_not_counted = 0;
  std::vector<BuildingDetection> detection;  // all, then by size
  std::vector<BuildingRoofScores> roofs;     // all, then by kind
  int64_t corners = 0;                       // of matched outlines
  double corners_found = kNotMeasured;       // share of them with a found corner within 3 m
  double corner_rmse_m = kNotMeasured;       // of the plan distances of those
  std::vector<BuildingOutcome> each;         // outlines that count, in their order, then invented buildings
};

struct BuildingScores {
  int64_t found = 0;
  int64_t accepted = 0;
  bool metric = true;           // false: lengths are units of unknown size
  double gsd_m = kNotMeasured;  // ground sampling distance of the finest block
  double footprint_m2 = 0.0;    // sums over all found buildings
  double volume_m3 = 0.0;
  int64_t solids_rejected = 0;  // buildings whose solid with its roof is invalid
  int64_t blocks_rejected = 0;  // and whose block is
  int64_t blocks_instead = 0;   // buildings that have a block instead of a solid with its roof
  std::optional<BuildingTruthScores> truth;
};

}  // namespace skyquilt::evaluate::buildings
