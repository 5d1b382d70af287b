#include "core/survey/colmap_merge.h"

#include <set>

#include "core/base/cancel.h"
#include "core/base/file.h"
#include "core/survey/database_connection.h"

namespace skyquilt::survey {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMerge = "join the parts of";

// Makes part visible as database "part" while it exists.
class Attached {
 public:
  Attached(const DatabaseConnection& connection, const fs::path& part) : connection_(connection) {
    // SQLite would make a new one.
    if (!fs::exists(part)) throw base::InputError(part, "no such file", "Run the same command again");
    DatabaseStatement(connection_, "ATTACH ? AS part", kMerge).BindText(1, part.string()).Next();
  }
  ~Attached() { sqlite3_exec(connection_.handle, "DETACH part", nullptr, nullptr, nullptr); }
  Attached(const Attached&) = delete;
  Attached& operator=(const Attached&) = delete;

 private:
  const DatabaseConnection& connection_;
};

// The tables of the attached part, empty.
void MakeTables(const DatabaseConnection& connection) {
  std::vector<std::string> statements;
  DatabaseStatement tables(connection, "SELECT sql FROM part.sqlite_master WHERE sql IS NOT NULL AND name NOT LIKE 'sqlite_%' ORDER BY rowid",
                           kMerge);
  while (tables.Next()) statements.push_back(tables.Text(0));
  for (const std::string& sql : statements) connection.Execute(sql.c_str(), kMerge);
  DatabaseStatement version(connection, "PRAGMA part.user_version", kMerge);
  version.Next();
  connection.Execute(("PRAGMA main.user_version = " + std::to_string(version.Int(0))).c_str(), kMerge);
}

void NameImages(const DatabaseConnection& connection, const DatabasePart& part, int64_t* next_id) {
  connection.Execute("DELETE FROM temp.wanted", kMerge);
  DatabaseStatement exists(connection, "SELECT 1 FROM part.images WHERE name = ?", kMerge);
  DatabaseStatement insert(connection, "INSERT INTO temp.wanted VALUES(?, ?)", kMerge);
  for (const std::string& name : part.names) {
    const bool there = exists.BindText(1, name).Next();
    exists.Reset();
    if (!there) continue;
    insert.Bind(1, (*next_id)++).BindText(2, name).Next();
    insert.Reset();
  }
}

void CopyPart(const DatabaseConnection& connection, const DatabasePart& part, bool new_camera) {
  if (new_camera) {
    DatabaseStatement(connection,
                      "INSERT INTO main.cameras(camera_id, model, width, height, params, prior_focal_length) "
                      "SELECT ?, model, width, height, params, prior_focal_length FROM part.cameras ORDER BY camera_id LIMIT 1",
                      kMerge)
        .Bind(1, part.camera_id)
        .Next();
  }
  DatabaseStatement(connection,
                    "INSERT INTO main.images(image_id, name, camera_id, prior_qw, prior_qx, prior_qy, prior_qz, prior_tx, prior_ty, prior_tz) "
                    "SELECT wanted.image_id, old.name, ?, prior_qw, prior_qx, prior_qy, prior_qz, prior_tx, prior_ty, prior_tz "
                    "FROM temp.wanted JOIN part.images AS old ON old.name = wanted.name ORDER BY wanted.image_id",
                    kMerge)
      .Bind(1, part.camera_id)
      .Next();
  for (const std::string table : {"keypoints", "descriptors"}) {
    const std::string sql = "INSERT INTO main." + table + "(image_id, rows, cols, data) SELECT wanted.image_id, rows, cols, data FROM temp.wanted " +
                            "JOIN part.images AS old ON old.name = wanted.name JOIN part." + table +
                            " AS features ON features.image_id = old.image_id ORDER BY wanted.image_id";
    connection.Execute(sql.c_str(), kMerge);
  }
}

}  // namespace

void RemoveDatabase(const fs::path& file) {
  for (const char* suffix : {"", "-journal", "-wal", "-shm"}) fs::remove(file.string() + suffix);
}

void MergeFeatures(std::span<const DatabasePart> parts, const fs::path& file) {
  SKYQUILT_CHECK(!parts.empty(), "no parts to join");
  const fs::path unfinished = file.string() + ".unfinished";
  RemoveDatabase(unfinished);
  {
    DatabaseConnection connection(unfinished);
    connection.Require(
        sqlite3_open_v2(unfinished.c_str(), &connection.handle, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_NOMUTEX, nullptr), kMerge);
    // A file that was not finished is never read.
    connection.Execute("PRAGMA main.synchronous = OFF; CREATE TEMP TABLE wanted(image_id INTEGER PRIMARY KEY, name TEXT NOT NULL UNIQUE)", kMerge);
    std::set<uint32_t> cameras;
    int64_t next_id = 1;
    for (const DatabasePart& part : parts) {
      base::ThrowIfCancelled();
      connection.file = part.file;  // for messages: it is the one that may be damaged
      const Attached attached(connection, part.file);
      if (&part == &parts.front()) MakeTables(connection);
      connection.Execute("BEGIN", kMerge);
      NameImages(connection, part, &next_id);
      CopyPart(connection, part, cameras.insert(part.camera_id).second);
      connection.Execute("COMMIT", kMerge);
    }
  }
  RemoveDatabase(file);
  base::Publish(unfinished, file);
}

}  // namespace skyquilt::survey
