// A program that stands for COLMAP's feature_extractor: each photo has features that depend on its name alone, and ids run backwards.
#pragma once

#include <filesystem>
#include <string>

#include "core/base/file.h"

namespace skyquilt::test {

// Needs a database without images, `folder`/made.db. Writes the names it was asked for into `folder`/calls, a line for each call, and fails when
// there is a file `folder`/fail with one of them. With a file `folder`/slow it works for a minute.
// Not env python3: version managers put a shell script of half a second there.
constexpr const char* kFakeExtractor = R"py(#!/usr/bin/python3
import os, random, shutil, sqlite3, sys, time
folder = os.path.dirname(os.path.abspath(__file__))
options = dict(zip(sys.argv[2::2], sys.argv[3::2]))
names = open(options["--image_list_path"]).read().split("\n")[:-1]
with open(folder + "/calls", "a") as calls:
    calls.write(" ".join(names) + "\n")
if os.path.exists(folder + "/slow"):
    for i in range(1000):
        print("Processed file [%d/2000]" % i, flush=True)
        time.sleep(0.05)
if os.path.exists(folder + "/fail") and open(folder + "/fail").read() in names:
    sys.exit("cannot read " + open(folder + "/fail").read())
shutil.copy(folder + "/made.db", options["--database_path"])
database = sqlite3.connect(options["--database_path"])
database.execute("INSERT INTO cameras VALUES(1, 1, 64, 48, ?, 0)", (bytes(32),))
common = random.Random(0)
base = [[common.choice((0, 0, 0, 20, 40, 120)) for _ in range(128)] for _ in range(20)]
for i, name in enumerate(reversed(names)):
    noise = random.Random(name)
    rows = b"".join(bytes(v + noise.randrange(3) for v in row) for row in base)
    database.execute("INSERT INTO images(image_id, name, camera_id) VALUES(?, ?, 1)", (i + 1, name))
    database.execute("INSERT INTO keypoints VALUES(?, 20, 2, ?)", (i + 1, bytes(160)))
    database.execute("INSERT INTO descriptors VALUES(?, 20, 128, ?)", (i + 1, rows))
    print("Processed file [%d/%d]" % (i + 1, len(names)), flush=True)
database.commit()
)py";

inline std::filesystem::path WriteFakeExtractor(const std::filesystem::path& folder) {
  const std::filesystem::path program = folder / "colmap";
  base::WriteFileAtomically(program, kFakeExtractor);
  std::filesystem::permissions(program, std::filesystem::perms::owner_all);
  return program;
}

}  // namespace skyquilt::test
