// A connection to a SQLite database and its statements, for the .cpp files of colmap_database.h.
#pragma once

#include <sqlite3.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/base/errors.h"
#include "core/survey/colmap_database.h"

namespace skyquilt::survey {

inline const char* FixOfDatabase(int code) {
  switch (code & 0xFF) {
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return "End the other program that uses it, then run the same command again";
    case SQLITE_FULL:
      return "Make room on the disk, then run the same command again";
    case SQLITE_READONLY:
    case SQLITE_PERM:
    case SQLITE_CANTOPEN:
    case SQLITE_IOERR:
      return "Check permissions of the file and of its folder, and the disk";
    default:
      return "Remove the file, then run the same command again: it is made from the photos";
  }
}

struct DatabaseConnection {
  std::filesystem::path file;
  sqlite3* handle = nullptr;

  explicit DatabaseConnection(const std::filesystem::path& path) : file(path) {}
  ~DatabaseConnection() { sqlite3_close(handle); }
  DatabaseConnection(const DatabaseConnection&) = delete;
  DatabaseConnection& operator=(const DatabaseConnection&) = delete;

  [[noreturn]] void Fail(const std::string& found, int code = SQLITE_CORRUPT) const { throw base::InputError(file, found, FixOfDatabase(code)); }
  void Require(int code, const std::string& action) const {
    if (code != SQLITE_OK) Fail("cannot " + action + " the COLMAP database (" + sqlite3_errmsg(handle) + ")", code);
  }
  void Execute(const char* sql, const std::string& action) const { Require(sqlite3_exec(handle, sql, nullptr, nullptr, nullptr), action); }
};

// One SQL statement with its parameters; rows are read one after another.
class DatabaseStatement {
 public:
  DatabaseStatement(const DatabaseConnection& connection, const char* sql, const char* action) : connection_(connection), action_(action) {
    connection_.Require(sqlite3_prepare_v2(connection_.handle, sql, -1, &statement_, nullptr), action_);
  }
  ~DatabaseStatement() { sqlite3_finalize(statement_); }
  DatabaseStatement(const DatabaseStatement&) = delete;
  DatabaseStatement& operator=(const DatabaseStatement&) = delete;

  DatabaseStatement& Bind(int index, int64_t value) {
    connection_.Require(sqlite3_bind_int64(statement_, index, value), action_);
    return *this;
  }
  // Not copied (null destructor, SQLITE_STATIC): the bytes must stay until the statement has run.
  DatabaseStatement& BindBlob(int index, const void* bytes, size_t size) {
    connection_.Require(sqlite3_bind_blob64(statement_, index, bytes, size, nullptr), action_);
    return *this;
  }
  // Not copied either.
  DatabaseStatement& BindText(int index, const std::string& text) {
    connection_.Require(sqlite3_bind_text(statement_, index, text.c_str(), -1, nullptr), action_);
    return *this;
  }
  // To run it once more with other parameters.
  void Reset() { sqlite3_reset(statement_); }
  // False after the last row.
  bool Next() {
    const int code = sqlite3_step(statement_);
    if (code != SQLITE_ROW && code != SQLITE_DONE) connection_.Require(code, action_);
    return code == SQLITE_ROW;
  }

  int64_t Int(int column) const { return sqlite3_column_int64(statement_, column); }
  uint32_t Id(int column, const char* what) const {
    const int64_t value = Int(column);
    if (value < 0 || static_cast<uint64_t>(value) >= kMaxDatabaseId) {
      connection_.Fail(std::string("has the impossible ") + what + " " + std::to_string(value));
    }
    return static_cast<uint32_t>(value);
  }
  std::string Text(int column) const {
    const unsigned char* text = sqlite3_column_text(statement_, column);
    return text == nullptr ? "" : reinterpret_cast<const char*>(text);
  }
  std::span<const uint8_t> Blob(int column) const {
    const void* bytes = sqlite3_column_blob(statement_, column);
    const auto size = static_cast<size_t>(sqlite3_column_bytes(statement_, column));
    return {static_cast<const uint8_t*>(bytes), bytes == nullptr ? 0 : size};
  }
  // A matrix in columns rows, cols, data. Any number of columns is right for one without rows.
  template <typename T>
  std::vector<T> Matrix(int first_column, const std::string& what, size_t* cols) const {
    const int64_t rows = Int(first_column), n_cols = Int(first_column + 1);
    const std::span<const uint8_t> bytes = Blob(first_column + 2);
    const auto fits = [&] {
      if (rows < 0 || n_cols < 0) return false;
      if (rows == 0 || n_cols == 0) return bytes.empty();
      const uint64_t n_values = bytes.size() / sizeof(T);
      return bytes.size() % sizeof(T) == 0 && n_values % static_cast<uint64_t>(n_cols) == 0 &&
             n_values / static_cast<uint64_t>(n_cols) == static_cast<uint64_t>(rows);
    };
    if (!fits()) {
      connection_.Fail("has " + what + " of " + std::to_string(rows) + " x " + std::to_string(n_cols) + " in " + std::to_string(bytes.size()) +
                       " bytes");
    }
    *cols = rows == 0 ? 0 : static_cast<size_t>(n_cols);
    std::vector<T> values(bytes.size() / sizeof(T));
    if (!values.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
    return values;
  }
  std::vector<FeaturePair> Matches(int first_column, const std::string& what) const {
    size_t cols = 0;
    const std::vector<uint32_t> values = Matrix<uint32_t>(first_column, what, &cols);
    if (!values.empty() && cols != 2) connection_.Fail("has " + what + " with " + std::to_string(cols) + " columns");
    std::vector<FeaturePair> pairs(values.size() / 2);
    for (size_t i = 0; i < pairs.size(); ++i) pairs[i] = {values[2 * i], values[2 * i + 1]};
    return pairs;
  }
  ImagePair Pair(int column) const {
    const int64_t id = Int(column);
    const bool in_range = id >= 0 && static_cast<uint64_t>(id) < kMaxDatabaseId * kMaxDatabaseId;
    const ImagePair pair = in_range ? ImagesOfPair(static_cast<uint64_t>(id)) : ImagePair{0, 0};
    if (pair.first >= pair.second) connection_.Fail("has the impossible number of a pair " + std::to_string(id));
    return pair;
  }

 private:
  const DatabaseConnection& connection_;
  const char* action_;
  sqlite3_stmt* statement_ = nullptr;
};

}  // namespace skyquilt::survey
