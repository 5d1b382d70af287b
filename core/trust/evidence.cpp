#include "core/trust/evidence.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>
#include <utility>

#include "core/base/errors.h"

namespace skyquilt::trust {
namespace {

constexpr int kLevels = 3;
constexpr int64_t kMostCells = int64_t{1} << 19U;  // from the origin, along each axis
constexpr unsigned kBits = 21;
const float kLogLeast = 2.0F * std::log(kLeastError);  // the smallest log residual; the largest is 0

using Place = Eigen::Matrix<int64_t, 3, 1>;

Place CellOf(const Eigen::Vector3d& place_enu, double cell_m) {
  return (place_enu / cell_m).array().floor().cast<int64_t>();
}

bool IsNear(const Place& cell) {
  return (cell.array() >= -kMostCells).all() && (cell.array() < kMostCells).all();
}

uint64_t KeyOf(const Place& cell) {
  uint64_t key = 0;
  for (int axis = 0; axis < 3; ++axis) key = (key << kBits) | static_cast<uint64_t>(cell[axis] + 2 * kMostCells);
  return key;
}

Place PlaceOf(uint64_t key) {
  Place cell;
  for (int axis = 2; axis >= 0; --axis) {
    cell[axis] = static_cast<int64_t>(key & ((uint64_t{1} << kBits) - 1)) - 2 * kMostCells;
    key >>= kBits;
  }
  return cell;
}

struct Keyed {
  uint64_t key;
  int photo;
  float log_error;
};

struct Sums {
  double log_error = 0.0;
  int sightings = 0;
  int photos = 0;
};

// Per cell, from sightings in any order.
std::vector<std::pair<uint64_t, Sums>> SumsOf(const std::vector<Sighting>& sightings, double cell_m) {
  std::vector<Keyed> keyed;
  keyed.reserve(sightings.size());
  for (const Sighting& sighting : sightings) {
    const Place cell = CellOf(sighting.place_enu, cell_m);
    SKYQUILT_CHECK(IsNear(cell), "a place far outside the scene");
    keyed.push_back({KeyOf(cell), sighting.photo, std::log(sighting.squared_error + kLeastError * kLeastError)});
  }
  std::ranges::sort(keyed,
                    [](const Keyed& a, const Keyed& b) { return std::tie(a.key, a.photo, a.log_error) < std::tie(b.key, b.photo, b.log_error); });
  std::vector<std::pair<uint64_t, Sums>> cells;
  int last_photo = 0;
  for (const Keyed& one : keyed) {
    if (cells.empty() || cells.back().first != one.key) cells.push_back({one.key, {}});
    Sums& sums = cells.back().second;
    if (sums.sightings == 0 || one.photo != last_photo) ++sums.photos;
    last_photo = one.photo;
    sums.log_error += static_cast<double>(one.log_error);
    ++sums.sightings;
  }
  return cells;
}

// Mean over a cell and its 26 neighbours, weighted by sightings and by 1/2 for each step aside.
float Blurred(const std::unordered_map<uint64_t, Sums>& cells, uint64_t key) {
  const Place cell = PlaceOf(key);
  double sum = 0.0, weight = 0.0;
  for (int64_t z = -1; z <= 1; ++z) {
    for (int64_t y = -1; y <= 1; ++y) {
      for (int64_t x = -1; x <= 1; ++x) {
        const auto found = cells.find(KeyOf(cell + Place(x, y, z)));
        if (found == cells.end()) continue;
        const double share = std::ldexp(1.0, -static_cast<int>(std::abs(x) + std::abs(y) + std::abs(z)));
        sum += share * found->second.log_error;
        weight += share * found->second.sightings;
      }
    }
  }
  return static_cast<float>(sum / weight);
}

std::string Prefix(int level) {
  return "evidence/" + std::to_string(level) + "/";
}

}  // namespace

EvidenceCells::EvidenceCells(std::vector<Sighting> sightings, double cell_m) : cell_m_(cell_m) {
  SKYQUILT_CHECK(std::isfinite(cell_m) && cell_m > 0.0, std::to_string(cell_m));
  for (int level = 0; level < kLevels; ++level) {
    const std::vector<std::pair<uint64_t, Sums>> sums = SumsOf(sightings, std::ldexp(cell_m, level));
    const std::unordered_map<uint64_t, Sums> by_key(sums.begin(), sums.end());
    Cells& cells = levels_[level];
    cells.reserve(sums.size());
    for (const auto& [key, of_cell] : sums) cells.emplace(key, Cell{Blurred(by_key, key), static_cast<float>(of_cell.photos)});
  }
}

Evidence EvidenceCells::At(const Eigen::Vector3d& place_enu) const {
  Evidence evidence;
  if (!place_enu.allFinite()) return evidence;
  for (int level = 0; level < kLevels; ++level) {
    const Place cell = CellOf(place_enu, std::ldexp(cell_m_, level));
    if (!IsNear(cell)) return evidence;
    const auto found = levels_[level].find(KeyOf(cell));
    if (found == levels_[level].end()) continue;
    if (!evidence.seen) evidence.log_residual = found->second.log_residual;
    evidence.seen = true;
    evidence.photos = found->second.photos;
    if (level > 0) break;
  }
  return evidence;
}

void EvidenceCells::Put(checkpoint::ArchiveWriter& writer) const {
  writer.SetAttribute("evidence_cell_m", cell_m_);
  for (int level = 0; level < kLevels; ++level) {
    std::vector<int64_t> keys;
    for (const auto& [key, cell] : levels_[level]) keys.push_back(static_cast<int64_t>(key));
    std::ranges::sort(keys);
    // One byte each: residuals from kLeastError to 1 in steps of 5 %, and up to 255 photos.
    std::vector<uint8_t> values;
    for (const int64_t key : keys) {
      const Cell& cell = levels_[level].at(static_cast<uint64_t>(key));
      values.push_back(static_cast<uint8_t>(std::lround(std::clamp(1.0F - cell.log_residual / kLogLeast, 0.0F, 1.0F) * 255.0F)));
      values.push_back(static_cast<uint8_t>(std::min(cell.photos, 255.0F)));
    }
    writer.PutOwned(Prefix(level) + "keys", std::move(keys));
    writer.PutOwned(Prefix(level) + "values", std::move(values));
  }
}

EvidenceCells EvidenceCells::Get(const checkpoint::ArchiveReader& reader, const std::filesystem::path& file) {
  EvidenceCells cells;
  cells.cell_m_ = reader.DoubleAttribute("evidence_cell_m");
  bool ok = std::isfinite(cells.cell_m_) && cells.cell_m_ > 0.0;
  for (int level = 0; ok && level < kLevels; ++level) {
    const std::vector<int64_t> keys = reader.Ints(Prefix(level) + "keys");
    const std::vector<uint8_t> values = reader.Bytes(Prefix(level) + "values");
    ok = values.size() == 2 * keys.size();
    if (!ok) break;
    cells.levels_[level].reserve(keys.size());
    for (size_t i = 0; i < keys.size(); ++i) {
      const float log_residual = kLogLeast * (1.0F - static_cast<float>(values[2 * i]) / 255.0F);
      cells.levels_[level].emplace(static_cast<uint64_t>(keys[i]), Cell{log_residual, static_cast<float>(values[2 * i + 1])});
    }
  }
  if (!ok) throw base::InputError(file, "is damaged: its cells do not fit together", "Merge the scene again: skyquilt merge PROJECT --restart");
  return cells;
}

}  // namespace skyquilt::trust
