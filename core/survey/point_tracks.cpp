#include "core/survey/point_tracks.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <functional>
#include <string>
#include <string_view>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/memory_map.h"

namespace skyquilt::survey {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::string_view kTracksMagic = "SKYTRACK";
constexpr uint32_t kTracksVersion = 1;
constexpr const char* kPrepareAgain = "Run 'skyquilt prepare' again";

struct TracksHeader {
  std::array<char, 8> magic{};
  uint32_t version = kTracksVersion;
  uint32_t photos = 0;
  uint64_t points = 0, kept_points = 0;  // a track each
  uint64_t observations = 0, kept_observations = 0;
};
static_assert(sizeof(TracksHeader) == 48);

// Track lengths, then photos.
void AppendTracks(const PointTracks& tracks, std::string& content) {
  const auto put = [&content](const void* data, size_t n_bytes) { content.append(static_cast<const char*>(data), n_bytes); };
  for (size_t i = 0; i < tracks.points(); ++i) {
    const auto length = static_cast<uint32_t>(tracks.PhotosOf(i).size());
    put(&length, sizeof(length));
  }
  for (size_t i = 0; i < tracks.points(); ++i) put(tracks.PhotosOf(i).data(), tracks.PhotosOf(i).size_bytes());
}

// `bytes`: at least the lengths and photos of so many points and observations.
PointTracks ParseTracks(const char* bytes, uint64_t n_points, uint64_t n_observations, uint32_t n_photos, const std::filesystem::path& file) {
  std::vector<uint32_t> lengths(n_points);
  if (n_points > 0) std::memcpy(lengths.data(), bytes, n_points * sizeof(uint32_t));
  const char* at = bytes + n_points * sizeof(uint32_t);
  uint64_t left = n_observations;
  PointTracks tracks;
  for (const uint32_t length : lengths) {
    if (length > left) throw base::InputError(file, "has tracks that are longer than all observations together", kPrepareAgain);
    left -= length;
    std::vector<int32_t> photos(length);
    if (length > 0) std::memcpy(photos.data(), at, length * sizeof(int32_t));
    at += length * sizeof(int32_t);
    const bool in_range = length == 0 || (photos.front() >= 0 && static_cast<uint32_t>(photos.back()) < n_photos);
    if (!in_range || std::adjacent_find(photos.begin(), photos.end(), std::greater_equal<>()) != photos.end()) {
      throw base::InputError(file, "has a track whose photos are not ascending numbers below " + std::to_string(n_photos), kPrepareAgain);
    }
    tracks.Add(std::move(photos));
  }
  if (left > 0) throw base::InputError(file, "has " + std::to_string(left) + " observations that belong to no point", kPrepareAgain);
  return tracks;
}

void RequireCount(const char* what, uint64_t found, size_t expected, const std::filesystem::path& file) {
  if (found == expected) return;
  throw base::InputError(file, "has " + std::to_string(found) + " " + what + ", but survey.json says " + std::to_string(expected),
                         "The two files are from different runs: run 'skyquilt prepare' again");
}

}  // namespace

void PointTracks::Add(std::vector<int32_t> photos) {
  std::sort(photos.begin(), photos.end());
  photos_.insert(photos_.end(), photos.begin(), std::unique(photos.begin(), photos.end()));
  begin_.push_back(photos_.size());
}

std::span<const int32_t> PointTracks::PhotosOf(size_t point) const {
  if (Empty()) return {};
  return std::span(photos_).subspan(begin_[point], begin_[point + 1] - begin_[point]);
}

PointTracks PointTracks::Renumbered(std::span<const int32_t> new_index) const {
  PointTracks renumbered;
  for (size_t i = 0; i < points(); ++i) {
    std::vector<int32_t> photos;
    for (const int32_t photo : PhotosOf(i)) {
      if (const int32_t now = new_index[static_cast<size_t>(photo)]; now >= 0) photos.push_back(now);
    }
    renumbered.Add(std::move(photos));
  }
  return renumbered;
}

void WriteTracks(const PointTracks& points, const PointTracks& kept_points, size_t n_photos, const std::filesystem::path& file) {
  TracksHeader header{.photos = static_cast<uint32_t>(n_photos),
                      .points = points.points(),
                      .kept_points = kept_points.points(),
                      .observations = points.observations(),
                      .kept_observations = kept_points.observations()};
  std::copy(kTracksMagic.begin(), kTracksMagic.end(), header.magic.begin());
  std::string content(reinterpret_cast<const char*>(&header), sizeof(header));
  content.reserve(sizeof(header) + 4 * (points.points() + points.observations() + kept_points.points() + kept_points.observations()));
  AppendTracks(points, content);
  AppendTracks(kept_points, content);
  base::WriteFileAtomically(file, content);
}

SurveyTracks ReadTracks(const std::filesystem::path& file, const TrackCounts& expected) {
  if (!std::filesystem::exists(file)) throw base::InputError(file, "no such file, but survey.json needs it", kPrepareAgain);
  const base::MemoryMap map(file);
  const std::span<const uint8_t> bytes = map.bytes();
  TracksHeader header;
  if (bytes.size() < sizeof(header)) throw base::InputError(file, "ends inside its header", kPrepareAgain);
  std::memcpy(&header, bytes.data(), sizeof(header));
  if (std::string_view(header.magic.data(), header.magic.size()) != kTracksMagic) {
    throw base::InputError(file, "is not a file of tracks written by prepare", kPrepareAgain);
  }
  if (header.version != kTracksVersion) throw base::InputError(file, "was written by another version of skyquilt", kPrepareAgain);
  RequireCount("photos", header.photos, expected.photos, file);
  RequireCount("points", header.points, expected.points, file);
  RequireCount("kept points", header.kept_points, expected.kept_points, file);
  // The sum of two damaged counts may overflow, but is then refused by the size, unless both are as in survey.json.
  RequireCount("observations", header.observations + header.kept_observations, expected.observations, file);
  const size_t n_numbers = (bytes.size() - sizeof(header)) / 4;
  const bool fits = header.observations <= n_numbers && header.kept_observations <= n_numbers && header.points <= n_numbers &&
                    header.kept_points <= n_numbers && (bytes.size() - sizeof(header)) % 4 == 0;
  if (!fits || header.points + header.kept_points + header.observations + header.kept_observations != n_numbers) {
    throw base::InputError(file, "has " + std::to_string(bytes.size()) + " bytes, which are not those of its counts", kPrepareAgain);
  }
  const char* first = reinterpret_cast<const char*>(bytes.data()) + sizeof(header);
  const char* second = first + 4 * (header.points + header.observations);
  return {ParseTracks(first, header.points, header.observations, header.photos, file),
          ParseTracks(second, header.kept_points, header.kept_observations, header.photos, file)};
}

}  // namespace skyquilt::survey
