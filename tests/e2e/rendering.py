"""A finished scene gives the same images, maps and scores on one process, with little memory and on any number of ranks."""
import hashlib
import json
import math
import re
import shutil
import signal

from harness import expect, main, metrics_of, small_survey, wait_for

# Keys of metrics.json about the evaluation itself, not about the scene.
OWN = ("evaluate_seconds", "evaluate_peak_rss_bytes", "date", "render_seconds", "rendering")


def scores_of(project):
    def stripped(value):
        if isinstance(value, dict):
            return {key: stripped(inner) for key, inner in value.items() if key not in OWN}
        return [stripped(inner) for inner in value] if isinstance(value, list) else value

    return stripped(metrics_of(project))


def medians_of(scores, kind):
    """Of the normals of the field ("density" or "head"), by class where they were measured."""
    medians = [one[f"{kind}_normal_median_deg"] for one in scores["classes"].values()]
    return [median for median in medians if median is not None]


def without_normals(scores):
    """Scores that do not depend on evaluate.field_normals."""
    kept = {key: value for key, value in scores.items() if key != "config"}
    kept["classes"] = {name: {key: value for key, value in one.items() if not key.startswith(("density_", "head_"))}
                       for name, one in scores["classes"].items()}
    return kept


def resume_evaluation(skyquilt, project, options, expected):
    """An evaluation that is killed or interrupted goes on after the last photo that it has saved, and ends with the same scores and pictures."""
    pictures = pictures_of(project / "report" / "images")
    progress = project / "cache" / "evaluate_progress.bin"
    expect(not progress.exists(), "a finished evaluation leaves the file of its progress")
    for stop, status in ((signal.SIGKILL, -signal.SIGKILL), (signal.SIGINT, 130)):
        process = skyquilt.start("evaluate", project, "--restart", *options, "--set", "evaluate.save_every_s=0.001")
        wait_for(progress.exists, "first saved photo", process)
        process.send_signal(stop)
        text, _ = process.communicate(timeout=120)
        expect(process.returncode == status, f"an evaluation that got signal {stop} ends with {process.returncode}:\n{text}")
        expect(not (project / "report" / "metrics.json").exists(), "the evaluation was over before it could be stopped")
        text = skyquilt.call("evaluate", project, *options, "--set", "evaluate.save_every_s=20")
        expect(re.search(r"evaluate: continues after [1-9]\d* of \d+ photos", text), f"the evaluation does not continue:\n{text}")
        expect(scores_of(project) == expected, "stopped and resumed gives other scores")
        expect(pictures_of(project / "report" / "images") == pictures, "stopped and resumed gives other pictures")
        expect(not progress.exists(), "a resumed evaluation leaves the file of its progress")


def check_painting(skyquilt, project, folder):
    """An orthophoto of several tiles, a strip from south to north: painted by other ranks, the same bytes."""
    origin = json.loads((project / "survey" / "survey.json").read_text())["origin"]
    east, north = origin["longitude_deg"], origin["latitude_deg"]
    ring = [[east + 8e-5 * x, north + 72e-5 * y] for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1), (-1, -1))]
    strip = folder / "strip.geojson"
    strip.write_text(json.dumps({"type": "Polygon", "coordinates": [ring]}))
    asked = ("render", project, "--ortho", "--resolution", "0.1", "--boundary", strip)

    def maps(name):
        return {file: (folder / name / file).read_bytes() for file in ("orthophoto.tif", "ortho_sources.tif")}

    skyquilt.call(*asked, "-o", folder / "strip")
    skyquilt.call(*asked, "-o", folder / "strip3", ranks=3, says="tiles of the orthophoto painted by 2 other ranks")
    expect(maps("strip3") == maps("strip"), "ranks paint another orthophoto")


