"""Brightness from the command line: photos without tags, dark photos, rendering at any exposure, and what cannot be asked for."""
import json

from harness import SMALL, expect, main, metrics_of


def test(skyquilt, folder):
    photos, project = folder / "dark", folder / "out"
    # Four stops too dark, drifting, and no photo says so.
    skyquilt.call("simulate", "hamlet", "-o", photos, "--set", "simulate.exposure_offset_stops=-4", "--set", "simulate.exposure_drift_stops=1",
                  "--set", "simulate.exposure_tags=none")
    for wrong in ("exif,gian", "none,exif", ""):
        text = skyquilt.call("run", photos, "-o", folder / "never", *SMALL, "--brightness", wrong, status=2)
        expect("brightness.correction" in text, text)
    text = skyquilt.call("run", photos, "-o", project, *SMALL, "--brightness", "exif,vignette,luminance")
    expect("no photo has an exposure time" in text, f"nothing is said of missing tags:\n{text}")
    expect("treated as under-exposed" in text, f"the log does not mention that the photos are dark:\n{text}")

    gains = json.loads((project / "report" / "brightness.json").read_text())["photos"]
    trained = [photo["learned_stops"][1] for photo in gains if not photo["held_out"]]
    expect(len(gains) == metrics_of(project)["photos_registered"], "a gain per photo")
    expect(max(trained) - min(trained) > 0.5, f"a drift of +-1 stop left no trace: {trained}")
    expect(abs(sum(trained)) / len(trained) < 1e-3, "learned gains have no common factor")
    expect("<h2" in (project / "report" / "index.html").read_text().split("Brightness", 1)[1], "the report goes on after Brightness")
    metrics = metrics_of(project)
    for key in ("psnr_exif_gain", "psnr_right_half", "psnr_right_half_fitted", "exposure_seam"):
        expect(isinstance(metrics[key], float), f"{key} = {metrics[key]}")
    expect(metrics["psnr_normal"] is None, "nothing to compare normal brightness with")

    # The same view normal, two stops down, and as a dark photo recorded it.
    name = gains[0]["name"]
    sizes = []
    for exposure in ("normal", "-2", name):
        out = folder / ("view_" + exposure)
        skyquilt.call("render", project, "--photo", name, "--no-depth", "--exposure", exposure, "-o", out)
        sizes.append((out / (name.rsplit(".", 1)[0] + ".png")).stat().st_size)
    expect(len(set(sizes)) == 3, f"three exposures, equal pictures: {sizes}")
    for wrong in ("IMG_9999.jpg", "nan", "40"):
        text = skyquilt.call("render", project, "--photo", name, "--exposure", wrong, "-o", folder / "view_wrong", status=2)
        expect(wrong in text, text)

    # Against normally exposed photos of the same places; a folder without them is bad input.
    skyquilt.call("evaluate", project, "--restart", "--set", f"evaluate.normal_photos={photos / 'images'}")
    expect(isinstance(metrics_of(project)["psnr_normal"], float), "normal brightness was not compared")
    skyquilt.call("evaluate", project, "--restart", "--set", f"evaluate.normal_photos={folder}", status=3)


if __name__ == "__main__":
    main(test)
