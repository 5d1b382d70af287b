#include "core/survey/colmap_database.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>

#include "core/base/errors.h"
#include "core/survey/database_connection.h"

namespace skyquilt::survey {
namespace {

constexpr int kBusyTimeout_ms = 10000;

using Statement = DatabaseStatement;

std::string OfImage(const char* what, uint32_t image_id) {
  return std::string(what) + " of image " + std::to_string(image_id);
}

std::string OfPair(const char* what, const ImagePair& images) {
  return std::string(what) + " of images " + std::to_string(images.first) + " and " + std::to_string(images.second);
}

}  // namespace

uint64_t PairId(uint32_t image_a, uint32_t image_b) {
  SKYQUILT_CHECK(image_a != image_b && image_a < kMaxDatabaseId && image_b < kMaxDatabaseId, "not a pair of images");
  const auto [small, large] = std::minmax(image_a, image_b);
  return kMaxDatabaseId * small + large;
}

ImagePair ImagesOfPair(uint64_t pair_id) {
  return {static_cast<uint32_t>(pair_id / kMaxDatabaseId), static_cast<uint32_t>(pair_id % kMaxDatabaseId)};
}

ColmapDatabase::ColmapDatabase(const std::filesystem::path& file) : connection_(std::make_unique<DatabaseConnection>(file)) {
  if (!std::filesystem::exists(file)) throw base::InputError(file, "no such file", "It is made by COLMAP's feature_extractor");
  // Threads have a connection each or take turns, so SQLite need not lock.
  connection_->Require(sqlite3_open_v2(file.c_str(), &connection_->handle, SQLITE_OPEN_READWRITE | SQLITE_OPEN_NOMUTEX, nullptr), "open");
  sqlite3_busy_timeout(connection_->handle, kBusyTimeout_ms);
  // Reads the head of the file, so that a foreign file is refused here.
  connection_->Execute("SELECT COUNT(*) FROM sqlite_master", "open");
  RestoreNames();
}

ColmapDatabase::~ColmapDatabase() = default;
ColmapDatabase::ColmapDatabase(ColmapDatabase&&) noexcept = default;
ColmapDatabase& ColmapDatabase::operator=(ColmapDatabase&&) noexcept = default;

std::vector<DatabaseImage> ColmapDatabase::ReadImages() const {
  Statement statement(*connection_, "SELECT image_id, name, camera_id FROM images ORDER BY image_id", "read the images of");
  std::vector<DatabaseImage> images;
  while (statement.Next()) {
    images.push_back({.id = statement.Id(0, "image id"), .camera_id = statement.Id(2, "camera id"), .name = statement.Text(1)});
  }
  return images;
}

size_t ColmapDatabase::CountPlaced() const {
  // Latitude and longitude of GPS tags; COLMAP stores nothing, or zeros, where there are none.
  Statement statement(*connection_, "SELECT COUNT(*) FROM images WHERE prior_tx != 0 OR prior_ty != 0", "read the images of");
  return statement.Next() ? static_cast<size_t>(statement.Int(0)) : 0;
}

std::map<uint32_t, camera::Camera> ColmapDatabase::ReadCameras() const {
  Statement statement(*connection_, "SELECT camera_id, model, width, height, params FROM cameras ORDER BY camera_id", "read the cameras of");
  std::map<uint32_t, camera::Camera> cameras;
  while (statement.Next()) {
    const uint32_t id = statement.Id(0, "camera id");
    const std::string name = "camera " + std::to_string(id);
    const int64_t model_id = statement.Int(1), width = statement.Int(2), height = statement.Int(3);
    const auto model = model_id < 0 || model_id > 100 ? std::nullopt : camera::ModelFromId(static_cast<int>(model_id));
    if (!model) connection_->Fail("has " + name + " with COLMAP's camera model number " + std::to_string(model_id) + ", which is not supported");
    constexpr int64_t kMaxSidePx = 1 << 20;
    if (width <= 0 || height <= 0 || width > kMaxSidePx || height > kMaxSidePx) {
      connection_->Fail("has " + name + " of " + std::to_string(width) + " x " + std::to_string(height) + " pixels");
    }
    const std::span<const uint8_t> bytes = statement.Blob(4);
    camera::Camera camera{*model, static_cast<int>(width), static_cast<int>(height), {}};
    camera.params.resize(static_cast<size_t>(camera::ModelParamCount(*model)));
    if (bytes.size() != camera.params.size() * sizeof(double))
      connection_->Fail("has " + name + " with " + std::to_string(bytes.size()) + " bytes of parameters");
    std::memcpy(camera.params.data(), bytes.data(), bytes.size());
    cameras.emplace(id, std::move(camera));
  }
  return cameras;
}

void ColmapDatabase::SetFocal(uint32_t camera_id, double focal_px, bool known) {
  camera::Camera camera = ReadCameras().at(camera_id);
  camera.params[0] = focal_px;
  if (!camera::HasOneFocalLength(camera.model)) camera.params[1] = focal_px;
  Statement statement(*connection_, "UPDATE cameras SET params = ?, prior_focal_length = ? WHERE camera_id = ?", "write the cameras of");
  statement.BindBlob(1, camera.params.data(), camera.params.size() * sizeof(double)).Bind(2, known ? 1 : 0).Bind(3, camera_id);
  statement.Next();
}

std::vector<DatabaseKeypoint> ColmapDatabase::ReadKeypoints(uint32_t image_id) const {
  Statement statement(*connection_, "SELECT rows, cols, data FROM keypoints WHERE image_id = ?", "read the features of");
  std::vector<DatabaseKeypoint> keypoints;
  if (!statement.Bind(1, image_id).Next()) return keypoints;
  size_t cols = 0;
  const std::vector<float> values = statement.Matrix<float>(0, OfImage("keypoints", image_id), &cols);
  if (values.empty()) return keypoints;
  if (cols != 2 && cols != 4 && cols != 6) connection_->Fail("has " + OfImage("keypoints", image_id) + " with " + std::to_string(cols) + " columns");
  keypoints.resize(values.size() / cols);
  for (size_t i = 0; i < keypoints.size(); ++i) {
    const float* row = values.data() + i * cols;
    keypoints[i] = {.x = row[0], .y = row[1]};
    if (cols == 4) {
      keypoints[i].scale = row[2];
    } else if (cols == 6) {
      // Rows of the shape's matrix: a11 a12 a21 a22.
      keypoints[i].scale = 0.5F * (std::hypot(row[2], row[4]) + std::hypot(row[3], row[5]));
    }
    if (!std::isfinite(keypoints[i].x + keypoints[i].y + keypoints[i].scale)) {
      connection_->Fail("has " + OfImage("keypoints", image_id) + " that are not numbers");
    }
  }
  return keypoints;
}

std::vector<uint8_t> ColmapDatabase::ReadDescriptors(uint32_t image_id) const {
  Statement statement(*connection_, "SELECT rows, cols, data FROM descriptors WHERE image_id = ?", "read the descriptors of");
  if (!statement.Bind(1, image_id).Next()) return {};
  size_t cols = 0;
  std::vector<uint8_t> rows = statement.Matrix<uint8_t>(0, OfImage("descriptors", image_id), &cols);
  if (!rows.empty() && cols != kDatabaseDescriptorBytes) {
    connection_->Fail("has " + OfImage("descriptors", image_id) + " with " + std::to_string(cols) + " columns");
  }
  return rows;
}

size_t ColmapDatabase::CountDescriptors(uint32_t image_id) const {
  Statement statement(*connection_, "SELECT rows FROM descriptors WHERE image_id = ?", "read the descriptors of");
  if (!statement.Bind(1, image_id).Next()) return 0;
  const int64_t rows = statement.Int(0);
  if (rows < 0) connection_->Fail("has " + std::to_string(rows) + " " + OfImage("descriptors", image_id));
  return static_cast<size_t>(rows);
}

void ColmapDatabase::RemoveFeatures(std::span<const uint32_t> image_ids) {
  Transaction transaction(*this);
  for (const uint32_t id : image_ids) {
    for (const char* sql : {"DELETE FROM keypoints WHERE image_id = ?", "DELETE FROM descriptors WHERE image_id = ?"}) {
      Statement(*connection_, sql, "remove features from").Bind(1, id).Next();
    }
  }
  transaction.Commit();
}

std::vector<FeaturePair> ColmapDatabase::ReadMatches(uint32_t image_a, uint32_t image_b) const {
  Statement statement(*connection_, "SELECT rows, cols, data FROM matches WHERE pair_id = ?", "read the matches of");
  if (!statement.Bind(1, static_cast<int64_t>(PairId(image_a, image_b))).Next()) return {};
  return statement.Matches(0, OfPair("matches", ImagesOfPair(PairId(image_a, image_b))));
}

std::vector<ImagePair> ColmapDatabase::ReadMatchedPairs(size_t min_rows) const {
  Statement statement(*connection_, "SELECT pair_id FROM matches WHERE rows >= ? ORDER BY pair_id", "read the matches of");
  statement.Bind(1, static_cast<int64_t>(min_rows));
  std::vector<ImagePair> pairs;
  while (statement.Next()) pairs.push_back(statement.Pair(0));
  return pairs;
}

std::vector<DatabaseMatches> ColmapDatabase::ReadTwoViewMatches() const {
  Statement statement(*connection_, "SELECT pair_id, rows, cols, data FROM two_view_geometries ORDER BY pair_id", "read the verified matches of");
  std::vector<DatabaseMatches> all;
  while (statement.Next()) {
    const ImagePair images = statement.Pair(0);
    all.push_back({images, statement.Matches(1, OfPair("verified matches", images))});
  }
  return all;
}

size_t ColmapDatabase::CountTwoViewGeometries(size_t min_rows) const {
  Statement statement(*connection_, "SELECT COUNT(*) FROM two_view_geometries WHERE rows >= ?", "read the verified matches of");
  statement.Bind(1, static_cast<int64_t>(min_rows));
  return statement.Next() ? static_cast<size_t>(statement.Int(0)) : 0;
}

void ColmapDatabase::UsePlainNames() {
  RestoreNames();
  Transaction transaction(*this);
  connection_->Execute("CREATE TABLE skyquilt_names AS SELECT image_id, name FROM images; UPDATE images SET name = 'image_' || image_id || '/'",
                       "name the images of");
  transaction.Commit();
}

void ColmapDatabase::RestoreNames() {
  {
    Statement statement(*connection_, "SELECT 1 FROM sqlite_master WHERE name = 'skyquilt_names'", "name the images of");
    if (!statement.Next()) return;
  }
  Transaction transaction(*this);
  connection_->Execute(
      "UPDATE images SET name = (SELECT name FROM skyquilt_names AS kept WHERE kept.image_id = images.image_id); DROP TABLE skyquilt_names",
      "name the images of");
  transaction.Commit();
}

void ColmapDatabase::UseOneFile() {
  connection_->Execute("PRAGMA journal_mode = DELETE", "finish");
}

void ColmapDatabase::ClearMatches() {
  connection_->Execute("DELETE FROM two_view_geometries; DELETE FROM matches", "write the matches of");
}

void ColmapDatabase::WriteMatches(const DatabaseMatches& matches) {
  static_assert(sizeof(FeaturePair) == 2 * sizeof(uint32_t));
  SKYQUILT_CHECK(matches.images.first < matches.images.second, "the smaller image id comes first");
  Statement statement(*connection_, "INSERT OR REPLACE INTO matches(pair_id, rows, cols, data) VALUES(?, ?, 2, ?)", "write the matches of");
  statement.Bind(1, static_cast<int64_t>(PairId(matches.images.first, matches.images.second)))
      .Bind(2, static_cast<int64_t>(matches.features.size()))
      .BindBlob(3, matches.features.data(), matches.features.size() * sizeof(FeaturePair));
  statement.Next();
}

ColmapDatabase::Transaction::Transaction(ColmapDatabase& database) : database_(database) {
  database_.connection_->Execute("BEGIN IMMEDIATE", "write");
}

ColmapDatabase::Transaction::~Transaction() {
  // A failure to undo leaves a journal, which the next one who opens the file undoes.
  if (open_) sqlite3_exec(database_.connection_->handle, "ROLLBACK", nullptr, nullptr, nullptr);
}

void ColmapDatabase::Transaction::Commit() {
  database_.connection_->Execute("COMMIT", "write");
  open_ = false;
}

}  // namespace skyquilt::survey
