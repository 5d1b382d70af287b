"""`prepare` on 1 and 3 ranks fills the database with the same features and matches. A rank that is killed, or a COLMAP that fails on one, ends the
command, and the next one uses what was finished. On eight real photos (Brighton Beach); skipped where they or COLMAP are missing."""
import os
import pathlib
import shutil
import signal
import sqlite3
import sys
import time

from harness import children, expect, main, wait_for

SKIPPED = 77
ROOT = pathlib.Path(__file__).resolve().parents[2]
DATA = pathlib.Path(os.environ.get("SKYQUILT_DATA", ROOT.parent / "shared" / "data")) / "brighton_beach"
OPTIONS = ["--threads", "2", "--set", "prepare.poses=fast", "--set", "prepare.max_image_size=900"]
# COLMAP, but with a file `hold` or `fail`, finding the features of the photo named in it waits for that file to go, or fails. The mapper is left
# out: its model of all photos is there already, and it runs on rank 0 as ever.
WRAPPER = """#!/bin/sh
here=$(dirname "$0")
list=
output=
again=
previous=
for word in "$@"; do
  [ "$previous" = --output_path ] && output=$word
  [ "$previous" = --image_list_path ] && list=$word
  [ "$previous" = --ImageReader.existing_camera_id ] && again=yes
  previous=$word
done
if [ "$1" = feature_extractor ] && [ -z "$again" ]; then
  echo "$(wc -l < "$list")" >> "$here/calls"
  if [ -e "$here/fail" ] && grep -q "$(cat "$here/fail")" "$list"; then echo "no memory left"; exit 1; fi
  if [ -e "$here/hold" ] && grep -q "$(cat "$here/hold")" "$list"; then while [ -e "$here/hold" ]; do sleep 0.1; done; fi
fi
if [ "$1" = mapper ]; then cp -r "$here/model" "$output/0"; exit 0; fi
exec colmap "$@"
"""


def content(project):
    """Everything of the database that is not drawn at random: COLMAP's verification is, when it has several threads."""
    database = sqlite3.connect(project / "survey" / "colmap" / "database.db")
    return {table: database.execute(f"SELECT * FROM {table} ORDER BY 1").fetchall()
            for table in ("cameras", "images", "keypoints", "descriptors", "matches")}


def expect_same(found, wanted, what):
    for table, rows in wanted.items():
        expect(len(found[table]) == len(rows), f"{what}: {len(found[table])} {table} instead of {len(rows)}")
        expect(found[table] == rows, f"{what}: other {table}")


def test(skyquilt, folder):
    photos = folder / "photos"
    photos.mkdir()
    names = sorted(path.name for path in (DATA / "images").glob("*.JPG"))[:8]
    for name in names:
        shutil.copy2(DATA / "images" / name, photos / name)
    shutil.copytree(DATA / "sparse" / "0", folder / "model")
    wrapper = folder / "colmap"
    wrapper.write_text(WRAPPER)
    wrapper.chmod(0o755)
    hold, fail, calls = folder / "hold", folder / "fail", folder / "calls"
    options = OPTIONS + ["--set", f"prepare.colmap={wrapper}"]

    def extracted():
        found = [int(line) for line in calls.read_text().split()] if calls.exists() else []
        calls.unlink(missing_ok=True)
        return found

    start = time.monotonic()
    alone = folder / "alone"
    skyquilt.call("prepare", photos, "-o", alone, *options)
    wanted = content(alone)
    print(f"alone: {time.monotonic() - start:.1f} s, {len(wanted['images'])} photos, {len(wanted['matches'])} pairs")
    expect([row[1] for row in wanted["images"]] == names, f"the photos have the names {[row[1] for row in wanted['images']]}")
    expect(len(wanted["matches"]) == 28 and sum(row[1] for row in wanted["matches"]) > 1000, "hardly any matches")
    expect(extracted() == [8], "one process found the features in several parts")

    # Killed while one of two parts of the features is finished.
    project = folder / "ranks"
    hold.write_text(names[-1])
    running = skyquilt.start("prepare", photos, "-o", project, *options, ranks=3)
    parts = project / "survey" / "colmap" / "features"
    wait_for(lambda: list(parts.glob("part_????????????????.db")), "finished part", running)
    expect(not (project / "survey" / "colmap" / "database.db").exists(), "the database was made although a part is missing")
    workers = [pid for pid in children(running.pid) if pid != 0]
    os.kill(workers[-1], signal.SIGKILL)
    text = running.communicate(timeout=60)[0]
    expect(running.returncode != 0 and "signal 9" in text, f"a killed rank ended the command with {running.returncode}:\n{text}")
    expect(extracted() == [4, 4], "the features were not found in two parts")
    hold.unlink()

    # The missing part fails.
    fail.write_text(names[-1])
    text = skyquilt.call("prepare", photos, "-o", project, *options, ranks=3, status=3)
    expect("features of 4 of 8 photos are already found" in text, f"the finished part was not used:\n{text}")
    for word in ("colmap_rank_", "rank ", "no memory left"):
        expect(word in text, f"'{word}' is not in the message of a failing COLMAP:\n{text}")
    expect(extracted() == [4], "the finished part was made again")
    fail.unlink()

    text = skyquilt.call("prepare", photos, "-o", project, *options, ranks=3)
    expect(extracted() == [4], f"the finished part was made again:\n{text}")
    expect_same(content(project), wanted, "3 ranks")
    for left in ("features", "matches"):
        expect(not (project / "survey" / "colmap" / left).exists(), f"{left} were not removed")
    text = skyquilt.call("prepare", photos, "-o", project, *options, ranks=3)
    expect("nothing to do" in text and not extracted(), f"the finished survey was made again:\n{text}")


if not DATA.exists() or shutil.which("colmap") is None:
    print(f"skipped: no photos in {DATA}" if not DATA.exists() else "skipped: no COLMAP")
    sys.exit(SKIPPED)
main(test)
