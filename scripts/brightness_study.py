#!/usr/bin/env python3
"""Measures how well brightness correction works, on simulated surveys whose truth is known, and writes tables and images.

  scripts/brightness_study.py -o study
  scripts/brightness_study.py -o study --study exposure --steps 2000
  scripts/brightness_study.py -o study --skyquilt build/release/skyquilt --quick

Studies: exposure (drift, jumps, wrong tags, no tags), hidden (under- and over-exposed surveys), light (brighter, darker and moved sun), clouds
(drifting shadows of clouds, several seeds), classes (under- and over-exposed, by class of surface: with and without the concealing field, with plain loss,
with other target brightnesses).
Simulations and finished runs in the output folder are used again, so a stopped study resumes. Writes study_NAME.md, study_NAME.json and images.
Needs python3-numpy and python3-pil. Every run has the same number of steps, so other work on the machine changes only the time.
Exit status: 0 done, 1 skyquilt failed, 2 wrong usage or a missing module.
"""
import argparse
import json
import math
import os
import shutil
import subprocess
import sys
from pathlib import Path

try:
    import numpy as np
    from PIL import Image
except ImportError:
    sys.exit("brightness_study: needs numpy and PIL (apt-get install python3-numpy python3-pil)")

STEADY = {"exposure_drift_stops": 0, "exposure_jumps_stops": 0}
DRIFT = {"exposure_drift_stops": 1.5, "exposure_jumps_stops": 1.5}
ROUGH = {"exposure_drift_stops": 1.0, "exposure_jumps_stops": 1.0, "exposure_error_stops": 0.3, "color_drift_stops": 0.2, "vignetting": 0.4}
# The photos then have a mean display value of 0.40, as usual for cameras; it is the default of brightness.target_brightness.
NORMAL = {**STEADY, "exposure_offset_stops": -1.25}
UNDER = {**STEADY, "exposure_offset_stops": -5.4}
OVER = {**STEADY, "exposure_offset_stops": 1.08}


# As numbered in truth/classes: survey::SurfaceClass.
CLASSES = {"ground": 3, "vegetation": 11, "water": 8, "trees": 5}
MARSH = {"marsh": "true", "oblique": "false", "image_width": 320}
TARGETS = (0.2, 0.3, 0.4, 0.5, 0.6, 0.7)


def linear(display):
    """Linear light of display values (sRGB), both 0..1."""
    return np.where(display <= 0.04045, display / 12.92, ((display + 0.055) / 1.055) ** 2.4)


def display(light):
    light = np.clip(light, 0.0, 1.0)
    return np.where(light <= 0.0031308, light * 12.92, 1.055 * light ** (1.0 / 2.4) - 0.055)


def psnr(squared_errors):
    return -10.0 * math.log10(max(float(np.mean(squared_errors)), 1e-10)) if squared_errors.size else float("nan")


def one_gain(shown, truth):
    """`shown` times the one factor on linear light that brings it closest to `truth`; display values."""
    light, wanted = linear(shown), linear(truth)
    factors = np.exp(np.linspace(-3.0, 3.0, 241))
    errors = [float(np.mean((display(factor * light[::7]) - truth[::7]) ** 2)) for factor in factors]
    return display(factors[int(np.argmin(errors))] * light)


def settings(section, options):
    return [word for key, value in options.items() for word in ("--set", f"{section}.{key}={value}")]


