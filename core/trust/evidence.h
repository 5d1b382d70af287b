// What the training photos say about each place of a scene: how many of them show it, and how well the scene agrees with them there.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "core/checkpoint/archive.h"

namespace skyquilt::trust {

// One pixel of a training photo beside the scene's rendering of it.
struct Sighting {
  Eigen::Vector3d place_enu;  // where the ray meets the scene's surface, metres
  int photo = 0;
  float squared_error = 0.0F;  // mean over red, green and blue, of display values from 0 to 1
};

struct Evidence {
  bool seen = false;          // a training photo was compared here or beside
  float log_residual = 0.0F;  // mean logarithm of (squared error + kLeastError^2): one thing in one photo does not count more than others
  float photos = 0.0F;        // that show the place
};

// Display values; below it the eye and 8 bits see no error.
constexpr float kLeastError = 1.0F / 255.0F;

// Cells of three sizes (cell_m, twice and four times as large), of which only those with sightings are stored. The same for any order of sightings of
// one photo. Thread-safe once built.
class EvidenceCells {
 public:
  EvidenceCells() = default;  // nothing is seen
  // cell_m: positive. A place farther than 2^19 cells from the origin throws std::logic_error.
  EvidenceCells(std::vector<Sighting> sightings, double cell_m);

  double cell_m() const { return cell_m_; }
  size_t size() const { return levels_[0].size(); }  // smallest cells
  // Residual of the smallest cells that have sightings (each blurred over its neighbours), photos of cells twice as large, where single pixels of all
  // photos that show the place were compared.
  Evidence At(const Eigen::Vector3d& place_enu) const;

  // Under "evidence/".
  void Put(checkpoint::ArchiveWriter& writer) const;
  // Throws base::InputError when arrays are absent or their sizes disagree.
  static EvidenceCells Get(const checkpoint::ArchiveReader& reader, const std::filesystem::path& file);

 private:
  struct Cell {
    float log_residual = 0.0F;
    float photos = 0.0F;
  };
  using Cells = std::unordered_map<uint64_t, Cell>;

  double cell_m_ = 1.0;
  Cells levels_[3];
};

}  // namespace skyquilt::trust
