// The geo-reference under faults of the tags: what it finds, and whether its stated accuracy is true.
#include <spdlog/fmt/fmt.h>

#include "bench/numerics/fault_survey.h"
#include "bench/numerics/groups.h"

namespace skyquilt::bench {

NumericGroup PlaceGroup(const NumericsOptions& options) {
  NumericGroup group{.id = "place"};
  if (options.quick) return group;
  for (uint64_t seed = 1; seed <= 200; ++seed) {
    const simulate::SimulateOptions faults = RandomFaults(seed);
    const PlaceErrors e = FindPlace(MakeFaultSurvey(faults, 1.5));
    std::string codes;
    for (const std::string& code : e.problems) codes += code + ",";
    fmt::print(
        "{} {} n lag {:.2f} drift {:.0f} jump {:.0f} out {:.2f} h {} gimbal {} line {} hill {:.0f} noise {:.1f} obl {} | scale {:.3f}/{:.3f} tilt "
        "{:.3f}/{:.3f} yaw {:.3f}/{:.3f} hor {:.2f}/{:.2f} ver {:.2f}/{:.2f} lag {:.2f} {}\n",
        seed, e.georeferenced ? "ok" : "LOCAL", faults.tag_lag_s, faults.tag_drift_m, faults.tag_jump_m, faults.tag_outliers, faults.tag_heights,
        faults.gimbal_tags, faults.single_line, faults.hillside_deg, faults.gps_noise_m, faults.oblique, e.scale_percent, e.sigma.scale_percent,
        e.tilt_deg, e.sigma.tilt_deg, e.yaw_deg, e.sigma.yaw_deg, e.horizontal_m, e.sigma.horizontal_m, e.vertical_m, e.sigma.vertical_m, e.lag_s,
        codes);
  }
  return group;
}

}  // namespace skyquilt::bench
