// A program in place of COLMAP, and a folder of photos to run it on.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/file.h"
#include "prepare/poses/colmap_run.h"
#include "tests/prepare/poses/made_photos.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::test {

// Tests whose COLMAP is a script.
class FakeColmap : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(folder_ / "images");
    photos_ = GridPhotos(4, 5, 20.0, 25.0, {47.0, 8.0, 400.0});
    for (const prepare::input::PhotoFile& photo : photos_) base::WriteFileAtomically(folder_ / ("images/" + photo.name), "pixels");
    options_.colmap = (folder_ / "colmap").string();
  }
  void WriteProgram(const std::string& text) {
    base::WriteFileAtomically(options_.colmap, text);
    std::filesystem::permissions(options_.colmap, std::filesystem::perms::owner_all);
  }
  std::string Find() { return prepare::poses::RunColmap(job_, photos_, options_, threads_).string(); }
  std::string FirstModel() const { return (job_.folder / "sparse" / "0").string(); }
  std::string SecondModel() const { return (job_.folder / "more_pairs" / "sparse" / "0").string(); }
  // For the program below.
  void SetNumber(const std::string& name, size_t number) { base::WriteFileAtomically(folder_ / name, std::to_string(number)); }
  // And forgets them.
  std::string Calls() {
    const std::filesystem::path file = folder_ / "calls";
    const std::string calls = std::filesystem::exists(file) ? base::ReadFile(file) : "";
    std::filesystem::remove(file);
    return calls;
  }

  TemporaryFolder folder_;
  std::vector<prepare::input::PhotoFile> photos_;
  prepare::poses::PoseOptions options_;
  prepare::poses::ColmapJob job_{folder_ / "images", {}, folder_ / "work"};
  base::ThreadPool threads_{1};
};

// It takes a made database for features, verifies all matches of the listed pairs, and makes models of so many photos, with the focal length "focal"
// (60 px without) unless it must keep that of the tags, 60 px. With a folder "models" its mapper finds those.
// Not env python3: version managers put a shell script of half a second there.
inline constexpr const char* kFastProgram = R"py(#!/usr/bin/python3
import os, shutil, sqlite3, struct, sys
folder = os.path.dirname(os.path.abspath(__file__))
call = sys.argv[1]
options = dict(zip(sys.argv[2::2], sys.argv[3::2]))
again = "more_pairs" in options["--database_path"]
with open(folder + "/calls", "a") as calls:
    calls.write(call + (" again" if again else "") + "\n")
with open(folder + "/arguments", "a") as arguments:
    arguments.write(" ".join(sys.argv) + "\n")
setting = lambda name: int(open(folder + "/" + name).read()) if os.path.exists(folder + "/" + name) else 0
if call == "feature_extractor":
    shutil.copy(folder + "/made.db", options["--database_path"])
    if "--ImageReader.existing_camera_id" in options:
        shutil.copy(options["--image_list_path"], folder + "/searched_again")
    sys.exit(0)
database = sqlite3.connect(options["--database_path"])
ids = dict(database.execute("SELECT name, image_id FROM images"))
if call == "matches_importer":
    if setting("fail_verifying"):
        sys.exit("killed")
    for line in open(options["--match_list_path"]):
        a, b = sorted(ids[name] for name in line.split())
        key = a * 2147483647 + b
        rows, data = database.execute("SELECT rows, data FROM matches WHERE pair_id = ?", (key,)).fetchone()
        database.execute("INSERT INTO two_view_geometries VALUES(?, ?, 2, ?, 2, NULL, NULL, NULL, NULL, NULL)", (key, rows, data))
    database.commit()
elif call == "mapper":
    if setting("kill_mapper"):
        os.kill(os.getpid(), 9)
    if os.path.exists(folder + "/models"):
        shutil.copytree(folder + "/models", options["--output_path"], dirs_exist_ok=True)
        sys.exit(0)
    held = options.get("--Mapper.ba_refine_focal_length") == "0"
    n = setting("held" if held else "again" if again else "first")
    focal = 60.0 if held else setting("focal") or 60.0
    if n == 0:
        sys.exit("no good initial pair")
    model = options["--output_path"] + "/0"
    os.makedirs(model)
    names = sorted(ids)[:n]
    camera = struct.pack("<QIiQQ4d", 1, 1, 1, 64, 48, focal, focal, 32.0, 24.0)
    images = struct.pack("<Q", n)
    for name in names:
        images += struct.pack("<I7dI", ids[name], 1, 0, 0, 0, 0, 0, 0, 1) + name.encode() + b"\0" + struct.pack("<Q", 0)
    for file, data in (("cameras", camera), ("images", images), ("points3D", struct.pack("<Q", 0))):
        open(model + "/" + file + ".bin", "wb").write(data)
)py";

}  // namespace skyquilt::test