class Study:
    def __init__(self, args):
        self.args = args
        self.out = Path(args.out).resolve()
        self.out.mkdir(parents=True, exist_ok=True)
        self.results = {}
        self.lines = []

    def call(self, *command):
        done = subprocess.run([self.args.skyquilt, *map(str, command)], capture_output=True, text=True, check=False)
        if done.returncode != 0:
            sys.exit(f"brightness_study: skyquilt {' '.join(map(str, command))}\n{done.stderr[-2000:]}")
        return done.stdout

    def simulate(self, name, place, options):
        folder = self.out / "sim" / name
        if not (folder / "simulate.json").exists():
            print(f"simulate {name}", flush=True)
            self.call("simulate", place, "-o", folder, "--quiet", *settings("simulate", options))
        return folder

    def run(self, name, survey, brightness, *extra, blocks="2x2"):
        """Trains and scores; returns metrics.json."""
        folder = self.out / "run" / name
        if not (folder / "report" / "metrics.json").exists():
            print(f"run {name}", flush=True)
            shutil.rmtree(folder, ignore_errors=True)
            self.call("run", survey, "-o", folder, "--blocks", blocks, "--steps", self.args.steps, "--quiet", "--brightness", brightness,
                      "--set", "products.video_seconds=0", "--set", "products.dsm=false", "--set", "products.ortho=false", *extra)
        metrics = json.loads((folder / "report" / "metrics.json").read_text())
        self.results[name] = {key: metrics[key] for key in
                              ("psnr", "ssim", "psnr_exif_gain", "psnr_right_half", "psnr_right_half_fitted", "psnr_normal", "ssim_normal",
                               "psnr_tiles", "psnr_tiles_gains", "psnr_tiles_shading", "psnr_normal_fitted",
                               "samples_per_second", "train_seconds")}
        return metrics

    def gain_error_stops(self, name, survey):
        """RMS error of the recovered gains over photos and colours, without the common factor: (training photos, held-out photos)."""
        truth = {p["name"]: np.log2(p["light_rgb"]) for p in json.loads((survey / "truth" / "exposure.json").read_text())["photos"]}
        found = json.loads((self.out / "run" / name / "report" / "brightness.json").read_text())["photos"]
        rows = {False: [], True: []}
        for photo in found:
            key = Path(photo["name"]).name
            rows[photo["held_out"]].append(photo["exif_stops"] + np.array(photo["learned_stops"]) - truth[key])
        trained, held_out = np.array(rows[False]), np.array(rows[True])
        middle = trained.mean(axis=0)
        rms = lambda e: float(np.sqrt(np.mean((e - middle) ** 2)))
        self.results[name]["gain_rms_stops"], self.results[name]["gain_rms_stops_held_out"] = rms(trained), rms(held_out)
        return rms(trained), rms(held_out)

    def title(self, text):
        self.lines += ["", f"### {text}", ""]

    def table(self, head, rows):
        self.lines += ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
        self.lines += ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows]

    # Images of one held-out view, side by side.
    def panel(self, file, pictures, width=480):
        tiles = []
        for picture in pictures:
            image = Image.open(picture).convert("RGB")
            tiles.append(image.resize((width, round(image.height * width / image.width)), Image.LANCZOS))
        sheet = Image.new("RGB", (sum(t.width for t in tiles) + 6 * (len(tiles) - 1), max(t.height for t in tiles)), "white")
        x = 0
        for tile in tiles:
            sheet.paste(tile, (x, 0))
            x += tile.width + 6
        sheet.save(self.out / file, quality=88)

    def view(self, name, photo, exposure="normal"):
        """Image of the scene from the pose of a photo."""
        folder = self.out / "view" / name / exposure.replace("/", "_")
        file = folder / (Path(photo).stem + ".png")
        if not file.exists():
            self.call("render", self.out / "run" / name, "--photo", photo, "--no-depth", "--exposure", exposure, "-o", folder, "--quiet")
        return file

    def exposure(self):
        fixed = self.simulate("fixed", "tidalflat", STEADY)
        drift = self.simulate("drift", "tidalflat", DRIFT)
        untagged = self.simulate("untagged", "tidalflat", {**DRIFT, "exposure_tags": "none"})
        half = self.simulate("half", "tidalflat", {**DRIFT, "exposure_tags": "half"})
        rough = self.simulate("rough", "tidalflat", ROUGH)
        self.title("Exposure")
        rows = []
        for what, name, survey, brightness in [
            ("fixed exposure", "fixed", fixed, "exif"), ("", "fixed_all", fixed, "exif,gain,vignette"),
            ("drift and jumps, tags right", "drift_none", drift, "none"), ("", "drift_exif", drift, "exif"), ("", "drift_gain", drift, "gain"),
            ("", "drift_exif_gain", drift, "exif,gain"), ("", "drift_all", drift, "exif,gain,vignette"),
            ("the same, every second photo without tags", "half_exif", half, "exif"),
            ("the same, no photo with tags", "untagged_none", untagged, "none"), ("", "untagged_exif", untagged, "exif"),
            ("tags off by 0.3 stops, white balance +-0.2, corners -40 %", "rough_none", rough, "none"), ("", "rough_exif", rough, "exif"),
            ("", "rough_exif_gain", rough, "exif,gain"), ("", "rough_all", rough, "exif,gain,vignette"),
        ]:
            m = self.run(name, survey, brightness)
            trained, held_out = self.gain_error_stops(name, survey)
            rows.append([what, brightness, f"{m['psnr']:.2f}", f"{m['psnr_exif_gain']:.2f}",
                         f"{m['psnr_right_half']:.2f} / {m['psnr_right_half_fitted']:.2f}", f"{trained:.3f}", f"{held_out:.3f}"])
        self.table(["survey", "brightness", "held-out PSNR (dB)", "with the EXIF gain alone", "right half / fitted on the left", "gain error (stops RMS)",
                    "held-out gains"], rows)
        extreme = max(json.loads((drift / "truth" / "exposure.json").read_text())["photos"][::8], key=lambda p: abs(math.log2(p["gain"])))["name"]
        self.panel("exposure.jpg", [drift / "images" / extreme, self.view("drift_none", extreme), self.view("drift_all", extreme),
                                    fixed / "images" / extreme])

    def equalised(self, survey, name):
        """The same survey with every photo's histogram equalised, as is sometimes done before photogrammetry."""
        folder = self.out / "sim" / name
        if (folder / "simulate.json").exists():
            return folder
        shutil.copytree(survey, folder, dirs_exist_ok=True)
        for file in sorted((folder / "images").glob("*.jpg")):
            with Image.open(file) as image:
                exif, rgb = image.info.get("exif"), np.asarray(image.convert("YCbCr")).copy()
            luma = rgb[..., 0]
            share = np.cumsum(np.bincount(luma.ravel(), minlength=256)) / luma.size
            rgb[..., 0] = np.round(255 * share[luma]).astype(np.uint8)
            Image.fromarray(rgb, "YCbCr").convert("RGB").save(file, quality=95, exif=exif)
        return folder

    def hidden(self):
        truth = self.simulate("normal", "tidalflat", NORMAL) / "images"
        rows = []
        for kind, options in [("under", UNDER), ("over", OVER)]:
            survey = self.simulate(kind, "tidalflat", options)
            equal = self.equalised(survey, kind + "_equalised")
            offset = options["exposure_offset_stops"] - NORMAL["exposure_offset_stops"]
            normal = ["--set", f"evaluate.normal_photos={truth}"]
            forms = [("no correction", "none", survey, "none", []), ("histogram equalisation", "equalised", equal, "none", []),
                     ("EXIF gain", "exif", survey, "exif", []),
                     ("EXIF gain, brightened by the true offset", "raised", survey, "exif", ["--set", f"evaluate.normal_stops={-offset}"]),
                     ("luminance, patches, gain", "luminance", survey, "exif,luminance", []),
                     ("luminance, random batch, gain", "luminance_batch", survey, "exif,luminance", ["--set", "brightness.luminance_neighbours=batch"]),
                     ("luminance, patches, product (eq. 13)", "luminance_product", survey, "exif,luminance",
                      ["--set", "brightness.luminance_form=product"])]
            for what, name, photos, brightness, extra in forms:
                m = self.run(f"{kind}_{name}", photos, brightness, *normal, *extra)
                rows.append([f"{kind}-exposed", what, f"{m['psnr_normal']:.2f}", f"{m['ssim_normal']:.3f}", f"{m['psnr']:.2f}"])
            photo = sorted(p.name for p in (survey / "images").glob("*.jpg"))[8]
            self.panel(f"hidden_{kind}.jpg", [survey / "images" / photo, self.view(f"{kind}_equalised", photo), self.view(f"{kind}_luminance", photo),
                                              truth / photo])
        self.title("Concealing field")
        self.table(["survey", "method", "PSNR against the normal photo (dB)", "SSIM", "PSNR against the photo as taken"], rows)

    def views_of(self, name):
        """Images of the scene at normal brightness from the poses of all held-out photos."""
        folder = self.out / "view" / name / "held_out"
        if not list(folder.glob("*.png")):
            self.call("render", self.out / "run" / name, "--test", "--no-depth", "--exposure", "normal", "-o", folder, "--quiet")
        return sorted(folder.glob("*.png"))

    def by_class(self, name, truth, marsh):
        """Against photos at normal exposure, over all held-out photos: mean display value; PSNR of all and per class, as shown and after one gain."""
        shown, wanted, kinds = [], [], []
        for view in self.views_of(name):
            image = np.asarray(Image.open(view).convert("RGB"), dtype=np.float64) / 255.0
            photo = Image.open(truth / (view.stem + ".jpg")).convert("RGB").resize((image.shape[1], image.shape[0]), Image.BOX)
            kind = Image.open(marsh / "truth" / "classes" / (view.stem + ".png")).resize(photo.size, Image.NEAREST)
            shown.append(image.reshape(-1, 3))
            wanted.append(np.asarray(photo, dtype=np.float64).reshape(-1, 3) / 255.0)
            kinds.append(np.asarray(kind).ravel())
        shown, wanted, kinds = np.concatenate(shown), np.concatenate(wanted), np.concatenate(kinds)
        scores = {"mean": float(shown.mean())}
        for form, image in (("shown", shown), ("gain", one_gain(shown, wanted))):
            errors = (image - wanted) ** 2
            scores[form] = {"all": psnr(errors), **{one: psnr(errors[kinds == number]) for one, number in CLASSES.items()}}
        self.results[name]["classes"] = scores
        return scores

    def classes(self):
        normal = self.simulate("marsh_normal", "tidalflat", {**NORMAL, **MARSH})
        truth = normal / "images"
        head = ["survey", "method", "mean shown", "all", *CLASSES, "after one gain: all", *CLASSES]
        rows = []
        for kind, options in [("under", UNDER), ("over", OVER)]:
            survey = self.simulate(f"marsh_{kind}", "tidalflat", {**options, **MARSH})
            target = lambda e: ["--set", f"brightness.target_brightness={e}"]
            forms = [("no luminance field", "none", "exif", []),
                     ("plain loss", "plain", "exif,luminance", ["--set", "brightness.luminance_loss=plain"]),
                     *[(f"field, e = {e}", f"e{e}", "exif,luminance", target(e)) for e in TARGETS]]
            for what, name, brightness, extra in forms:
                name = f"marsh_{kind}_{name}"
                if "luminance" in brightness:
                    extra = [*extra, "--set", f"brightness.luminance_mode={kind}"]
                self.run(name, survey, brightness, *extra)
                scores = self.by_class(name, truth, survey)
                rows.append([f"{kind}-exposed", what, f"{scores['mean']:.2f}",
                             *[f"{value:.2f}" for form in ("shown", "gain") for value in scores[form].values()]])
            photo = sorted(p.name for p in (survey / "images").glob("*.jpg"))[8]
            view = lambda name: self.out / "view" / f"marsh_{kind}_{name}" / "held_out" / (Path(photo).stem + ".png")
            self.panel(f"classes_{kind}.jpg", [survey / "images" / photo, view("none"), view("plain"), view("e0.4"), truth / photo], 320)
            self.panel(f"targets_{kind}.jpg", [view(f"e{e}") for e in TARGETS], 266)
        self.title("By class of surface")
        self.table(head, rows)

    def mixed(self, name, first, second):
        """The first half of the flight from one survey, the second half from another with the same poses and other light."""
        folder = self.out / "sim" / name
        if (folder / "simulate.json").exists():
            return folder
        shutil.copytree(first, folder, dirs_exist_ok=True)
        names = sorted(p.name for p in (second / "images").glob("*.jpg"))
        for photo in names[len(names) // 2:]:
            shutil.copy(second / "images" / photo, folder / "images" / photo)
        return folder

    def light(self):
        common = {**STEADY, "moving_cars": 0, "image_width": 480}
        day = self.simulate("day", "town", common)
        rows = []
        truth = ["--set", f"evaluate.normal_photos={day / 'images'}"]
        for factor in (1.0 / 3.0, 3.0):
            other = self.simulate(f"light_{factor:.2f}", "town", {**common, "light_intensity": factor})
            survey = self.mixed(f"mixed_light_{factor:.2f}", day, other)
            # Gains have zero mean, so normal brightness is halfway between the two lights.
            halfway = ["--set", f"evaluate.normal_stops={-0.5 * np.log2(factor):.3f}"]
            for brightness in ("exif", "exif,gain"):
                m = self.run(f"light_{factor:.2f}_{brightness.replace(',', '_')}", survey, brightness, *truth, *halfway)
                rows.append([f"second half of the flight: light x {factor:.2f}", brightness, f"{m['psnr']:.2f}", f"{m['psnr_right_half_fitted']:.2f}",
                             f"{m['psnr_normal']:.2f}"])
        for elevation in (10, 48, 90):
            other = self.simulate(f"sun_{elevation}", "town", {**common, "sun_elevation_deg": elevation})
            survey = self.mixed(f"mixed_sun_{elevation}", day, other)
            m = self.run(f"sun_{elevation}_exif_gain", survey, "exif,gain", *truth)
            rows.append([f"second half of the flight: sun at {elevation} degrees", "exif,gain", f"{m['psnr']:.2f}",
                         f"{m['psnr_right_half_fitted']:.2f}", f"{m['psnr_normal']:.2f}"])
        self.title("Light that changes during the flight")
        self.table(["survey (first half: light x 1, sun at 48 degrees)", "brightness", "held-out PSNR (dB)", "right half, gains fitted on the left",
                    "PSNR against photos of the first light"], rows)
        photo = sorted(p.name for p in (day / "images").glob("*.jpg"))[8]
        self.panel("light_sun.jpg", [self.out / "sim" / "sun_10" / "images" / photo, day / "images" / photo, self.view("sun_48_exif_gain", photo),
                                     self.view("sun_10_exif_gain", photo)])

    def clouds(self):
        clear = {**STEADY, "image_width": 360, "ortho_cell_m": 0.25}
        shadows = {**clear, "cloud_shadows": 1, "cloud_size_m": 80, "cloud_penumbra_m": 25, "cloud_speed_ms": 6, "cloud_cover": 0.45}
        corrections = {"off": "exif,gain,vignette", "on": "exif,gain,vignette,shading"}
        rows = []
        for seed in range(1, self.args.seeds + 1):
            found = {}
            for light, options in (("clear", clear), ("clouds", shadows)):
                survey = self.simulate(f"{self.args.place}_{light}_{seed}", self.args.place, {**options, "seed": seed})
                for which, brightness in corrections.items():
                    name = f"{self.args.place}_{light}_{which}_{seed}"
                    truth = ["--set", f"evaluate.normal_photos={survey / 'truth' / 'cloudless'}"] if light == "clouds" else []
                    m = self.run(name, survey, brightness, "--seed", seed, "--set", "surface.enabled=false", "--set", "products.ortho=true",
                                 "--set", "products.resolution_m=0.25", *truth, blocks="1x1")
                    found[light, which] = m
                    uneven = m["orthophoto"]["light_error_stops"]
                    self.results[name]["light_error_stops"] = uneven
                    normal = m["psnr_normal_fitted"]
                    rows.append([seed, light, which, f"{m['psnr']:.2f}", f"{m['psnr_tiles_gains']:.2f}", f"{m['psnr_tiles_shading']:.2f}",
                                 "" if normal is None else f"{normal:.2f}", f"{uneven:.3f}", f"{m['train_seconds']:.0f}"])
            best, lost, won = (found[key][score] for key, score in ((("clear", "off"), "psnr_tiles_gains"), (("clouds", "off"), "psnr_tiles_gains"),
                                                                     (("clouds", "on"), "psnr_tiles_shading")))
            rows[-1].append(f"{100 * (won - lost) / (best - lost):.0f} %")
        self.title("Moving light")
        self.table(["seed", "survey", "shading", "held-out PSNR (dB)", "tiles, gains fitted", "tiles, shading fitted", "against cloudless photos",
                    "orthophoto's uneven light (stops)", "training (s)", "regained"], [row + [""] * (10 - len(row)) for row in rows])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--out", required=True, help="folder for surveys, runs, tables and pictures")
    parser.add_argument("--skyquilt", default=shutil.which("skyquilt") or "build/release/skyquilt", help="the program")
    parser.add_argument("--study", choices=["exposure", "hidden", "light", "clouds", "classes", "all"], default="all")
    parser.add_argument("--steps", type=int, default=600, help="training steps of every block; the context has half as many")
    parser.add_argument("--seeds", type=int, default=3, help="of the study clouds")
    parser.add_argument("--place", default="hamlet", help="of the study clouds")
    parser.add_argument("--quick", action="store_true", help="only 60 steps: tests that everything runs, results mean nothing")
    args = parser.parse_args()
    if args.quick:
        args.steps = 60
    if not os.access(args.skyquilt, os.X_OK):
        sys.exit(f"brightness_study: {args.skyquilt} cannot be run: build it with scripts/demo.sh, or give --skyquilt")
    study = Study(args)
    for name in ["exposure", "hidden", "light", "clouds", "classes"] if args.study == "all" else [args.study]:
        getattr(study, name)()
    text = "\n".join(study.lines).strip() + "\n"
    (study.out / f"study_{args.study}.md").write_text(text)
    (study.out / f"study_{args.study}.json").write_text(json.dumps(study.results, indent=1) + "\n")
    print(text)


if __name__ == "__main__":
    main()
