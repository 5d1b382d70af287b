"""What the tests of the Python module share: a small scene, pictures of the program read without its code, and the program itself.

A test is called with the program as its only argument; the module is found by PYTHONPATH.
"""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

import numpy as np

# The run time of a sanitizer, which this process has by now; programs bring their own.
PRELOADED = os.environ.pop("LD_PRELOAD", "")

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "e2e"))
import harness  # noqa: E402  after the path above

PROGRAM = harness.Skyquilt(sys.argv.pop(1))
SOURCE = pathlib.Path(__file__).resolve().parents[2]
# Fields of some seconds each: these tests are about the module, not about image quality. A context that the blocks soon surpass.
TINY = ["--steps", "60", "--set", "train.batch_samples=4096", "--set", "context.batch_samples=4096", "--set", "context.steps=10"]


def scene_project():
    """A merged project of two blocks; only to be read."""

    def make(folder):
        harness.prepare_small(PROGRAM, harness.small_survey(PROGRAM), folder)
        PROGRAM.call("train", folder, *TINY)
        PROGRAM.call("merge", folder)

    return harness.shared(PROGRAM, "python_scene", make)


def pixels(file):
    """[row, column, channel] of a picture or map, as GDAL reads it, with the bits of the file."""
    kinds = {"1": np.uint8, "4": np.float32, "12": np.uint16}
    with tempfile.TemporaryDirectory() as folder:
        raw = pathlib.Path(folder) / "raw"
        subprocess.run(["gdal_translate", "-q", "-of", "ENVI", "-co", "INTERLEAVE=BIP", str(file), str(raw)], check=True, stderr=subprocess.DEVNULL)
        lines = (pathlib.Path(folder) / "raw.hdr").read_text().splitlines()
        header = {key.strip(): value.strip() for key, _, value in (line.partition("=") for line in lines)}
        return np.fromfile(raw, kinds[header["data type"]]).reshape(int(header["lines"]), int(header["samples"]), int(header["bands"]))


class InFolder(unittest.TestCase):
    """Each test has an empty folder of its own."""

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="skyquilt_python_"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
