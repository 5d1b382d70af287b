// Reads and writes the database in which COLMAP 3.8 keeps features and matches (SQLite, version 3800): tables cameras, images, keypoints,
// descriptors, matches and two_view_geometries. Numbers in its blobs are little-endian and stored row by row.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/camera/camera.h"

namespace skyquilt::survey {

struct DatabaseImage {
  uint32_t id = 0;  // from 1, at most kMaxDatabaseId - 1
  uint32_t camera_id = 0;
  std::string name;  // relative to the folder of the photos
};

// A feature: place in pixels (core/camera/camera.h), radius in pixels (of COLMAP's affine shape in the form of a similarity).
struct DatabaseKeypoint {
  float x = 0.0F, y = 0.0F;
  float scale = 1.0F;  // 1 where the database has places only
};

constexpr size_t kDatabaseDescriptorBytes = 128;

// Feature `first` of the image with the smaller id and `second` of the other one, in the order of their descriptors.
using FeaturePair = std::array<uint32_t, 2>;

// An unordered pair of images; first < second.
using ImagePair = std::pair<uint32_t, uint32_t>;

struct DatabaseMatches {
  ImagePair images;
  std::vector<FeaturePair> features;
};

// COLMAP's key of a pair: the smaller id times kMaxDatabaseId plus the larger one. The ids differ and are below kMaxDatabaseId.
constexpr uint64_t kMaxDatabaseId = 2147483647;
uint64_t PairId(uint32_t image_a, uint32_t image_b);
ImagePair ImagesOfPair(uint64_t pair_id);

struct DatabaseConnection;  // database_connection.h

// One connection, for one thread at a time. All functions throw base::InputError that names the file: it is not a database or damaged, a table is
// missing, a blob has a size that does not fit its numbers of rows and columns, the disk is full, another program has locked it.
class ColmapDatabase {
 public:
  // Opens an existing database for reading and writing; changes that a killed COLMAP left unfinished are undone, and so are plain names.
  explicit ColmapDatabase(const std::filesystem::path& file);
  ~ColmapDatabase();
  ColmapDatabase(ColmapDatabase&&) noexcept;
  ColmapDatabase& operator=(ColmapDatabase&&) noexcept;

  std::vector<DatabaseImage> ReadImages() const;  // in the order of their ids
  size_t CountPlaced() const;                     // images with a position from their EXIF tags
  std::map<uint32_t, camera::Camera> ReadCameras() const;
  // Gives a camera that ReadCameras has another focal length (both are equal then). `known`: COLMAP shall take it as stated by tags, not as a guess.
  void SetFocal(uint32_t camera_id, double focal_px, bool known);
  // Empty for an image without features and for an unknown id.
  std::vector<DatabaseKeypoint> ReadKeypoints(uint32_t image_id) const;
  std::vector<uint8_t> ReadDescriptors(uint32_t image_id) const;  // rows of kDatabaseDescriptorBytes
  size_t CountDescriptors(uint32_t image_id) const;

  // The images stay, and their matches: for features that are found anew before anything is matched. Everything or nothing.
  void RemoveFeatures(std::span<const uint32_t> image_ids);

  // Empty when there are none; `features` are in the order of the smaller id first, whatever the order of the arguments.
  std::vector<FeaturePair> ReadMatches(uint32_t image_a, uint32_t image_b) const;
  // Pairs of images with a row of matches that has at least `min_rows` rows.
  std::vector<ImagePair> ReadMatchedPairs(size_t min_rows) const;
  // The matches that agree with one geometry of the two views, for every pair that COLMAP has verified; those without one have none.
  std::vector<DatabaseMatches> ReadTwoViewMatches() const;
  // Pairs that COLMAP has verified and found at least `min_rows` matches of one geometry in.
  size_t CountTwoViewGeometries(size_t min_rows) const;

  // COLMAP's lists of pairs cannot hold names with spaces. UsePlainNames gives every image the name PlainName(id), until RestoreNames or the next
  // opening of the file by this class. No photo can have such a name, as it ends in a slash.
  void UsePlainNames();
  void RestoreNames();
  static std::string PlainName(uint32_t image_id) { return "image_" + std::to_string(image_id) + "/"; }

  // Puts everything into the file itself, with nothing in files beside it (COLMAP's write-ahead log), so that it can be moved, and read on other
  // hosts.
  void UseOneFile();

  // Replaces all matches of the database by those that `next` gives, one after another until it returns false; geometries are removed, so that
  // COLMAP's matches_importer makes them anew. In one transaction: everything or nothing is written, also when `next` throws.
  template <typename Next>
  void ReplaceMatches(const Next& next) {
    Transaction transaction(*this);
    ClearMatches();
    DatabaseMatches matches;
    while (next(matches)) WriteMatches(matches);
    transaction.Commit();
  }

 private:
  // Undoes all changes unless they are committed.
  class Transaction {
   public:
    explicit Transaction(ColmapDatabase& database);
    ~Transaction();
    Transaction(const Transaction&) = delete;
    Transaction& operator=(const Transaction&) = delete;
    void Commit();

   private:
    ColmapDatabase& database_;
    bool open_ = true;
  };

  void ClearMatches();
  void WriteMatches(const DatabaseMatches& matches);

  std::unique_ptr<DatabaseConnection> connection_;
};

}  // namespace skyquilt::survey
