#include "prepare/georeference/tags/unfilled_tags.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/base/log.h"
#include "core/base/order_statistics.h"
#include "core/base/text.h"
#include "prepare/georeference/tags/tag_checks.h"
#include "prepare/input/prepared_photo.h"
#include "prepare/input/tag_accuracy.h"

namespace skyquilt::prepare::georeference {
namespace {

// Values that are filled, for comparison with 0.
struct HeightRange {
  std::optional<double> low, high;

  void Add(double value_m) {
    low = std::min(low.value_or(value_m), value_m);
    high = std::max(high.value_or(value_m), value_m);
  }
  bool Excludes0() const {
    constexpr double kLeastMargin_m = 5.0, kShare = 0.25;
    if (!low) return false;
    const double margin_m = std::max(kLeastMargin_m, kShare * (*high - *low));
    return *low > margin_m || *high < -margin_m;
  }
};

// Altitude less RelativeAltitude, over several photos.
struct HeightOffset {
  double metres = 0.0, sigma_m = 0.0;

  // Whether this difference is another one.
  bool Contradicts(double difference_m) const {
    constexpr double kLeast_m = 2.0, kSigmas = 5.0;
    return std::abs(difference_m - metres) > std::max(kLeast_m, kSigmas * sigma_m);
  }
};

bool HasAltitude(const survey::PhotoTags& tags) {
  return tags.gps && std::isfinite(tags.gps->height_m);
}

bool IsZero(const std::optional<double>& value) {
  return value && *value == 0.0;
}

// Nothing when fewer than three photos have both, or when their altitudes are all the same number, which nobody measured.
std::optional<HeightOffset> OffsetOf(const std::vector<input::PhotoFile>& photos, const std::vector<size_t>& of) {
  std::vector<double> altitudes, differences;
  for (const size_t i : of) {
    const survey::PhotoTags& tags = photos[i].tags;
    if (!HasAltitude(tags) || tags.gps->height_m == 0.0 || !tags.relative_altitude_m || *tags.relative_altitude_m == 0.0) continue;
    altitudes.push_back(tags.gps->height_m);
    differences.push_back(tags.gps->height_m - *tags.relative_altitude_m);
  }
  constexpr size_t kLeast = 3;
  if (differences.size() < kLeast || !HeightsVary(altitudes)) return std::nullopt;
  return HeightOffset{base::Median(differences), base::Nmad(differences)};
}

class Cleaner {
 public:
  Cleaner(double flight_gap_s, std::vector<input::PhotoFile>& photos) : photos_(photos) {
    found_.n_photos = photos.size();
    had_absolute_.assign(photos.size(), 0);
    std::vector<input::PreparedPhoto> without_pose;
    for (const input::PhotoFile& photo : photos) without_pose.push_back(input::PreparePhoto(photo, 0, {}));
    flight_ = input::SplitFlights(without_pose, flight_gap_s);
  }

  UnfilledTags Run() {
    for (const input::PhotoFile& photo : photos_) {
      for (const std::string& tag : photo.tags.zero_tags) ++found_.at_reading[tag];
    }
    ClearRelativeIfAllZero();
    FindOffsets();
    JudgeZeros();
    Fill();
    ClearGimbals();
    return found_;
  }

 private:
  const std::optional<HeightOffset>& Offset(size_t photo) const {
    const std::optional<HeightOffset>& of_flight = of_flight_[static_cast<size_t>(flight_[photo])];
    return of_flight ? of_flight : of_all_;
  }

  void ClearRelativeIfAllZero() {
    size_t n = 0;
    for (const input::PhotoFile& photo : photos_) {
      if (!photo.tags.relative_altitude_m) continue;
      if (*photo.tags.relative_altitude_m != 0.0) return;
      ++n;
    }
    for (input::PhotoFile& photo : photos_) photo.tags.relative_altitude_m.reset();
    found_.n_relative += n;
  }

  void FindOffsets() {
    std::vector<size_t> all;
    std::vector<std::vector<size_t>> flights(static_cast<size_t>(input::CountFlights(flight_)));
    for (size_t i = 0; i < photos_.size(); ++i) {
      all.push_back(i);
      flights[static_cast<size_t>(flight_[i])].push_back(i);
    }
    of_all_ = OffsetOf(photos_, all);
    for (const std::vector<size_t>& flight : flights) of_flight_.push_back(OffsetOf(photos_, flight));
  }

  // Of altitudes and RelativeAltitudes; those of one photo that are both 0 are judged apart, as neither can say anything of the other.
  void JudgeZeros() {
    HeightRange altitudes, relatives;
    for (const input::PhotoFile& photo : photos_) {
      const survey::PhotoTags& tags = photo.tags;
      if (HasAltitude(tags) && tags.gps->height_m != 0.0) altitudes.Add(tags.gps->height_m);
      if (tags.relative_altitude_m && *tags.relative_altitude_m != 0.0) relatives.Add(*tags.relative_altitude_m);
    }
    for (size_t i = 0; i < photos_.size(); ++i) {
      survey::PhotoTags& tags = photos_[i].tags;
      const std::optional<HeightOffset>& offset = Offset(i);
      const bool zero_altitude = HasAltitude(tags) && tags.gps->height_m == 0.0, zero_relative = IsZero(tags.relative_altitude_m);
      const bool comparable = offset && HasAltitude(tags) && tags.relative_altitude_m && zero_altitude != zero_relative;
      const bool contradicted = comparable && offset->Contradicts(tags.gps->height_m - *tags.relative_altitude_m);
      if (zero_altitude && (comparable ? contradicted : altitudes.Excludes0())) {
        tags.gps->height_m = std::numeric_limits<double>::quiet_NaN();
        had_absolute_[i] = IsZero(tags.absolute_altitude_m) ? 1 : 0;
        if (had_absolute_[i] != 0) tags.absolute_altitude_m.reset();
        ++found_.n_altitudes;
      }
      if (zero_relative && (comparable ? contradicted : relatives.Excludes0())) {
        tags.relative_altitude_m.reset();
        ++found_.n_relative;
      }
    }
  }

