"""A project folder: what was made of a survey."""
from __future__ import annotations

import csv
import functools
import json
import os
import pathlib
from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _skyquilt
from .errors import InputError
from .scene import Scene
from .survey import Survey
from .views import View

PathLike = str | os.PathLike[str]


class Project:
    """A folder that `skyquilt run` or its stages made; it is only read. docs/files.md says what the files hold, whose contents are returned as dicts.
    Unknown numbers are None there. What is asked for twice is read once: make another Project to see what changed.

    Raises InputError for a folder that is not a project, and later for what was not made yet, with the command that makes it.
    """

    def __init__(self, folder: PathLike):
        self.folder = pathlib.Path(_skyquilt.open_project(pathlib.Path(folder)))

    def __repr__(self) -> str:
        return f"<skyquilt.Project {str(self.folder)!r}>"

    def scene(self, *, threads: int = 0, memory_gb: float = 0.0) -> Scene:
        """Opens the scene, each time anew; arguments as of Scene."""
        return Scene(self._made("scene.h5", "merge"), threads=threads, memory_gb=memory_gb)

    @functools.cached_property
    def survey(self) -> Survey:
        """Photos, poses, cameras, sparse points."""
        return Survey(self.folder / "survey")

    @functools.cached_property
    def blocks(self) -> dict[str, Any]:
        """blocks.geojson: a FeatureCollection, polygons in longitude and latitude (of a local frame in metres), each block's figures as properties."""
        return self._json("blocks.geojson", "partition")

    @functools.cached_property
    def cameras(self) -> dict[str, Any]:
        """cameras.geojson: a FeatureCollection of points, the photos' places."""
        return self._json("survey/cameras.geojson", "prepare")

    @functools.cached_property
    def training(self) -> dict[str, Any]:
        """train.json: how each field was trained."""
        return self._json("train.json", "train")

    @functools.cached_property
    def metrics(self) -> dict[str, Any]:
        """report/metrics.json: the scores."""
        return self._json("report/metrics.json", "evaluate")

    @functools.cached_property
    def buildings(self) -> dict[str, Any]:
        """A FeatureCollection: footprints in longitude and latitude (of a local frame in metres), and the columns of buildings.csv as properties: every
        measure, and its standard deviation as NAME_sigma."""
        return json.loads(_skyquilt.building_features(self.folder))

    def training_curve(self, field: str = "context") -> dict[str, npt.NDArray[np.float64]]:
        """The columns of a field's training curve, "context" or "block_r0c0" and so on, also while it is being trained: step, seconds, loss, psnr, ..."""
        with self._made(f"checkpoints/{field}.log.csv", "train").open(newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        names = list(rows[0]) if rows else []
        return {name: np.array([float(row[name]) if row[name] else np.nan for row in rows]) for name in names}

    def views(self, photos: Sequence[str] = (), *, width: int = 0) -> list[View]:
        """Views of these photos (names with or without folder), or of all held-out ones. width: pixels; 0: the photos' own size. Raises UsageError for an
        unknown name, and when no photo is held out."""
        return [View._of_tuple(parts) for parts in _skyquilt.views_of_photos(self.folder / "survey", list(photos), int(width))]

    def _made(self, name: str, stage: str) -> pathlib.Path:
        file = self.folder / name
        if not file.is_file():
            raise InputError(f"{file}: no such file. Make it with skyquilt.{stage}({str(self.folder)!r}) or 'skyquilt {stage} {self.folder}'", file)
        return file

    def _json(self, name: str, stage: str) -> dict[str, Any]:
        file = self._made(name, stage)
        try:
            return json.loads(file.read_text(encoding="utf-8"))
        except ValueError as error:
            raise InputError(f"{file}: is not JSON: {error}. Make it again with 'skyquilt {stage} {self.folder} --restart'", file) from error


def open(path: PathLike, *, threads: int = 0, memory_gb: float = 0.0) -> Project | Scene:
    """A Project for a folder, a Scene for a scene file (.h5); threads and memory_gb are of the latter."""
    if pathlib.Path(path).suffix == ".h5":
        return Scene(path, threads=threads, memory_gb=memory_gb)
    return Project(path)
