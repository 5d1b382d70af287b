"""`bench kernel` works with every instruction set and reports its settings; speed itself is not tested. Benchmarks write JSON, CSV and a page."""
import csv
import json
import shutil

from harness import expect, main

SMALL = ["--seconds", "0.02", "--rounds", "1", "--log2-table-size", "10", "--batch", "2048"]


def rows_of(path):
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.reader(file))


def check_page(path, *texts):
    page = path.read_text(encoding="utf-8")
    expect("http" not in page, f"{path.name} loads something from the internet")
    for text in ("<svg", 'class="bar', *texts):
        expect(text in page, f"{path.name} lacks {text}")


def check_kernel_files(out, result):
    threads = "one thread" if result["threads"] == 1 else f"{result['threads']} threads"
    check_page(out / "kernel.html", "Against the limit", "skyquilt bench kernel", result["machine"])
    rows = {row[0]: row[1:] for row in rows_of(out / "kernel_limit.csv")}
    expect(float(rows[f"training, {threads}"][0]) == result["train_samples_per_second"], rows)
    expect(float(rows[f"training, {threads}"][1]) == result["roofline_train_samples_per_second"], rows)
    expect(float(rows[f"inference, {threads}"][0]) == result["infer_samples_per_second"], rows)
    expect(("inference, one thread" in rows) == ("one_thread" in result or result["threads"] == 1), rows)
    phases = {row[0]: float(row[1]) for row in rows_of(out / "kernel_phases.csv")[1:]}
    phases["waiting"] = phases.pop("waiting, bookkeeping")
    expect(phases == result["share"], f"{phases} in kernel_phases.csv, {result['share']} in kernel.json")
    machine = [float(row[1]) for row in rows_of(out / "kernel_machine.csv")[1:4]]
    expect(machine == list(result["limit_ns_per_sample_and_thread"].values()), machine)


def check_poses(skyquilt, out):
    small = ["--place", "hamlet", "--set", "simulate.image_width=320", "-o", out]
    skyquilt.call("bench", "poses", "--sets", "plain", "--photos", "9,9", "-o", out, status=2)
    skyquilt.call("bench", "poses", "--sets", "plain", "--photos", "900", *small, status=2, says=("--photos 900", "hamlet"))
    skyquilt.call("bench", "poses", "--sets", "turned", "--photos", "9", *small, says=("registered", "no fewer photos than COLMAP alone"))
    result = json.loads((out / "poses.json").read_text())
    expect([(row["set"], row["way"]) for row in result["rows"]] == [("turned", "fast"), ("turned", "colmap")], result["rows"])
    for row in result["rows"]:
        expect(row["photos"] == 9 and row["registered"] >= row["right"] and row["seconds"] > 0.0, row)
    expect(result["rows"][0]["right"] == 9, result["rows"][0])
    rows = rows_of(out / "poses.csv")
    expect([row[0] for row in rows] == ["set", "turned", "turned"] and float(rows[1][5]) == 9, rows)
    expect("Poses of photos that are hard to place" in (out / "poses.html").read_text(), "poses.html lacks its title")
    expect(not (out / "poses_work").exists(), "the folder of the photo sets is still there")


def check_scale(skyquilt, out):
    skyquilt.call("bench", "scale", "--quick", "--photos", "24,24", "-o", out, status=2, says="--photos")
    skyquilt.call("bench", "scale", "--quick", "--photos", "9000", "-o", out, status=2, says=("--photos 9000", "hamlet"))
    words = ("bench", "scale", "--quick", "--time-budget", "2s", "-o", out)
    skyquilt.call(*words, says=("Peak memory", "20000 photos"))
    result = json.loads((out / "scale.json").read_text())
    expect([row["photos"] for row in result["rows"]] == [12, 24], result["rows"])
    for row in result["rows"]:
        names = [stage["name"] for stage in row["stages"]]
        expect(names == ["simulate", "prepare", "partition", "train", "merge", "products", "surface", "evaluate"], names)
        expect(all(stage["seconds"] > 0.0 and stage["peak_bytes"] > 1e6 for stage in row["stages"]) and row["blocks"] >= 1, row)
    expect(result["rows"][1]["area_m2"] > result["rows"][0]["area_m2"], "the area does not grow with the photos")
    page = (out / "scale.html").read_text()
    expect("Time of the stages" in page and "<svg" in page, "scale.html lacks its plot")
    expect([row[0] for row in rows_of(out / "scale_time.csv")][:2] == ["stage", "simulate"], rows_of(out / "scale_time.csv"))
    expect(not (out / "scale_work" / "24").exists(), "the project of a finished survey is still there")
    # Saved figures are used again.
    skyquilt.call(*words, says="24 photos: nothing to do")
    expect(json.loads((out / "scale.json").read_text())["rows"] == result["rows"], "the saved figures have changed")