  void Fill() {
    for (size_t i = 0; i < photos_.size(); ++i) {
      survey::PhotoTags& tags = photos_[i].tags;
      const std::optional<HeightOffset>& offset = Offset(i);
      if (!tags.gps || HasAltitude(tags) || !tags.relative_altitude_m || !offset) continue;
      const double accuracy_m = input::AccuracyOf(tags).vertical_m;
      tags.gps->height_m = *tags.relative_altitude_m + offset->metres;
      // So that it counts as measured from what the other photos' altitudes are.
      if (had_absolute_[i] != 0 && tags.position_file.empty()) tags.absolute_altitude_m = tags.gps->height_m;
      // A barometer drifts, whatever the receiver states.
      constexpr double kBarometer_m = 1.0;
      tags.vertical_accuracy_m = std::max({accuracy_m, offset->sigma_m, kBarometer_m});
      ++found_.n_filled;
    }
  }

  static bool AllAnglesZero(const survey::PhotoTags& tags) {
    return IsZero(tags.gimbal_yaw_deg) && IsZero(tags.gimbal_pitch_deg) && IsZero(tags.gimbal_roll_deg);
  }

  void ClearGimbals() {
    constexpr double kLevel_deg = 5.0;
    size_t n_zero = 0, n_others = 0, n_tilted = 0;
    for (const input::PhotoFile& photo : photos_) {
      if (!photo.tags.gimbal_pitch_deg) continue;
      if (AllAnglesZero(photo.tags)) {
        ++n_zero;
        continue;
      }
      ++n_others;
      n_tilted += std::abs(*photo.tags.gimbal_pitch_deg) > kLevel_deg ? 1 : 0;
    }
    const bool unfilled = n_others == 0 ? n_zero > 1 : 2 * n_tilted > n_others;
    if (!unfilled) return;
    for (input::PhotoFile& photo : photos_) {
      survey::PhotoTags& tags = photo.tags;
      if (!AllAnglesZero(tags)) continue;
      tags.gimbal_yaw_deg.reset();
      tags.gimbal_pitch_deg.reset();
      tags.gimbal_roll_deg.reset();
    }
    found_.n_gimbal = n_zero;
  }

  std::vector<input::PhotoFile>& photos_;
  std::vector<int> flight_;
  std::optional<HeightOffset> of_all_;
  std::vector<std::optional<HeightOffset>> of_flight_;
  std::vector<char> had_absolute_;  // an AbsoluteAltitude of 0 that was no value
  UnfilledTags found_;
};

}  // namespace

std::string UnfilledTags::Describe() const {
  std::vector<std::string> zeros;
  if (n_altitudes > 0) zeros.push_back(fmt::format("altitude ({})", n_altitudes));
  if (n_relative > 0) zeros.push_back(fmt::format("RelativeAltitude ({})", n_relative));
  if (n_gimbal > 0) zeros.push_back(fmt::format("gimbal angles ({})", n_gimbal));
  for (const auto& [tag, n] : at_reading) zeros.push_back(fmt::format("{} ({})", tag, n));
  std::string text;
  if (!zeros.empty()) text = fmt::format("tags that are 0 count as missing, as 0 cannot be meant (photos of {}): {}", n_photos, base::Join(zeros));
  if (n_filled > 0) {
    text +=
        fmt::format("{}{} photos without altitude get it from RelativeAltitude and the altitudes of the others", text.empty() ? "" : "; ", n_filled);
  }
  return text;
}

UnfilledTags ClearUnfilledTags(double flight_gap_s, std::vector<input::PhotoFile>& photos) {
  if (photos.empty()) return {};
  return Cleaner(flight_gap_s, photos).Run();
}

void LogUnfilledTags(double flight_gap_s, std::vector<input::PhotoFile>& photos) {
  const UnfilledTags found = ClearUnfilledTags(flight_gap_s, photos);
  if (found.Any()) base::LogWarning("{}", found.Describe());
}

bool TurnPitchesThatLookUp(std::vector<input::PhotoFile>& photos) {
  constexpr double kSteep_deg = 60.0;
  size_t n = 0, n_steep = 0;
  for (const input::PhotoFile& photo : photos) {
    if (!photo.tags.gimbal_pitch_deg) continue;
    ++n;
    n_steep += *photo.tags.gimbal_pitch_deg > kSteep_deg ? 1 : 0;
  }
  if (n == 0 || 10 * n_steep < 9 * n) return false;
  for (input::PhotoFile& photo : photos) {
    if (photo.tags.gimbal_pitch_deg) photo.tags.gimbal_pitch_deg = -*photo.tags.gimbal_pitch_deg;
  }
  base::LogWarning(
      "the gimbal pitch of {} of {} photos is above +{:g} degrees, as if the cameras looked up: it is taken with the opposite sign. "
      "GimbalPitchDegree "
      "should be -90 for a camera that looks straight down",
      n_steep, n, kSteep_deg);
  return true;
}

}  // namespace skyquilt::prepare::georeference
