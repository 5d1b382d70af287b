"""Skyquilt: drone photos to a geo-referenced radiance field, on CPUs.

This package asks and makes what the program `skyquilt` makes, by the same code; docs/python.md of the source has recipes.

    project = skyquilt.open("out")               # a Project: survey, blocks, metrics, buildings, scene
    scene = project.scene()                      # a Scene: render, cast, query, heights
    skyquilt.run("photos/", "out", steps=3000)   # the whole way, as `skyquilt run`

Conventions, everywhere:

- Frames. "enu": east, north, up in metres from the survey's origin, right-handed. "utm": easting, northing, height in metres, in the zone of the
  origin. "wgs84": longitude, latitude in degrees (in this order, as in GeoJSON) and height in metres. Heights are the survey's
  (`Scene.info["heights"]` says what they are above).
- Cameras. x right, y down, z forward; `cam_from_enu` maps ENU to the camera. Pixels: the image's corner is (0, 0) and the centre of its first pixel
  (0.5, 0.5). Arrays of pictures are [row, column], row 0 on top.
- Colours are display values (sRGB), 0 to 1 in float arrays. They may exceed 1 where photos were exposed darker than the rest.
- Arrays without a copy: those of a Picture, of a Survey's points and of an answer share memory with what was computed, and keep it alive.
- Long work runs without Python's global lock, on all cores. Ctrl-C ends it at its next safe point with KeyboardInterrupt; since cancelling concerns
  the whole process, work of other threads then ends with `Interrupted`.
- Errors: `UsageError` and `InputError` are ValueErrors, `BlockError` is a RuntimeError.
"""
from ._skyquilt import version as __version__
from .errors import BlockError, Error, InputError, Interrupted, UsageError
from .metrics import flip, flip_map, psnr, ssim, ssim_map
from .project import Project, open
from .scene import Picture, PointColors, Rays, Scene
from .stages import buildings, evaluate, merge, partition, prepare, products, run, simulate, surface, train
from .survey import SparsePoints, Survey
from .views import Camera, View

__all__ = [
    "BlockError", "Camera", "Error", "InputError", "Interrupted", "Picture", "PointColors", "Project", "Rays", "Scene", "SparsePoints", "Survey",
    "UsageError", "View", "__version__", "buildings", "evaluate", "flip", "flip_map", "merge", "open", "partition", "prepare", "products", "psnr",
    "run", "simulate", "ssim", "ssim_map", "surface", "train",
]
