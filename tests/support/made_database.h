// A database as COLMAP 3.8 makes it (database_creator), filled by SQL.
#pragma once

#include <gtest/gtest.h>
#include <sqlite3.h>

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace skyquilt::test {

class MadeDatabase {
 public:
  explicit MadeDatabase(const std::filesystem::path& file) {
    EXPECT_EQ(sqlite3_open(file.c_str(), &handle_), SQLITE_OK);
    Run("PRAGMA journal_mode = WAL; PRAGMA user_version = 3800;"
        "CREATE TABLE IF NOT EXISTS cameras(camera_id INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL, model INTEGER NOT NULL, width INTEGER NOT NULL,"
        " height INTEGER NOT NULL, params BLOB, prior_focal_length INTEGER NOT NULL);"
        "CREATE TABLE IF NOT EXISTS images(image_id INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL, name TEXT NOT NULL UNIQUE, camera_id INTEGER NOT "
        "NULL,"
        " prior_qw REAL, prior_qx REAL, prior_qy REAL, prior_qz REAL, prior_tx REAL, prior_ty REAL, prior_tz REAL,"
        " CONSTRAINT image_id_check CHECK(image_id >= 0 and image_id < 2147483647), FOREIGN KEY(camera_id) REFERENCES cameras(camera_id));"
        "CREATE UNIQUE INDEX IF NOT EXISTS index_name ON images(name);"
        "CREATE TABLE IF NOT EXISTS keypoints(image_id INTEGER PRIMARY KEY NOT NULL, rows INTEGER NOT NULL, cols INTEGER NOT NULL, data BLOB,"
        " FOREIGN KEY(image_id) REFERENCES images(image_id) ON DELETE CASCADE);"
        "CREATE TABLE IF NOT EXISTS descriptors(image_id INTEGER PRIMARY KEY NOT NULL, rows INTEGER NOT NULL, cols INTEGER NOT NULL, data BLOB,"
        " FOREIGN KEY(image_id) REFERENCES images(image_id) ON DELETE CASCADE);"
        "CREATE TABLE IF NOT EXISTS matches(pair_id INTEGER PRIMARY KEY NOT NULL, rows INTEGER NOT NULL, cols INTEGER NOT NULL, data BLOB);"
        "CREATE TABLE IF NOT EXISTS two_view_geometries(pair_id INTEGER PRIMARY KEY NOT NULL, rows INTEGER NOT NULL, cols INTEGER NOT NULL, data "
        "BLOB,"
        " config INTEGER NOT NULL, F BLOB, E BLOB, H BLOB, qvec BLOB, tvec BLOB);");
  }
  ~MadeDatabase() { sqlite3_close(handle_); }
  MadeDatabase(const MadeDatabase&) = delete;
  MadeDatabase& operator=(const MadeDatabase&) = delete;

  void Run(const std::string& sql) { EXPECT_EQ(sqlite3_exec(handle_, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK) << sqlite3_errmsg(handle_); }

  void AddImage(uint32_t id, const std::string& name, uint32_t camera = 1) {
    Run("INSERT INTO images(image_id, name, camera_id) VALUES(" + std::to_string(id) + ", '" + name + "', " + std::to_string(camera) + ")");
  }
  // A row of keypoints, descriptors, matches or two_view_geometries, whatever its numbers say.
  template <typename T>
  void AddMatrix(const std::string& table, uint64_t key, int64_t rows, int64_t cols, std::span<const T> values) {
    const bool verified = table == "two_view_geometries";
    const std::string sql = "INSERT OR REPLACE INTO " + table + " VALUES(?, ?, ?, ?" + (verified ? ", 2, NULL, NULL, NULL, NULL, NULL)" : ")");
    sqlite3_stmt* statement = nullptr;
    ASSERT_EQ(sqlite3_prepare_v2(handle_, sql.c_str(), -1, &statement, nullptr), SQLITE_OK) << sqlite3_errmsg(handle_);
    sqlite3_bind_int64(statement, 1, static_cast<int64_t>(key));
    sqlite3_bind_int64(statement, 2, rows);
    sqlite3_bind_int64(statement, 3, cols);
    sqlite3_bind_blob(statement, 4, values.data(), static_cast<int>(values.size_bytes()), nullptr);
    EXPECT_EQ(sqlite3_step(statement), SQLITE_DONE) << sqlite3_errmsg(handle_);
    sqlite3_finalize(statement);
  }
  void AddDescriptors(uint32_t image, std::span<const uint8_t> rows) {
    AddMatrix<uint8_t>("descriptors", image, static_cast<int64_t>(rows.size() / 128), 128, rows);
  }

 private:
  sqlite3* handle_ = nullptr;
};

}  // namespace skyquilt::test
