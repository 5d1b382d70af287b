#!/usr/bin/env python3
"""Prepares a simulated hamlet many times, each time with other faults in the photos' tags: is a wrong height above ground ever silent?

  scripts/tag_faults.py --program build/ci/skyquilt --folder DIR [--cases 60] [--width 200]

Faults: focal length tag absent or wrong by 0.3 to 3, gimbal pitch with the opposite sign, measured from straight down or 0, heights of 0 in some
photos or all, RelativeAltitude absent; each case has one to three of them. Prints a table. A case is good when the height above ground is within
10 %, or the program refuses, or a warning in survey.json names the focal length as the cause; a line of the log alone ("wrong, noted") is no warning.
Of right cases those are counted where such a warning came all the same ("right, doubted"). Finished cases are not repeated: the same command goes on
where it was stopped. Exit status 1 when a case is not good, or was not finished in time. Needs COLMAP; a case takes ten seconds to some minutes."""
import argparse
import json
import math
import os
import pathlib
import random
import re
import shutil
import signal
import statistics
import struct
import subprocess
import sys

XMP = b"http://ns.adobe.com/xap/1.0/\0"
WITHIN = 0.1
GOOD = {"right", "right, doubted", "wrong, named", "no place, said", "refused"}


def edit_exif(segment, change):
    """Calls change(tag, tiff, offset of the value field, byte order) for each entry; `segment` is a bytearray that begins with Exif."""
    tiff = segment[6:]
    order = "<" if tiff[:2] == b"II" else ">"

    def walk(offset):
        for k in range(struct.unpack_from(order + "H", tiff, offset)[0]):
            entry = offset + 2 + 12 * k
            tag, _, _, value = struct.unpack_from(order + "HHII", tiff, entry)
            if tag in (0x8769, 0x8825):  # EXIF, GPS
                walk(value)
            else:
                change(tag, tiff, entry + 8, order)

    walk(struct.unpack_from(order + "I", tiff, 4)[0])
    return segment[:6] + tiff


def edit_photo(path, exif_change, xmp_change):
    """Rewrites the tags of a JPEG; the pixels stay."""
    data = path.read_bytes()
    out, at = bytearray(data[:2]), 2
    while data[at + 1] != 0xDA:
        length = struct.unpack_from(">H", data, at + 2)[0]
        marker, segment = data[at + 1], bytearray(data[at + 4:at + 2 + length])
        if marker == 0xE1 and segment.startswith(b"Exif\0\0"):
            segment = edit_exif(segment, exif_change)
        elif marker == 0xE1 and segment.startswith(XMP):
            segment = bytearray(XMP + xmp_change(segment[len(XMP):].decode()).encode())
        out += struct.pack(">BBH", 0xFF, marker, len(segment) + 2) + segment
        at += 2 + length
    path.write_bytes(out + data[at:])


def xmp_value(text, name):
    found = re.search(rf'drone-dji:{name}="([^"]*)"', text)
    return float(found.group(1)) if found else None


def set_xmp(text, name, value):
    """None removes the tag."""
    new = "" if value is None else f'drone-dji:{name}="{value:+.2f}"'
    return re.sub(rf'drone-dji:{name}="[^"]*"', new, text)


def draw_faults(rng):
    """What is wrong with the tags of one case, as words that apply_faults understands."""
    faults = {}
    kinds = rng.sample(["focal", "focal", "pitch", "altitude", "relative"], rng.randint(1, 3))
    if "focal" in kinds:
        faults["focal"] = 0.0 if rng.random() < 0.35 else round(math.exp(rng.uniform(math.log(0.3), math.log(3.0))), 2)
    if "pitch" in kinds:
        faults["pitch"] = rng.choice(["sign", "from_down", "zero"])
    if "altitude" in kinds:
        faults["altitude_zeros"] = rng.choice([0.1, 0.33, 0.6, 1.0])
    if "relative" in kinds:
        faults["relative"] = rng.choice(["absent", "absent", "zero"])
    return faults


def apply_faults(faults, photos, rng):
    for photo in photos:
        zero_height = rng.random() < faults.get("altitude_zeros", 0.0)

        def exif_change(tag, tiff, at, order):
            if tag == 0xA405 and "focal" in faults:  # FocalLengthIn35mmFilm
                old = struct.unpack_from(order + "H", tiff, at)[0]
                struct.pack_into(order + "H", tiff, at, 0 if faults["focal"] == 0.0 else max(1, round(old * faults["focal"])))
            elif tag == 6 and zero_height:  # GPSAltitude, a rational
                struct.pack_into(order + "I", tiff, struct.unpack_from(order + "I", tiff, at)[0], 0)

        def xmp_change(text):
            if zero_height:
                text = set_xmp(text, "AbsoluteAltitude", 0.0)
            if "relative" in faults:
                text = set_xmp(text, "RelativeAltitude", None if faults["relative"] == "absent" else 0.0)
            if "pitch" in faults:
                pitch = xmp_value(text, "GimbalPitchDegree")
                text = set_xmp(text, "GimbalPitchDegree", {"sign": -pitch, "from_down": pitch + 90.0, "zero": 0.0}[faults["pitch"]])
                if faults["pitch"] == "zero":
                    text = set_xmp(set_xmp(text, "GimbalRollDegree", 0.0), "GimbalYawDegree", 0.0)
            return text

        edit_photo(photo, exif_change, xmp_change)


