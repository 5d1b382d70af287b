// Errors in the tags of simulated photos, as real drones and cameras make them. Only what the tags say changes; poses and pixels stay true. No pixels
// are needed: PlanFlight and ApplyTagFaults make the tags of a survey in a millisecond.
#pragma once

#include <cstdint>
#include <vector>

namespace skyquilt::simulate {

struct PhotoPlan;

enum class HeightTags { kTrue, kZero, kNone };  // kTrue: as measured, with the errors below

// As the options of the same names (simulate_options.h), and simulate.tags; the default is a drone without these errors.
struct TagFaults {
  double lag_s = 0.0;
  double drift_m = 0.0;
  double jump_m = 0.0;
  double outlier_share = 0.0;  // of the photos, 0 to 1
  double outlier_m = 50.0;
  double bias_m = 0.0;
  double height_offset_m = 0.0;
  HeightTags heights = HeightTags::kTrue;
  bool swapped = false;
  bool equal = false;
  bool gimbal_tags = true;
  double gimbal_common_error_deg = 0.0;
  double gimbal_random_error_deg = 0.0;
  bool speed_tags = false;
  bool position_tags = true;  // of latitude, longitude and heights
};

// Adds the errors to the tags of `photos`, which are in order of capture. Errors of positions add up, in ENU metres, on top of the GPS noise that is
// there already; the height above take-off is the barometer's and has none of them. The same seed gives the same errors, and each kind has its own
// random numbers, so that switching one on does not change another.
void ApplyTagFaults(const TagFaults& faults, uint32_t seed, std::vector<PhotoPlan>& photos);

}  // namespace skyquilt::simulate