def check_seeding(skyquilt, out):
    skyquilt.call("bench", "seeding", "--quick", "--photos", "24,24", "-o", out, status=2, says="--photos")
    skyquilt.call("bench", "seeding", "--quick", "--thread-counts", "1,2", "-o", out, says="every photo has the right pose")
    rows = json.loads((out / "seeding.json").read_text())["rows"]
    expect([(row["photos"], row["threads"]) for row in rows] == [(12, 1), (12, 2), (24, 1), (24, 2)], rows)
    for row in rows:
        expect(row["right"] == row["photos"] and row["seconds"] > 0.0 and row["peak_bytes"] >= row["input_bytes"] > 1e6, row)
        expect(0.0 < row["wrong_matches"] < 0.05 * row["matches"], row)
    expect("Time and memory" in (out / "seeding.html").read_text(), "seeding.html lacks its section")
    expect([row[0] for row in rows_of(out / "seeding_tracks.csv")] == ["photos", "12", "24"], rows_of(out / "seeding_tracks.csv"))


def test(skyquilt, folder):
    out = folder / "bench"
    for isa in ("portable", None):
        words = ["bench", "kernel", *SMALL, "-o", out] + (["--isa", isa] if isa else [])
        skyquilt.call(*words, says=("training", "limit"))
        result = json.loads((out / "kernel.json").read_text())
        for key in ("isa", "threads", "train_samples_per_second", "infer_samples_per_second", "roofline_train_samples_per_second",
                    "roofline_fraction", "share", "config", "machine", "date"):
            expect(key in result, f"{key} is missing in kernel.json")
        expect(result["train_samples_per_second"] > 0.0 and result["roofline_train_samples_per_second"] > 0.0, result)
        expect(0.9 < sum(result["share"].values()) < 1.1, f"shares do not add up: {result['share']}")
        expect(result["config"]["log2_table_size"] == 10, result["config"])
        check_kernel_files(out, result)

    # On several ranks only one process measures and prints.
    text = skyquilt.call("bench", "kernel", *SMALL, "--threads", "1", ranks=2)
    expect(text.count("Training time by phase") == 1, text)

    # A small simulated cluster; settings given on the command line override --quick.
    skyquilt.call("bench", "schedule", "--quick", "--blocks", "300", "--status-every", "60", "-o", out, says="nothing fails")
    result = json.loads((out / "schedule.json").read_text())
    expect(result["config"]["blocks"] == 300 and result["config"]["ranks"] == 100, result["config"])
    check_page(out / "schedule.html", "skyquilt bench schedule --quick", result["machine"])
    for row, run in zip(rows_of(out / "schedule.csv")[1:], ("undisturbed", "failing"), strict=True):
        expect([float(cell) for cell in row[1:]] == list(result[run].values()), f"{row} in schedule.csv, {result[run]} in schedule.json")
    shares = rows_of(out / "schedule_time.csv")[1:]
    expect(float(shares[0][1]) == result["undisturbed"]["efficiency"] and abs(sum(float(row[2]) for row in shares) - 1.0) < 1e-9, shares)

    # Times of stages that are not there.
    skyquilt.call("bench", "schedule", "--stages", folder / "nowhere", status=3, says="train.json")

    # Extreme numbers: the page has the tables, the files have every row, and temporary surveys are removed.
    text = skyquilt.call("bench", "numerics", "--quick", "--only", "space,nonfinite,brightness,storage", "-o", out)
    expect("Space" in text and "FAILED" not in text, text)
    result = json.loads((out / "numerics.json").read_text())
    expect(result["failed"] == 0 and result["passed"] > 30, result["passed"])
    page = (out / "numerics.html").read_text()
    rows = (out / "numerics_nonfinite.csv").read_text().splitlines()
    expect("How far rounding moves a place" in page and "North pole" in page, "the page lacks its plot or its rows")
    expect(rows[0] == "case,verdict,worst error,allowed,expected,seen" and len(rows) == 13, rows)
    expect(not (out / "work").exists(), "the folder of the cases' surveys is still there")

    check_scale(skyquilt, out)
    check_seeding(skyquilt, out)

    if shutil.which("colmap"):
        check_poses(skyquilt, out)


if __name__ == "__main__":
    main(test)
