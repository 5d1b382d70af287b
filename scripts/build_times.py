#!/usr/bin/env python3
"""What the build costs: builds from nothing, without compiler cache, and says which files take most time and memory.

  scripts/build_times.py [--jobs N] [--target skyquilt] [--folder DIR]

Prints CPU seconds (user + system) of all compilers, the wall clock, and the costliest files. The folder's build is deleted first."""
import argparse
import os
import pathlib
import resource
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
LOG = "SKYQUILT_BUILD_TIMES"


def compile_and_log(command):
    status = subprocess.call(command)
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    output = command[command.index("-o") + 1] if "-o" in command else command[-1]
    with open(os.environ[LOG], "a", encoding="utf-8") as log:
        log.write(f"{used.ru_utime + used.ru_stime:.2f} {used.ru_maxrss / 1024:.0f} {output}\n")
    return status


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--jobs", type=int, default=1, help="files at a time; with 1, files do not slow each other down")
    parser.add_argument("--target", default="skyquilt", help="'skyquilt' is the program; 'all' includes the tests")
    parser.add_argument("--folder", type=pathlib.Path, default=ROOT / "build" / "times")
    parser.add_argument("--show", type=int, default=15, help="files to list")
    words = parser.parse_args()
    log = words.folder / "build_times.txt"
    words.folder.mkdir(parents=True, exist_ok=True)
    environment = dict(os.environ, **{LOG: str(log)})
    launcher = f"{sys.executable};{pathlib.Path(__file__).resolve()};--compile"
    subprocess.run(["cmake", "--preset", "ci", "-B", str(words.folder), f"-DCMAKE_CXX_COMPILER_LAUNCHER={launcher}"], cwd=ROOT, check=True,
                   stdout=subprocess.DEVNULL)
    subprocess.run(["ninja", "-C", str(words.folder), "-t", "clean"], check=True, stdout=subprocess.DEVNULL)
    log.unlink(missing_ok=True)
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    subprocess.run(["ninja", "-C", str(words.folder), f"-j{words.jobs}", words.target], check=True, env=environment)
    after, wall = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic() - start
    all_cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    rows = sorted((float(line.split()[0]), int(line.split()[1]), line.split()[2]) for line in log.read_text().splitlines())[::-1]
    print(f"{words.target}, {words.jobs} at a time: {wall:.0f} s, {all_cpu:.0f} CPU s, of which {len(rows)} compilations {sum(row[0] for row in rows):.0f} CPU s; "
          f"largest compiler process {max(row[1] for row in rows)} MB")
    for seconds, megabytes, output in rows[:words.show]:
        print(f"{seconds:7.1f} s {megabytes:5} MB  {output}")


if __name__ == "__main__":
    if sys.argv[1:2] == ["--compile"]:
        sys.exit(compile_and_log(sys.argv[2:]))
    main()