def true_height(photos):
    """The hamlet is level, and its barometer is right."""
    heights = []
    for photo in photos:
        def read(text):
            heights.append(xmp_value(text, "RelativeAltitude"))
            return text
        copy = photo.with_suffix(".read")
        shutil.copyfile(photo, copy)
        edit_photo(copy, lambda *_: None, read)
        copy.unlink()
    return statistics.median(heights)


def run(command, limit_s, log):
    with open(log, "w", encoding="utf-8") as output:
        process = subprocess.Popen(command, stdout=output, stderr=subprocess.STDOUT, start_new_session=True)
        try:
            return process.wait(timeout=limit_s)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()
            return None


def judge(folder, status, log, height_m):
    text = log.read_text(encoding="utf-8", errors="replace")
    result = {"status": status, "ratio": None, "codes": [], "verdict": ""}
    if status is None:
        result["verdict"] = "too slow"
        return result
    if status != 0:
        result["verdict"] = "refused"
        return result
    survey = json.loads((folder / "survey" / "survey.json").read_text(encoding="utf-8"))
    result["codes"] = [problem["code"] for problem in survey["problems"]]
    if not survey["georeferenced"]:
        result["verdict"] = "no place, said" if result["codes"] else "SILENT"
        return result
    heights = [photo["agl_m"] for photo in survey["photos"] if photo["agl_m"] is not None]
    result["ratio"] = statistics.median(heights) / height_m if heights else None
    named = any("focal length" in problem["finding"] for problem in survey["problems"])
    if result["ratio"] is not None and abs(result["ratio"] - 1.0) <= WITHIN:
        result["verdict"] = "right, doubted" if named else "right"
    elif named:
        result["verdict"] = "wrong, named"
    elif "follows the focal length of the tags" in text or "tagged focal length is wrong" in text:
        result["verdict"] = "wrong, noted"
    else:
        result["verdict"] = "SILENT"
    return result


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=pathlib.Path, required=True)
    parser.add_argument("--folder", type=pathlib.Path, required=True, help="for the survey, the cases and their results; kept")
    parser.add_argument("--cases", type=int, default=60)
    parser.add_argument("--width", type=int, default=200, help="of the photos, pixels")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--limit", type=float, default=300.0, help="seconds for one case")
    words = parser.parse_args()
    words.folder.mkdir(parents=True, exist_ok=True)
    truth = words.folder / f"hamlet_{words.width}"
    if not (truth / "simulate.json").exists():
        command = [words.program, "simulate", "hamlet", "--image-width", str(words.width), "--set", "simulate.exact_frame=false", "--out", truth]
        if run([str(word) for word in command], words.limit, words.folder / "simulate.txt") != 0:
            sys.exit(f"the simulation failed, see {words.folder / 'simulate.txt'}")
    photos = sorted((truth / "images").glob("*.jpg"))
    height_m = true_height(photos)
    counts = {}
    print(f"{'case':>4}  {'status':>6}  {'height':>6}  {'verdict':<14}  {'faults':<58}  problems", flush=True)
    for case in range(words.cases):
        rng = random.Random(1000 * words.seed + case)
        faults = draw_faults(rng)
        folder = words.folder / f"case_{words.seed}_{words.width}_{case:03d}"
        file = folder / "result.json"
        if file.exists():
            result = json.loads(file.read_text(encoding="utf-8"))
        else:
            shutil.rmtree(folder, ignore_errors=True)
            shutil.copytree(truth / "images", folder / "images")
            apply_faults(faults, sorted((folder / "images").glob("*.jpg")), rng)
            status = run([str(words.program), "prepare", str(folder / "images"), "--out", str(folder / "out")], words.limit, folder / "log.txt")
            result = judge(folder / "out", status, folder / "log.txt", height_m)
            shutil.rmtree(folder / "out" / "survey" / "colmap", ignore_errors=True)
            file.write_text(json.dumps(result) + "\n", encoding="utf-8")
        counts[result["verdict"]] = counts.get(result["verdict"], 0) + 1
        ratio = "-" if result["ratio"] is None else f"{result['ratio']:.2f}"
        print(f"{case:4d}  {str(result['status']):>6}  {ratio:>6}  {result['verdict']:<14}  {json.dumps(faults):<58}  {' '.join(result['codes'])}", flush=True)
    print(", ".join(f"{n} {verdict}" for verdict, n in sorted(counts.items())))
    sys.exit(0 if GOOD.issuperset(counts) else 1)


if __name__ == "__main__":
    main()