def check_trust(skyquilt, project, folder):
    """The same with several ranks; gone where it is switched off, and then asked for in vain."""
    trust = (project / "trust.h5").read_bytes()
    skyquilt.call("merge", project, "--restart", ranks=3)
    expect((project / "trust.h5").read_bytes() == trust, "three ranks measure another trust")
    without = folder / "without_trust"
    shutil.copytree(project, without)
    skyquilt.call("merge", without, "--restart", "--set", "trust.tiles=0")
    expect(not (without / "trust.h5").exists(), "trust was measured though it is switched off")
    skyquilt.call("render", without, "--trust", "-o", folder / "no_map", status=3, says=("trust.h5", "trust.tiles"))


def pictures_of(folder):
    files = sorted(path for path in folder.rglob("*") if path.suffix in (".png", ".tiff", ".tif"))
    expect(len(files) >= 6, f"{folder} has only {[path.name for path in files]}")
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in files}


def bytes_of_fields(described):
    """Memory of each field while rendering. A cell of the occupancy grid takes a byte there, but a bit in the file."""
    fields = {}
    for array in described["arrays"]:
        name, _, what = array["name"].rpartition("/")
        if what in ("grid", "networks", "occupied_bits"):
            fields[name] = fields.get(name, 0) + math.prod(array["shape"]) * (8 if what == "occupied_bits" else 4)
    return fields


