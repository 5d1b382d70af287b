"""The stages from photos to report, as the commands of the same names.

All functions below take these keyword arguments:

config: a TOML file, or a preset: "fast", "default", "quality", "level".
restart: remove the results of this stage and of all later ones first.
progress: called as progress(label, share) some times a second while a part of the work with a known length goes on, share from 0 to 1, from another
    thread, one call at a time. What it raises ends the work as Ctrl-C does, and comes out of the function. With it no bar is drawn.
quiet, verbose: only warnings and errors on standard error and in the project's log.txt; more than usual.
Options: each section of options as a dict, train={"levels": 10}, partition={"blocks": "2x2"} (`skyquilt info --defaults` prints them all), and the flags
    of the command by name, steps=3000, time_budget="10min", image_width=800, threads=4, with _ for -. Flags win over sections, these over config.

A stage whose results are up to date does nothing, and one that was interrupted continues. One stage at a time works in a process; log lines and
progress of one project do not mix with another's. Raises UsageError (wrong options, or results that were made with others), InputError, BlockError, and
KeyboardInterrupt after Ctrl-C: what was made is saved, and the same call continues. Several ranks and tours are for the program.
"""
from __future__ import annotations

import os
import pathlib
from collections.abc import Callable, Sequence
from typing import Any

from . import _skyquilt
from ._options import overrides
from .errors import UsageError
from .project import Project

PathLike = str | os.PathLike[str]
Photos = PathLike | Sequence[PathLike]
Progress = Callable[[str, float], object]


def _call(stage: str, folder: PathLike, photos: Photos | None, model: PathLike | None, config: PathLike | None, restart: bool, quiet: bool,
          verbose: bool, progress: Progress | None, options: dict[str, Any]) -> None:
    if progress is not None and not callable(progress):
        raise UsageError(f"progress must be a function of a label and a share, not {type(progress).__name__}")
    inputs = [] if photos is None else [photos] if isinstance(photos, (str, os.PathLike)) else photos
    photos_ = [os.fspath(path) for path in inputs]
    model_, config_ = ("" if path is None else os.fspath(path) for path in (model, config))
    _skyquilt.call_stage(stage, os.fspath(folder), photos_, model_, config_, overrides(stage, options), bool(restart), bool(quiet), bool(verbose), progress)


def run(photos: Photos | None, out: PathLike, *, place: str | None = None, model: PathLike | None = None, config: PathLike | None = None,
        restart: bool = False, quiet: bool = False, verbose: bool = False, progress: Progress | None = None, **options: Any) -> Project:
    """All stages, from photos to scene, map products and report, into the project folder `out`; with photos=None of the simulated `place`.
    photos: a folder of photos or of videos, or a list of several folders (flights, zones) or of video files.
    model: the photos' camera model; without it COLMAP is run. Flags: within, time_budget, steps, blocks, image_width, holdout, ... (`skyquilt run`)."""
    if (photos is None) == (place is None):
        raise UsageError("skyquilt.run needs either a folder with photos or place='NAME', not both")
    if place is not None:
        options["simulate"] = {**options.get("simulate", {}), "place": place}
    _call("run", out, photos, model, config, restart, quiet, verbose, progress, options)
    return Project(out)


def simulate(place: str, out: PathLike, *, config: PathLike | None = None, restart: bool = False, quiet: bool = False, verbose: bool = False,
             progress: Progress | None = None, **options: Any) -> pathlib.Path:
    """A simulated survey with ground truth in the folder `out`, which is returned. place: "hamlet", "town", "smallcity", ... Flags: seed, image_width,
    altitudes, flight."""
    options["simulate"] = {**options.get("simulate", {}), "place": place}
    _call("simulate", out, None, None, config, restart, quiet, verbose, progress, options)
    return pathlib.Path(out)


def prepare(photos: Photos, out: PathLike, *, model: PathLike | None = None, config: PathLike | None = None, restart: bool = False,
            quiet: bool = False, verbose: bool = False, progress: Progress | None = None, **options: Any) -> Project:
    """A geo-referenced survey of photos, in the project folder `out`. photos: as for `run`. Flags: gcp, check_points, up, scale_bars (a list), holdout,
    masks."""
    _call("prepare", out, photos, model, config, restart, quiet, verbose, progress, options)
    return Project(out)


def _continue(stage: str, project: Project | PathLike, config: PathLike | None, restart: bool, quiet: bool, verbose: bool, progress: Progress | None,
              options: dict[str, Any]) -> Project:
    folder = project.folder if isinstance(project, Project) else project
    _call(stage, folder, None, None, config, restart, quiet, verbose, progress, options)
    return Project(folder)


def partition(project: Project | PathLike, *, config: PathLike | None = None, restart: bool = False, quiet: bool = False, verbose: bool = False,
              progress: Progress | None = None, **options: Any) -> Project:
    """Divides the surveyed ground into blocks. Flags: blocks ("2x2", "size:120", "auto"), altitudes, image_width, time_budget."""
    return _continue("partition", project, config, restart, quiet, verbose, progress, options)


def train(project: Project | PathLike, *, config: PathLike | None = None, restart: bool = False, quiet: bool = False, verbose: bool = False,
          progress: Progress | None = None, **options: Any) -> Project:
    """Trains the context and every block. Flags: steps, time_budget, checkpoint_every, memory, seed, brightness."""
    return _continue("train", project, config, restart, quiet, verbose, progress, options)


def merge(project: Project | PathLike, *, config: PathLike | None = None, restart: bool = False, quiet: bool = False, verbose: bool = False,
          progress: Progress | None = None, **options: Any) -> Project:
    """Makes one scene of all that was trained."""
    return _continue("merge", project, config, restart, quiet, verbose, progress, options)


def products(project: Project | PathLike, *, config: PathLike | None = None, restart: bool = False, quiet: bool = False, verbose: bool = False,
             progress: Progress | None = None, **options: Any) -> Project:
    """Orthophoto, surface model, elevations and video, as chosen in products={...} (`skyquilt render out`). Flags: exposure, resolution, boundary,
    memory."""
    return _continue("products", project, config, restart, quiet, verbose, progress, options)


def surface(project: Project | PathLike, *, config: PathLike | None = None, restart: bool = False, quiet: bool = False, verbose: bool = False,
            progress: Progress | None = None, **options: Any) -> Project:
    """Mesh, point cloud, 3D tiles and terrain, as chosen in surface={...}. Flags: boundary, memory."""
    return _continue("surface", project, config, restart, quiet, verbose, progress, options)


def buildings(project: Project | PathLike, *, config: PathLike | None = None, restart: bool = False, quiet: bool = False, verbose: bool = False,
              progress: Progress | None = None, **options: Any) -> Project:
    """Finds and measures buildings in the surface. Flags: memory."""
    return _continue("buildings", project, config, restart, quiet, verbose, progress, options)


def evaluate(project: Project | PathLike, *, config: PathLike | None = None, restart: bool = False, quiet: bool = False, verbose: bool = False,
             progress: Progress | None = None, **options: Any) -> Project:
    """Scores the scene on held-out photos, and writes the report. Flags: memory."""
    return _continue("evaluate", project, config, restart, quiet, verbose, progress, options)
