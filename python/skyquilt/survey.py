"""A prepared survey: photos with their poses, cameras, sparse points."""
from __future__ import annotations

import dataclasses
import functools
import json
import os
import pathlib
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _skyquilt
from .errors import UsageError
from .views import Camera, View, matrices_of

Doubles = npt.NDArray[np.float64]


@dataclasses.dataclass(frozen=True)
class SparsePoints:
    """Views of one list of N points, which lives as long as one of the arrays.

    xyz: (N, 3) float64, ENU metres. rgb: (N, 3) uint8. error_px: (N,) float32, mean reprojection error in pixels of the full photos.
    track_length: (N,) int32, training photos that observed it; 0: not known.
    """

    xyz: Doubles
    rgb: npt.NDArray[np.uint8]
    error_px: npt.NDArray[np.float32]
    track_length: npt.NDArray[np.int32]

    def __len__(self) -> int:
        return len(self.xyz)


class Survey:
    """The photos are in the order of their names; all arrays below have one entry, or row, for each. Unknown numbers are NaN.

    names: paths below photo_root. camera: (N,) int32 into cameras. held_out: (N,) bool, kept from training for scores.
    rotation_wxyz, translation_m: (N, 4) and (N, 3), cam_from_enu: x_cam = R x_enu + t, metres.
    gps: (N, 3) as tagged: longitude, latitude in degrees, height in metres. gps_residual_m: (N,) distance to the corrected tag; gps_agrees: (N,) bool.
    agl_m: (N,) height above the sparse points below. time_s: (N,) since the first photo. exposure_time_s, f_number, iso: (N,) from EXIF.
    flight: (N,) int32. masks: absolute path or "" for each photo.
    origin: longitude, latitude, height of ENU's origin; without meaning unless georeferenced. height_reference: "ellipsoid", "egm96" or "unknown".
    points: SparsePoints.
    """

    def __init__(self, folder: str | os.PathLike[str]):
        self.folder = pathlib.Path(folder)
        loaded = _skyquilt.load_survey(self.folder)
        photos = loaded["photos"]
        self.photo_root = pathlib.Path(loaded["photo_root"])
        self.origin: tuple[float, float, float] = tuple(loaded["origin"])
        self.georeferenced: bool = loaded["georeferenced"]
        self.height_reference: str = loaded["height_reference"]
        self.cameras = [Camera(model, width, height, tuple(params)) for model, width, height, params in loaded["cameras"]]
        self.points = SparsePoints(**loaded["points"])
        self.names: list[str] = photos["names"]
        self.masks: list[str] = photos["masks"]
        self.camera: npt.NDArray[np.int32] = photos["camera"]
        self.flight: npt.NDArray[np.int32] = photos["flight"]
        self.held_out: npt.NDArray[np.bool_] = photos["held_out"]
        self.gps_agrees: npt.NDArray[np.bool_] = photos["gps_agrees"]
        self.rotation_wxyz: Doubles = photos["rotation_wxyz"]
        self.translation_m: Doubles = photos["translation_m"]
        self.gps: Doubles = photos["gps"]
        self.gps_residual_m: Doubles = photos["gps_residual_m"]
        self.agl_m: Doubles = photos["agl_m"]
        self.time_s: Doubles = photos["time_s"]
        self.exposure_time_s: Doubles = photos["exposure_time_s"]
        self.f_number: Doubles = photos["f_number"]
        self.iso: Doubles = photos["iso"]

    def __len__(self) -> int:
        return len(self.names)

    def __repr__(self) -> str:
        return f"<skyquilt.Survey {str(self.folder)!r}: {len(self)} photos, {len(self.points)} points>"

    @functools.cached_property
    def cam_from_enu(self) -> Doubles:
        """(N, 4, 4), metres."""
        return matrices_of(self.rotation_wxyz, self.translation_m)

    @functools.cached_property
    def centers(self) -> Doubles:
        """(N, 3): the cameras' places in ENU, metres."""
        return -np.einsum("nji,nj->ni", self.cam_from_enu[:, :3, :3], self.cam_from_enu[:, :3, 3])

    @functools.cached_property
    def document(self) -> dict[str, Any]:
        """survey.json: fit, accuracy, checks and problems too (docs/files.md)."""
        return json.loads((self.folder / "survey.json").read_text(encoding="utf-8"))

    def view(self, photo: int | str) -> View:
        """Of a photo by number or name, at its full size. `Project.views` gives smaller ones."""
        if isinstance(photo, str):
            if photo not in self.names:
                raise UsageError(f"no photo of this survey is called '{photo}'")
            photo = self.names.index(photo)
        return View(pathlib.PurePosixPath(self.names[photo]).stem, self.cameras[self.camera[photo]], tuple(self.rotation_wxyz[photo].tolist()),
                    tuple(self.translation_m[photo].tolist()))
