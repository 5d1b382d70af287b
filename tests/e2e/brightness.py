"""Brightness from the command line: photos without tags, dark photos, rendering at any exposure, and invalid requests."""
import json

from harness import SMALL, expect, main, metrics_of


def test(skyquilt, folder):
    photos, project = folder / "dark", folder / "out"
    # Four stops too dark, with drift, and no photo has exposure tags.
    skyquilt.call("simulate", "hamlet", "-o", photos, "--set", "simulate.exposure_offset_stops=-4", "--set", "simulate.exposure_drift_stops=1",
                  "--set", "simulate.exposure_tags=none")
    for wrong in ("exif,gian", "none,exif", ""):
        skyquilt.call("run", photos, "-o", folder / "never", *SMALL, "--brightness", wrong, status=2, says="brightness.correction")
    text = skyquilt.call("run", photos, "-o", project, *SMALL, "--brightness", "exif,vignette,luminance")
    expect("no photo has an exposure time" in text, f"no warning about missing tags:\n{text}")
    expect("treated as under-exposed" in text, f"no message about dark photos:\n{text}")

    gains = json.loads((project / "report" / "brightness.json").read_text())["photos"]
    trained = [photo["learned_stops"][1] for photo in gains if not photo["held_out"]]
    expect(len(gains) == metrics_of(project)["photos_registered"], "not one gain per photo")
    expect(max(trained) - min(trained) > 0.5, f"the learned gains do not follow a drift of +-1 stop: {trained}")
    expect(abs(sum(trained)) / len(trained) < 1e-3, "the mean of the learned gains is not 0")
    expect("<h2" in (project / "report" / "index.html").read_text().split("Brightness", 1)[1], "the report ends at Brightness")
    metrics = metrics_of(project)
    for key in ("psnr_exif_gain", "psnr_right_half", "psnr_right_half_fitted", "exposure_seam"):
        expect(isinstance(metrics[key], float), f"{key} = {metrics[key]}")
    expect(metrics["psnr_normal"] is None, "there is a score at normal brightness without photos to compare with")

    # The same view at normal exposure, two stops darker, and at the brightness of a dark photo.
    name = gains[0]["name"]
    sizes = []
    for exposure in ("normal", "-2", name):
        out = folder / ("view_" + exposure)
        skyquilt.call("render", project, "--photo", name, "--no-depth", "--exposure", exposure, "-o", out)
        sizes.append((out / (name.rsplit(".", 1)[0] + ".png")).stat().st_size)
    expect(len(set(sizes)) == 3, f"three exposures, equal pictures: {sizes}")
    for wrong in ("IMG_9999.jpg", "nan", "40"):
        skyquilt.call("render", project, "--photo", name, "--exposure", wrong, "-o", folder / "view_wrong", status=2, says=wrong)

    # Comparison with normally exposed photos. A folder without them is bad input.
    skyquilt.call("evaluate", project, "--restart", "--set", f"evaluate.normal_photos={photos / 'images'}")
    expect(isinstance(metrics_of(project)["psnr_normal"], float), "normal brightness was not compared")
    skyquilt.call("evaluate", project, "--restart", "--set", f"evaluate.normal_photos={folder}", status=3)


if __name__ == "__main__":
    main(test)
