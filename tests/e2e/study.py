"""Benchmarks that train: they resume after an interruption, their pages are complete, and results of other settings are not mixed in."""
import json
import re
import signal

from harness import digest, expect, main, small_survey, wait_for

SMALL = ["--quick", "--time-budget", "1s", "--set", "run.shortest_block_s=0.6", "--set", "run.image_width=160", "--set", "train.batch_samples=4096", "--set", "context.batch_samples=4096",
         "--set", "evaluate.max_photos=2"]


def check_page(folder, name, pictures=True):
    html = (folder / f"{name}.html").read_text()
    expect("http" not in re.sub(r'xmlns="[^"]*"', "", html), "the page loads something from the internet")
    for link in re.findall(r'<img src="([^"]+)"', html):
        expect((folder / link).is_file(), f"{name}.html shows {link}, which is not there")
    expect(("<img" in html or not pictures) and "<svg" in html, f"{name}.html has no picture or no plot")
    expect(list(folder.glob(f"{name}*.csv")), "no CSV")
    return json.loads((folder / f"{name}.json").read_text())


def test(skyquilt, folder):
    survey = small_survey(skyquilt)
    out = folder / "bench"
    words = ["bench", "single-vs-multi", "--survey", survey, "-o", out, "--blocks", "1x2", *SMALL]
    process = skyquilt.start(*words)
    wait_for((out / "runs" / "guided.json").exists, "first result", process)
    process.send_signal(signal.SIGINT)
    process.wait(timeout=120)
    expect(process.returncode == 130, f"ended with {process.returncode} when interrupted:\n{process.stdout.read()}")
    before = digest(out / "runs" / "guided")

    skyquilt.call(*words, says=("dB", "single"))
    expect(digest(out / "runs" / "guided") == before, "a finished variant was run again")
    result = check_page(out, "single-vs-multi")
    names = [variant["name"] for variant in result["results"]]
    expect(names == ["guided", "single_small", "single_large", "independent", "shared_height", "everywhere", "shared_everywhere"], names)
    for variant in result["results"]:
        expect("failure" not in variant, variant)
        expect(variant["psnr_db"] > 8.0 and variant["train_seconds"] > 0.0 and variant["parameters"] > 0 and variant["floater_opacity"] is not None, variant)
        expect([place[0] for place in variant["floater_profile"]] == [1, 2, 5, 10, 20] and variant["floater_profile"][0][1] >= variant["floater_profile"][3][1], variant)
        expect(variant["blocks"] == (1 if variant["name"].startswith("single") else 2), variant)
        expect(not (out / "runs" / variant["name"] / "checkpoints").exists(), "large files were kept")
        expect((out / variant["report"]).is_file(), "the variant's report is gone")
        expect(variant["psnr_common_db"] is not None and len(list((out / "runs" / variant["name"] / "covered").rglob("*.png"))) == 2, variant)
    large = {variant["name"]: variant for variant in result["results"]}
    expect(large["single_large"]["parameters"] > large["single_small"]["parameters"], "the large model is not larger")

    skyquilt.call(*words, "--set", "train.hidden=32", status=2, says="other settings")
    skyquilt.call("bench", "blocks", "--survey", folder / "nowhere", "-o", folder / "none", status=3)
    skyquilt.call("bench", "blocks", "--survey", survey, "--place", "town", "-o", folder / "none", status=2)
    skyquilt.call("bench", "blocks", "--blocks", "1x1,auto", "-o", folder / "none", status=2, says="--blocks auto")
    skyquilt.call("bench", "blocks", "--steps", "9", "--time-budget", "1s", "-o", folder / "none", status=2, says="exclude each other")

    # Equal steps: those of all blocks together are the same.
    out = folder / "blocks"
    skyquilt.call("bench", "blocks", "--survey", survey, "-o", out, "--blocks", "1x1,1x2", "--log2-table-sizes", "13", "--steps", "40", *SMALL[:1], *SMALL[3:])
    for variant in check_page(out, "blocks")["results"]:
        steps = {field["name"]: field["steps"] for field in variant["fields"]}
        expect(steps.pop("context") == 6 and sum(steps.values()) == 34, variant)

    # Parameters kept in the scene against parameters trained. Two seeds of one survey, of which the first goes on with what there is.
    out = folder / "capacity"
    words = ["bench", "capacity", "--survey", survey, "-o", out, "--blocks", "1x2", "--log2-table-sizes", "13", "--voxels-per-entry", "8", *SMALL]
    skyquilt.call(*words)
    before = digest(out / "runs" / "fitted")
    result = check_page(out, "capacity")
    psnr = {variant["name"]: variant["psnr_common_db"] for variant in result["results"]}
    told = [verdict for verdict in result["verdicts"] if "8 voxels per entry" in verdict]
    expect(len(told) == 1 and ("no difference seen" in told[0]) == (abs(psnr["shared_8"] - psnr["fitted"]) <= 0.3), (told, psnr))
    skyquilt.call(*words, "--seeds", "1,2")
    expect(digest(out / "runs" / "fitted") == before and not (out / "seed_2").exists(), "the first seed was run again, or the survey prepared twice")
    result = check_page(out, "capacity")
    expect([variant["name"] for variant in result["results"]] == ["fitted", "uniform_13", "shared_8"], result["results"])
    for variant in result["results"]:
        expect([seed["name"] for seed in variant["seeds"]] == [variant["name"], variant["name"] + "_s2"], variant["seeds"])
        for score in ("psnr_db", "psnr_common_db"):
            expect(abs(2.0 * variant[score] - sum(seed[score] for seed in variant["seeds"])) < 1e-9, variant)
        for seed in variant["seeds"]:
            fields = seed["fields"]
            expect([field["name"] for field in fields] == ["context", "r0c0", "r0c1"], fields)
            for field in fields:
                # A block that is worse than the context after so short a time is not in the scene.
                expect(field["scene_parameters"] == 0 if field["shows_context"] else 0 < field["scene_parameters"] <= field["parameters"], field)
            for count in ("parameters", "scene_parameters"):
                expect(sum(field[count] for field in fields) == seed[count], seed)
            if variant["name"] == "uniform_13":
                expect([field["log2_table_size"] for field in fields] == [0, 13, 13], fields)

    # One training, merged in three ways; and photos left out with what only they observed.
    out = folder / "tradeoff"
    skyquilt.call("bench", "tradeoff", "--survey", survey, "-o", out, *SMALL)
    result = check_page(out, "tradeoff")
    stored = {variant["name"]: variant for variant in result["results"] if variant["name"].startswith("storage")}
    expect(len(stored) == 3, stored)
    for name in ("storage_bf16", "storage_fp16"):
        expect(stored[name]["scene_bytes"] < 0.65 * stored["storage_fp32"]["scene_bytes"], stored)
        expect(abs(stored[name]["psnr_db"] - stored["storage_fp32"]["psnr_db"]) < 0.1, stored)
        expect(stored[name]["train_seconds"] == stored["storage_fp32"]["train_seconds"], "it was trained again")
    photos = {variant["name"]: variant["training_photos"] for variant in result["results"] if variant["name"].startswith("photos")}
    expect(photos["photos_1"] > photos["photos_2"] > 0 and "without the others" in (out / "log.txt").read_text(), photos)

    # Renderings of several widths.
    out = folder / "scales"
    words = ["bench", "scales", "--survey", survey, "-o", out, "--parts", "steps", "--positions", "0,1", *SMALL]
    skyquilt.call("bench", "scales", "--survey", survey, "-o", out, "--parts", "heights", *SMALL, status=2)
    skyquilt.call(*words)
    result = check_page(out, "scales")
    names = [f"steps_{samples}_{photos}" for samples in ("points", "cones1") for photos in ("photos", "pyramid")]
    expect([variant["name"] for variant in result["results"]] == names, result["results"])
    steps = {variant["name"]: [field["steps"] for field in variant["fields"]] for variant in result["results"]}
    timed = json.loads((out / "runs" / "time_points_photos.json").read_text())
    for name in names:
        expect(steps[name] == steps["steps_points_photos"] and steps[name][0] == timed["fields"][0]["steps"], steps)
    for variant in result["results"]:
        scores = [(score["divisor"], score["averaged"], score["width"]) for score in variant["scales"]]
        expect(scores == [(1, False, 160), (2, False, 80), (2, True, 80), (4, False, 40), (4, True, 40), (8, False, 20), (8, True, 20)], scores)
        expect(all(score["psnr_db"] > 5.0 and score["photos"] == 2 for score in variant["scales"]), variant["scales"])
        expect(abs(variant["scales"][0]["psnr_db"] - variant["psnr_full_db"]) < 3.0, variant)
    expect((out / "scales.png").is_file(), "no picture")
    before = digest(out / "runs")
    skyquilt.call(*words)
    expect(digest(out / "runs") == before, "a finished variant was run again")

    # Methods: their options come from configs/methods, and a survey from another height is added later.
    out = folder / "methods"
    skyquilt.call("bench", "methods", "--survey", survey, "-o", out, "--overlaps", "0.6", *SMALL, status=2, says="--place")
    words = ["bench", "methods", "-o", out, *SMALL, "--set", "simulate.image_width=160"]
    skyquilt.call(*words, "--blocks", "1x1", status=2, says="one field")
    skyquilt.call(*words, "--methods", "tensorf,skyquilt", "--altitudes", "45", says="tensorf: blocks against one field")
    result = check_page(out, "methods")
    names = ["tensorf_one_a45", "tensorf_blocks_a45", "skyquilt_one_a45", "skyquilt_blocks_a45"]
    expect([variant["name"] for variant in result["results"]] == names, result["results"])
    for variant in result["results"]:
        expect("failure" not in variant and variant["psnr_common_db"] is not None, variant)
        expect(variant["blocks"] == (1 if "_one_" in variant["name"] else 2), variant)
        expect(all(field["rays"] > 0 and field["samples"] > 0 for field in variant["fields"]), variant["fields"])
        config = (out / "runs" / variant["name"] / "config.toml").read_text()
        expect(('encoding = "planes"' in config) == variant["name"].startswith("tensorf"), config)
    rows = [line.split(",")[:2] for line in (out / "methods_blocks.csv").read_text().splitlines()[1:]]
    expect(rows == [[name, block] for name in ("tensorf", "skyquilt") for block in ("r0c0", "r0c1")], rows)
    expect((out / "methods.png").is_file(), "no picture")
    before = digest(out / "runs")
    skyquilt.call(*words, "--methods", "tensorf", "--altitudes", "45,60")
    expect(digest(out / "runs") == before, "a finished variant was run again")
    result = check_page(out, "methods")
    expect([variant["name"] for variant in result["results"]] == names[:2] + ["tensorf_one_a60", "tensorf_blocks_a60"], result["results"])
    photos = [variant["training_photos"] for variant in result["results"]]
    expect(photos[1] > photos[2], f"as many photos from both heights: {photos}")
    for variant in result["results"]:
        expect((out / variant["report"]).is_file(), variant["report"])

    # Light: every second light is trained, and what was done is not done again.
    out = folder / "light"
    words = ["bench", "light", "-o", out, "--quick", "--steps", "20", "--set", "simulate.image_width=80", "--set", "run.image_width=80", "--set",
             "partition.max_log2_table_size=14", "--set", "train.batch_samples=4096", "--set", "context.batch_samples=4096"]
    skyquilt.call(*words, "--survey", survey, status=2, says="--place")
    skyquilt.call(*words, says="Lights between the trained ones")
    result = check_page(out, "light")
    names = ["every_second", "all_lights", "no_codes"]
    expect([variant["name"] for variant in result["results"]] == names + ["intensity_" + name for name in names + ["corrected"]], result["results"])
    looks = {variant["name"]: [(score["light"], score["look"]) for score in variant["lights"]] for variant in result["results"]}
    suns, intensities = [f"sun_{deg:02}" for deg in (5, 25, 45, 65, 85)], ["light_1.00", "light_2.00", "light_3.00"]
    expect(looks["all_lights"] == [(light, "own") for light in suns] and looks["no_codes"] == [(light, "none") for light in suns], looks)
    expect(looks["intensity_corrected"] == [(light, "none") for light in intensities], looks)
    expect(sorted(looks["intensity_every_second"]) == [("light_1.00", "own"), ("light_2.00", "between"), ("light_2.00", "lower"), ("light_2.00", "upper"),
                                                       ("light_3.00", "own")], looks)
    counts = [variant["training_photos"] for variant in result["results"]]
    expect(counts[0] * 5 == counts[1] * 3 and counts[3] * 3 == counts[4] * 2, f"trained with other shares of the lights: {counts}")
    for variant in result["results"]:
        expect(all(score["photos"] == 3 and score["psnr_db"] > 5.0 for score in variant["lights"]), variant["lights"])
    stops = [score["stops"] for score in result["results"][-1]["lights"]]
    expect(stops[0] < stops[1] < stops[2], f"the correction found {stops} stops")
    expect((out / "light.png").is_file() and len((out / "light_sun.csv").read_text().splitlines()) == 6, "no picture or another table")
    before = digest(out / "runs")
    skyquilt.call(*words)
    expect(digest(out / "runs") == before, "a finished variant was run again")

    # Priors: every seed has a place of its own, and the pictures remain when the scenes are removed.
    out = folder / "priors"
    words = ["bench", "priors", "-o", out, "--priors", "all", "--seeds", "5,6", *SMALL, "--set", "simulate.image_width=160"]
    skyquilt.call("bench", "priors", "-o", out, "--seeds", "5,5", *SMALL, status=2)
    skyquilt.call(*words, says="'all' against 'none': ")
    result = check_page(out, "priors")
    expect([variant["name"] for variant in result["results"]] == ["none_s5", "all_s5", "none_s6", "all_s6"], result["results"])
    for variant in result["results"]:
        expect("failure" not in variant, variant)
        expect({"roof", "wall", "ground", "tree"} <= set(variant["classes"]), variant["classes"])
        expect((out / variant["report"]).is_file() and (out / variant["views"] / "view_0_normals.png").is_file(), variant)
        expect(not list((out / variant["report"]).parents[1].glob("scene.h5")), "large files were kept")
    towns = [(out / source / "simulated" / "truth" / "buildings.json").read_text() for source in ("source", "seed_6/source")]
    expect(towns[0] != towns[1], "both seeds have the same place")
    expect((out / "priors.png").is_file(), "no picture")
    before = digest(out / "runs"), digest(out / "seed_6" / "runs")
    skyquilt.call(*words)
    expect((digest(out / "runs"), digest(out / "seed_6" / "runs")) == before, "a finished variant was run again")

    # Buildings: sources without training, and a field that is added later.
    out = folder / "buildings"
    words = ["bench", "buildings", "-o", out, "--seeds", "5", *SMALL, "--set", "simulate.image_width=160", "--variants"]
    skyquilt.call("bench", "buildings", "--survey", survey, "-o", out, "--shapes", "varied", *SMALL, status=2)
    skyquilt.call(*words, "truth,points")
    before = digest(out / "runs" / "truth_s5"), (out / "runs" / "truth_s5.json").read_bytes()
    skyquilt.call(*words, "truth,points,field")
    expect((digest(out / "runs" / "truth_s5"), (out / "runs" / "truth_s5.json").read_bytes()) == before, "a finished variant was run again")
    result = check_page(out, "buildings", pictures=False)
    expect([variant["name"] for variant in result["results"]] == ["truth_s5", "points_s5", "field_s5"], result["results"])
    for variant in result["results"]:
        scores = variant["buildings"]
        expect(scores["outlines"] == sum(one["fate"] != "invented" for one in scores["each"]) > 0, scores)
        expect((variant["train_seconds"] is None) == (variant["name"] != "field_s5"), variant)
    truth = result["results"][0]["buildings"]
    expect(truth["matched"] == truth["outlines"], truth)
    for table in ("", "_sizes", "_measures", "_towns"):
        expect((out / f"buildings{table}.csv").is_file(), table)
    expect("building-map" in (out / "buildings.html").read_text(), "no plan")


if __name__ == "__main__":
    main(test)
