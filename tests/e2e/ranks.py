"""`run` on 1, 2 and 3 ranks gives the same quality; single stages give the same result as `run`; running again repeats nothing."""
import json

from harness import SMALL, digest, expect, hamlet, main, metrics_of, replaced


def test(skyquilt, folder):
    survey = hamlet(skyquilt, 240)
    before = digest(survey)
    skyquilt.call("simulate", "hamlet", "-o", survey, "--image-width", 240)
    expect(digest(survey) == before, "simulating again wrote something")

    psnr = {}
    for ranks in (1, 2, 3):
        project = folder / f"ranks{ranks}"
        skyquilt.call("run", survey, "-o", project, *SMALL, ranks=ranks)
        metrics = metrics_of(project)
        psnr[ranks] = metrics["psnr"]
        print(f"{ranks} ranks: PSNR {metrics['psnr']:.3f} dB, SSIM {metrics['ssim']:.4f}, coverage {metrics['coverage']:.3f}, "
              f"median depth error {metrics['depth_median_abs_m']:.2f} m")
        expect(metrics["ranks"] == ranks, f"the report says {metrics['ranks']} ranks")
        ground = metrics["classes"]["ground"]
        expect(ground["pixels"] > 10000 and ground["normal_median_deg"] < 45.0, f"the ground was scored as {ground}")
        expect(metrics["classes"]["roof"]["depth_nmad_m"] < 20.0, f"roofs were scored as {metrics['classes']['roof']}")
        for name in ("blocks.geojson", "scene.h5", "checkpoints/context.h5", "checkpoints/context.log.csv", "report/index.html", "log.txt", "config.toml"):
            expect((project / name).exists(), f"{name} is missing")
    found = json.loads((folder / "ranks1" / "survey" / "directions.json").read_text())["modes"]
    for yaw in json.loads((survey / "simulate.json").read_text())["district_yaw_deg"]:
        off = min(abs((mode["yaw_deg"] - yaw + 45.0) % 90.0 - 45.0) for mode in found)
        expect(off < 0.5, f"the district turned by {yaw} degrees is {off} degrees from the nearest of {found}")
    expect(max(psnr.values()) - min(psnr.values()) <= 0.1, f"PSNR depends on the ranks: {psnr}")
    # A field that learned only the mean colour would have about 15 dB.
    expect(psnr[1] > 18.0, f"PSNR {psnr[1]:.2f} dB: nothing was learned")

    alone = folder / "ranks1"
    before = digest(alone, but=("log.txt",))
    text = skyquilt.call("run", survey, "-o", alone, *SMALL)
    expect(digest(alone, but=("log.txt",)) == before, f"running again wrote something:\n{text}")

    stages = folder / "stages"
    skyquilt.call("prepare", survey, "-o", stages)
    skyquilt.call("partition", stages, *pick(SMALL, "--blocks", "--image-width", "--set"))
    skyquilt.call("train", stages, *pick(SMALL, "--steps"))
    skyquilt.call("merge", stages)
    skyquilt.call("render", stages)
    skyquilt.call("evaluate", stages)
    difference = abs(metrics_of(stages)["psnr"] - psnr[1])
    expect(difference < 1e-6, f"stage by stage differs from run by {difference} dB")

    for path in (alone, alone / "survey", alone / "survey" / "points.ply", alone / "survey" / "cameras.geojson", alone / "blocks.geojson",
                 alone / "scene.h5", alone / "checkpoints" / "context.h5", alone / "checkpoints" / "context.log.csv", alone / "train.json",
                 alone / "products" / "orthophoto.tif", alone / "report" / "metrics.json", alone / "config.toml", survey / "simulate.json"):
        expect(skyquilt.call("info", path).strip(), f"info prints nothing about {path}")
        expect(skyquilt.call("info", path, "--json").lstrip().startswith("{"), f"info --json does not print JSON for {path}")

    accuracy = read(alone / "survey" / "survey.json")["fit"]["accuracy"]
    expect(read(alone / "blocks.geojson")["skyquilt:accuracy"] == accuracy, "blocks.geojson has another accuracy than the survey")
    expect(read(alone / "products" / "orthophoto.json")["accuracy"] == accuracy, "the map has another accuracy than the survey")

    skyquilt.call("run", survey, "-o", alone, *replaced(SMALL, "--steps", "301"), status=2, says=("train.steps: 300 -> 301", "--restart"))
    expect(digest(alone, but=("log.txt",)) == before, "a refused run changed files")


def read(file):
    return json.loads(file.read_text())


def pick(words, *flags):
    chosen = []
    for flag, value in zip(words[::2], words[1::2]):
        if flag in flags:
            chosen += [flag, value]
    return chosen


main(test)
