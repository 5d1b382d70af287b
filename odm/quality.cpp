#include "odm/quality.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/errors.h"

namespace skyquilt::odm {
namespace {

// OpenDroneMap's default, medium, is about half of what it spends for poses, depth maps, mesh and maps of a 12-megapixel photo on a core.
constexpr double kSecondsPerPhoto = 40.0;
constexpr double kUsualMegapixels = 12.0;
constexpr double kLeastSeconds = 60.0, kMostSeconds = 86400.0;
constexpr double kFastShare = 0.25;  // of --fast-orthophoto

struct QualityRow {
  const char* name;
  const char* preset;
  double time_factor;
  int feature_size;
};
constexpr std::array<QualityRow, 5> kQualityRows = {{{"ultra", "quality", 6.0, 3200},
                                                     {"high", "quality", 2.5, 1600},
                                                     {"medium", "default", 1.0, 1200},
                                                     {"low", "fast", 0.5, 800},
                                                     {"lowest", "fast", 0.25, 600}}};

const QualityRow& RowNamed(const std::string& name) {
  const auto* found = std::find_if(kQualityRows.begin(), kQualityRows.end(), [&name](const QualityRow& row) { return name == row.name; });
  SKYQUILT_CHECK(found != kQualityRows.end(), name);
  return *found;
}

}  // namespace

Effort EffortOf(const std::string& pc_quality, const std::string& feature_quality, bool fast_orthophoto, const Workload& workload) {
  const QualityRow& row = RowNamed(pc_quality);
  const double megapixels = workload.megapixels > 0.0 ? workload.megapixels : kUsualMegapixels;
  const double share = fast_orthophoto ? kFastShare : row.time_factor;
  const double seconds = kSecondsPerPhoto * share * workload.photos * std::sqrt(megapixels / kUsualMegapixels) / std::max(1, workload.cores);
  return {.preset = fast_orthophoto ? "fast" : row.preset,
          .training_s = std::clamp(10.0 * std::round(0.1 * seconds), kLeastSeconds, kMostSeconds),
          .feature_size = RowNamed(feature_quality).feature_size};
}

}  // namespace skyquilt::odm
