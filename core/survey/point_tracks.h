// Which photos saw each sparse point, in flat arrays of 4 bytes per observation, so that surveys of thousands of photos fit in memory. The file
// tracks.bin keeps them beside points.ply and kept_points.ply; docs/files.md has its layout.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace skyquilt::survey {

class PointTracks {
 public:
  // Adds the track of the next point: indices into Survey::photos. Sorts them and removes repetitions.
  void Add(std::vector<int32_t> photos);

  // No tracks are known, as in surveys of older programs.
  bool Empty() const { return begin_.size() == 1; }
  size_t points() const { return begin_.size() - 1; }
  size_t observations() const { return photos_.size(); }
  // Ascending indices into Survey::photos; empty when no tracks are known, and for a point whose photos are all gone. point < points() unless
  // Empty().
  std::span<const int32_t> PhotosOf(size_t point) const;
  // The same tracks in a survey with fewer photos. new_index: per photo of today; negative for those that are gone.
  PointTracks Renumbered(std::span<const int32_t> new_index) const;

  bool operator==(const PointTracks&) const = default;

 private:
  std::vector<size_t> begin_ = {0};  // per point where its photos begin, and the end of the last
  std::vector<int32_t> photos_;
};

// Tracks of a survey: of the points that training sees, and of those kept from it.
struct SurveyTracks {
  PointTracks points, kept_points;
};

// What the other files of a survey say, for comparison.
struct TrackCounts {
  size_t photos = 0, points = 0, kept_points = 0, observations = 0;
};

// Throws base::InputError when the file cannot be written.
void WriteTracks(const PointTracks& points, const PointTracks& kept_points, size_t n_photos, const std::filesystem::path& file);
// Throws base::InputError: missing, not such a file, of another size than its counts, counts other than `expected`, photos out of range or not
// ascending.
SurveyTracks ReadTracks(const std::filesystem::path& file, const TrackCounts& expected);

}  // namespace skyquilt::survey