def test(skyquilt, folder):
    survey = small_survey(skyquilt)
    project = folder / "project"
    skyquilt.call("prepare", survey, "-o", project)
    skyquilt.call("partition", project, "--blocks", "1x3", "--set", "partition.max_log2_table_size=14")
    # A context that the blocks soon surpass: it would be shown in their place otherwise.
    skyquilt.call("train", project, "--steps", "60", "--set", "context.steps=10", "--set", "train.batch_samples=4096", "--set", "context.batch_samples=4096")
    skyquilt.call("merge", project)
    check_trust(skyquilt, project, folder)
    fields = bytes_of_fields(json.loads(skyquilt.call("info", project / "scene.h5", "--json")))
    # Memory of each rank: too little for the whole scene, but enough for the context and any two neighbouring blocks.
    little = str(2 * int(sum(fields.values()) - 0.5 * min(fields.values())))

    asked = ("--test", "--width", "120", "--ortho", "--dsm", "--normals", "density", "--trust")
    skyquilt.call("render", project, *asked, "-o", folder / "alone")
    alone = pictures_of(folder / "alone")
    views = [name for name in alone if name.endswith("_depth.tiff")]
    normals = {name: digest for name, digest in alone.items() if name.endswith("_normals.png")}
    expect(len(normals) == len(views) > 0, f"{len(normals)} pictures of normals for {len(views)} views")
    errors = [name for name in alone if name.endswith("_trust.tiff")]
    expect(len(errors) == len(views) and "trust.tif" in alone, f"{len(errors)} pictures of the errors to expect for {len(views)} views")
    skyquilt.call("render", project, "--normals", "--test", "--width", "120", "-o", folder / "depth_normals")
    of_depth = pictures_of(folder / "depth_normals")
    for name, digest in alone.items():
        if name in of_depth:
            expect((of_depth[name] == digest) == (name not in normals), f"{name} with normals of the depth")
    expect(set(normals) <= set(of_depth), "the views lack normals of the depth")
    skyquilt.call("render", project, "--test", "--normals", "predicted", "-o", folder / "predicted", status=2, says="normal head")
    skyquilt.call("render", project, "--ortho", "--normals", "depth", "-o", folder / "map_normals", status=2, says="--photo")

    for ranks in (2, 3, 4):
        out = folder / f"ranks{ranks}"
        text = skyquilt.call("render", project, *asked, "-o", out, ranks=ranks)
        expect(pictures_of(out) == alone, f"{ranks} ranks render other images")
        expect(re.search(rf"rays rendered by {ranks - 1} rank.* bytes per ray", text), f"the bytes sent are not reported:\n{text}")
    text = skyquilt.call("render", project, *asked, "-o", folder / "shared", "--memory", little, ranks=3)
    expect(pictures_of(folder / "shared") == alone, "ranks that hold parts of a scene render other images")
    handovers = re.search(r"([\d.]+ ?[kM]?) handovers", text)
    expect("1 group(s)" in text and handovers and handovers.group(1) != "0", f"no ray was handed from rank to rank:\n{text}")

    check_painting(skyquilt, project, folder)

    text = skyquilt.call("render", project, *asked, "-o", folder / "tiny", "--memory", "100kB", status=2)
    expect("--memory" in text and not list((folder / "tiny").glob("*.png")), f"too little memory is not explained:\n{text}")
    skyquilt.call("render", project, *asked, "-o", folder / "tiny", "--memory", "100kB", ranks=3, status=2, says=("--memory", "rank"))

    skyquilt.call("evaluate", project)
    expected = scores_of(project)
    expect(expected["psnr"] > 10.0, f"PSNR {expected['psnr']}")
    trust = expected["trust"]
    expect(0.3 < trust["rms_expected"] / trust["rms_found"] < 3.0 and trust["ause"] < trust["ause_by_opacity"], f"trust: {trust}")
    pictures = set(re.findall(r'images/[\w.-]+', (project / "report" / "index.html").read_text()))
    missing = [name for name in pictures if not (project / "report" / name).is_file()]
    expect(not missing and any(name.endswith("_trust.png") for name in pictures), f"the report lacks pictures: {missing} of {sorted(pictures)}")
    expect(all(image["psnr_expected"] > 5.0 for image in expected["images"]), "photos lack the PSNR to expect")
    expect(all(medians_of(expected, kind) == [] for kind in ("density", "head")), "normals of the field are scored without being asked for")
    field_normals = ("--set", "evaluate.field_normals=true")
    skyquilt.call("evaluate", project, "--restart", *field_normals)
    with_normals = scores_of(project)
    medians = medians_of(with_normals, "density")
    expect(medians and all(0.0 < median < 180.0 for median in medians), f"errors of the density's normals: {medians}")
    expect(medians_of(with_normals, "head") == [], "normals are predicted without a head")
    expect(without_normals(with_normals) == without_normals(expected), "scoring the field's normals changes other scores")
    expected = with_normals
    resume_evaluation(skyquilt, project, field_normals, expected)
    for ranks in (2, 4):
        shutil.rmtree(project / "report")
        skyquilt.call("evaluate", project, "--restart", *field_normals, ranks=ranks)
        expect(scores_of(project) == expected, f"{ranks} ranks give other scores: {scores_of(project)['psnr']} dB, alone {expected['psnr']} dB")
        expect(metrics_of(project)["rendering"]["ranks"] == ranks - 1, "the report does not say who rendered")
        expect(metrics_of(project)["rendering"]["bytes_received"] > 0, "the report does not count the bytes received")

    hard = folder / "hard"
    shutil.copytree(project, hard)
    skyquilt.call("merge", hard, "--restart", "--set", "merge.borders=hard")
    skyquilt.call("render", hard, *asked, "-o", folder / "hard_alone")
    expect(pictures_of(folder / "hard_alone") != alone, "hard borders change nothing")
    skyquilt.call("render", hard, *asked, "-o", folder / "hard_shared", "--memory", little, ranks=3)
    expect(pictures_of(folder / "hard_shared") == pictures_of(folder / "hard_alone"), "ranks that hold parts of a scene with hard borders render other images")

    process = skyquilt.start("render", project, "--test", "--width", "1600", "-o", folder / "stopped")
    wait_for(lambda: list((folder / "stopped").glob("*.png")), "first picture", process)
    process.send_signal(signal.SIGTERM)
    text, _ = process.communicate(timeout=120)
    expect(process.returncode == 130, f"a stopped rendering ends with {process.returncode}:\n{text}")

    broken = folder / "broken"
    shutil.copytree(project, broken)
    scene = bytearray((broken / "scene.h5").read_bytes())
    scene[len(scene) // 2] ^= 1
    (broken / "scene.h5").write_bytes(scene)
    skyquilt.call("render", broken, *asked, ranks=3, status=3, says=("scene.h5", "damaged"))


main(test)
