#!/usr/bin/env python3
"""Builds the viewer's front end from a copy of web/, so that the source folder stays clean.

  build_front_end.py --source web --work build/release/web [--tests]

Writes <work>/dist/{index.html,app.js,app.css,tour.html,tour.js,tour.css,licences.txt}; with --tests also <work>/dist_test, which has the hook of
the page tests, and the tools that check the source. Without Node.js or npm, or when npm cannot fetch the packages, the files are empty: the program is
built all the same, and `skyquilt view` says what is missing. The next build then tries again.
"""
import argparse
import hashlib
import os
import pathlib
import shutil
import subprocess
import sys

FILES = ("index.html", "app.js", "app.css", "tour.html", "tour.js", "tour.css", "licences.txt")
HASTE = ["--fetch-retries=1", "--fetch-timeout=60000"]


class Unavailable(Exception):
    pass


def run(words, folder, seconds):
    try:
        done = subprocess.run(words, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace", timeout=seconds)
    except subprocess.TimeoutExpired as late:
        raise Unavailable(f"'{' '.join(words[:2])}' did not end within {seconds} s") from late
    return done


def copy_source(source, work):
    """The same files as in the source folder; node_modules stays."""
    for old in work.iterdir():
        if old.name in ("node_modules", "installed.txt", "dist", "dist_test"):
            continue
        shutil.rmtree(old) if old.is_dir() else old.unlink()
    for new in source.iterdir():
        if new.name in ("node_modules", "dist"):
            continue
        target = work / new.name
        shutil.copytree(new, target) if new.is_dir() else shutil.copy2(new, target)


def install(work, tests):
    """npm ci, unless what the lock file names is installed."""
    wanted = hashlib.sha256((work / "package-lock.json").read_bytes() + (work / "package.json").read_bytes()).hexdigest() + (" dev" if tests else "")
    stamp = work / "installed.txt"
    if stamp.exists() and (stamp.read_text() == wanted or stamp.read_text() == wanted + " dev") and (work / "node_modules").is_dir():
        return
    stamp.unlink(missing_ok=True)
    words = ["npm", "ci", "--ignore-scripts", "--no-audit", "--no-fund", *HASTE] + ([] if tests else ["--omit=dev"])
    done = run(words, work, 600)
    if done.returncode != 0:
        lines = [line for line in done.stdout.splitlines() if line.strip()]
        raise Unavailable("npm could not install the packages of web/package-lock.json: " + (lines[0] if lines else str(done.returncode)))
    stamp.write_text(wanted)


def build(work, out, hook):
    done = run(["node", "build.mjs", "--out", str(out)] + (["--test-hook"] if hook else []), work, 300)
    if done.returncode != 0:
        # An error in our own source must stop the build.
        sys.exit(done.stdout + "front end: 'node build.mjs' failed in " + str(work))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--source", type=pathlib.Path, required=True)
    parser.add_argument("--work", type=pathlib.Path, required=True)
    parser.add_argument("--tests", action="store_true")
    options = parser.parse_args()
    work = options.work.resolve()
    dist = work / "dist"
    work.mkdir(parents=True, exist_ok=True)
    try:
        for program in ("node", "npm"):
            if shutil.which(program) is None:
                raise Unavailable(f"{program} is not installed (Debian packages nodejs and npm)")
        copy_source(options.source.resolve(), work)
        install(work, options.tests)
        build(work, dist, hook=False)
        for name in FILES:
            if not (dist / name).exists():
                (dist / name).write_bytes(b"")
        if options.tests:
            build(work, work / "dist_test", hook=True)
        print("front end: built, " + ", ".join(f"{name} {(dist / name).stat().st_size // 1024} kB" for name in FILES))
    except Unavailable as reason:
        print(f"front end: NOT built, 'skyquilt view' will say so: {reason}", file=sys.stderr)
        shutil.rmtree(work / "dist_test", ignore_errors=True)
        dist.mkdir(exist_ok=True)
        for name in FILES:
            (dist / name).write_bytes(b"")
            os.utime(dist / name, (1, 1))  # older than the source, so that the next build tries again


if __name__ == "__main__":
    main()
