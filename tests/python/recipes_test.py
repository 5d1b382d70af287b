"""Runs every recipe of docs/python.md, in the folder that the page describes."""
import os
import pathlib
import re
import subprocess
import sys
import unittest

from support import PRELOADED, PROGRAM, SOURCE, TINY, InFolder, harness, scene_project

import skyquilt

try:
    import matplotlib
except ImportError:
    matplotlib = None

# Recipe, by its heading: what it must leave behind or print.
EXPECTED = {
    "A render": (["view.png", "depth.png", "normals.png"], ""),
    "A flight path": ([f"view_{i:05d}.png" for i in range(5)], ""),
    "Heights along a line in UTM": ([], r"EPSG: 326\d\d  heights: .*\n(\d+\.\d\d \d+\.\d\d -?[\dna.]+\n){5}"),
    "Comparing two scenes": ([], r"(IMG_\d+: PSNR \d+\.\d\d dB, SSIM -?\d\.\d+, FLIP \d\.\d+\n)+"),
    "Training with a callback and a plot": (["training.png", "mine/train.json"], r": 100 %\n"),
}


def other_scene():
    """The same survey, trained with other random numbers."""

    def make(folder):
        harness.prepare_small(PROGRAM, harness.small_survey(PROGRAM), folder)
        PROGRAM.call("train", folder, *TINY, "--seed", 9)
        PROGRAM.call("merge", folder)

    return harness.shared(PROGRAM, "python_other", make)


class Recipes(InFolder):
    def test_all_of_the_page(self):
        page = (SOURCE / "docs" / "python.md").read_text()
        recipes = dict(re.findall(r"## ([^\n]+)\n(?:(?!\n## ).)*?```python\n(.*?)```", page, re.DOTALL))
        self.assertEqual(list(recipes), list(EXPECTED))
        for name, source in (("out", scene_project()), ("other", other_scene()), ("photos", harness.small_survey(PROGRAM))):
            (self.folder / name).symlink_to(source)
        # matplotlib takes seconds to look for fonts, once.
        environment = dict(os.environ, MPLBACKEND="Agg", MPLCONFIGDIR=os.path.join(os.environ["SKYQUILT_TEST_SHARED"], "matplotlib"), LD_PRELOAD=PRELOADED,
                           PYTHONPATH=str(pathlib.Path(skyquilt.__file__).resolve().parents[1]))
        for heading, code in recipes.items():
            if matplotlib is None and "matplotlib" in code:
                print(f"'{heading}' was not run: matplotlib is not installed")
                continue
            with self.subTest(heading):
                files, says = EXPECTED[heading]
                done = subprocess.run([sys.executable, "-c", code], cwd=self.folder, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                      text=True, timeout=600)
                self.assertEqual(done.returncode, 0, done.stdout)
                if says:
                    self.assertRegex(done.stdout, says)
                for file in files:
                    self.assertGreater((self.folder / file).stat().st_size, 100, file)


if __name__ == "__main__":
    sys.exit(unittest.main())
