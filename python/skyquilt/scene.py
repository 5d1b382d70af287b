"""Questions to a scene: pictures, rays, points and heights."""
from __future__ import annotations

import dataclasses
import json
import os
import pathlib
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple, overload

import numpy as np
import numpy.typing as npt

from . import _skyquilt
from .errors import UsageError
from .views import Camera, View

Floats = npt.NDArray[np.float32]
Doubles = npt.NDArray[np.float64]
PathLike = str | os.PathLike[str]


@dataclasses.dataclass(frozen=True)
class Rays:
    """What rays show, in the order in which they were asked. Each array is a view of the same memory, which lives as long as one of them.

    color: (N, 3) float32, display values; over black where `background` was false (premultiplied by opacity).
    opacity: (N,) float32, 0 to 1.
    depth: (N,) float32, metres along the ray to where half of the light has passed; NaN where the ray never becomes half opaque.
    depth_mean: mean distance by the weight of what is seen; NaN where nothing is.
    depth_front, depth_back: where 15 % and 85 % of the light have been stopped, the thickness of what looks like a surface.
    """

    color: Floats
    opacity: Floats
    depth: Floats
    depth_mean: Floats
    depth_front: Floats
    depth_back: Floats


@dataclasses.dataclass(frozen=True)
class Picture:
    """What a view shows. The arrays are [row, column], row 0 on top; the first six are views of the same memory, which lives as long as one of them.

    color: (H, W, 3) float32, display values over the scene's background; may exceed 1.
    opacity, depth, depth_mean, depth_front, depth_back: (H, W) float32 as in Rays; distances in metres along the ray of the pixel, not along the
    camera's axis.
    rgb8: (H, W, 3) uint8, color rounded as in the PNG that `skyquilt render` writes.
    normals: (H, W, 3) float32 unit vectors in ENU out of the surface, NaN where there is none; None unless asked for.
    view: the camera and its place.
    """

    color: Floats
    opacity: Floats
    depth: Floats
    depth_mean: Floats
    depth_front: Floats
    depth_back: Floats
    rgb8: npt.NDArray[np.uint8]
    normals: Floats | None
    view: View


class PointColors(NamedTuple):
    """density: (...) float32, optical depth per metre, 0 in free space. color: (..., 3) float32, display values at reference exposure, NaN where the
    density is 0. Both are NaN for points that are not finite."""

    density: Floats
    color: Floats


class Scene:
    """A scene file (scene.h5), open for questions until it is closed or forgotten. Several may be open, and several threads may ask one scene: it
    answers one at a time.

    threads: 0: every core that the process may use. memory_gb: limit for the fields in memory, of which others are loaded when needed; 0: half of the
    machine's memory. Raises InputError for a file that is not a scene or damaged, UsageError for wrong options.
    """

    def __init__(self, path: PathLike, *, threads: int = 0, memory_gb: float = 0.0):
        self.path = pathlib.Path(path)
        self._scene: _skyquilt.Scene | None = _skyquilt.Scene(self.path, int(threads), float(memory_gb))
        self.info: dict[str, Any] = self._scene.info()
        """origin (longitude, latitude, height), georeferenced, epsg (of "utm"; None without a place on Earth), heights (what they are above), min_enu and
        max_enu (around all blocks, metres), gsd_m (ground sampling distance of the finest block), footprint_min_m and footprint_max_m (widths of pixels
        that were trained; 0: points), normals (kinds that can be rendered), parameters, config (TOML text), blocks (list of dicts)."""

    def close(self) -> None:
        """Frees the memory of the fields. Arrays that were returned stay valid; later questions raise UsageError."""
        self._scene = None

    def __enter__(self) -> Scene:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<skyquilt.Scene {str(self.path)!r}{'' if self._scene else ', closed'}>"

    def __reduce__(self):
        raise TypeError("a Scene cannot be pickled or copied: it holds gigabytes of fields and running threads. Give other processes its path, and let "
                        f"them open it: skyquilt.Scene({str(self.path)!r})")

    def _open(self) -> _skyquilt.Scene:
        if self._scene is None:
            raise UsageError(f"this scene was closed: open it again with skyquilt.Scene({str(self.path)!r})")
        return self._scene

    def views(self, where: Any, width: int | None = None, height: int | None = None, fov: float = 60.0) -> list[View]:
        """The views that `render` renders, for those who want them one at a time. Arguments as in `render`."""
        if isinstance(where, View) or (isinstance(where, Sequence) and not isinstance(where, str) and len(where) > 0
                                       and all(isinstance(one, View) for one in where)):
            if width is not None or height is not None:
                raise UsageError("a View has its own camera: leave width and height out, or make its Camera with the size that you want")
            return [where] if isinstance(where, View) else list(where)
        columns = 960 if width is None else int(width)
        rows = max(2, columns * 9 // 16 // 2 * 2) if height is None else int(height)
        if isinstance(where, np.ndarray):
            camera = Camera.pinhole(columns, rows, fov)
            matrices = where[np.newaxis] if where.ndim == 2 else where
            return [View.from_matrix(matrix, camera, f"view_{i:05d}") for i, matrix in enumerate(matrices)]
        if isinstance(where, (str, os.PathLike)):
            file = pathlib.Path(where)
            try:
                text = file.read_text(encoding="utf-8")
            except FileNotFoundError as missing:
                raise UsageError(f"{file}: no such file with a camera path") from missing
        else:
            file = pathlib.Path("the path given")
            text = json.dumps(_with_fov(where, fov), default=_number)
        return [View._of_tuple(parts) for parts in self._open().path(text, file, columns, rows)]

    @overload
    def render(self, where: View, *, exposure: str | float = "normal", normals: str | None = None) -> Picture: ...

    @overload
    def render(self, where: list[View], *, exposure: str | float = "normal", normals: str | None = None) -> list[Picture]: ...

    @overload
    def render(self, where: PathLike, width: int | None = None, height: int | None = None, *, fov: float = 60.0, exposure: str | float = "normal",
               normals: str | None = None) -> list[Picture]: ...

    @overload
    def render(self, where: Any, width: int | None = None, height: int | None = None, *, fov: float = 60.0, exposure: str | float = "normal",
               normals: str | None = None) -> Any: ...

    def render(self, where: Any, width: int | None = None, height: int | None = None, *, fov: float = 60.0, exposure: str | float = "normal",
               normals: str | None = None) -> Any:
        """Renders a pose, which gives a Picture, or a path, which gives a list of them.

        where: one of
          - a View, or a list of Views;
          - a pose as in files of camera paths: {"position_enu": (x, y, z), "yaw": 0, "pitch": -30} or {"longitude": ..., "latitude": ...,
            "height": ..., ...}. Degrees: yaw clockwise from north, pitch 0 level and -90 straight down, roll with the right side down; "fov";
          - a list of such poses, or {"views": [...], "frames_between": n}, which flies along them, or the path of a JSON file with either;
          - cam_from_enu as array (3, 4) or (4, 4), or several as (N, 4, 4).
        width, height: pixels; default 960, and 16:9. Not for Views, which have their own. fov: degrees across the width, for poses without "fov".
        exposure: "normal", stops above it, or the name of a photo whose brightness to use. normals: "depth", "density" or "predicted"
        (`info["normals"]` says which the scene has); None: none.
        The pictures are those of `skyquilt render`, bit by bit. Raises UsageError, InputError, KeyboardInterrupt.
        """
        single = isinstance(where, View) or (isinstance(where, np.ndarray) and where.ndim == 2) or (isinstance(where, Mapping) and "views" not in where)
        pictures = [self._picture(view, exposure, normals) for view in self.views([where] if single and isinstance(where, Mapping) else where, width,
                                                                                   height, fov)]
        return pictures[0] if single else pictures

    def _picture(self, view: View, exposure: str | float, normals: str | None) -> Picture:
        arrays = self._open().render(view._tuple(), str(exposure), normals or "")
        return Picture(view=view, normals=arrays.pop("normals", None), **arrays)

    def cast(self, origins: npt.ArrayLike, directions: npt.ArrayLike, *, near_m: float = 0.0, far_m: float = 1e30, width_m: float = 0.0,
             pitch: float = 0.0, exposure: str | float = "normal", background: bool = False) -> Rays:
        """Casts rays. origins, directions: (N, 3), ENU, metres; directions of any length. Only [near_m, far_m] of each ray is rendered.
        width_m, pitch: what a ray stands for: a column of this width, or a cone that grows by `pitch` metres per metre (of a picture's pixel its angle in
        radians). background: where the fields are transparent, show what lies behind."""
        return Rays(**self._open().cast(_doubles(origins), _doubles(directions), float(near_m), float(far_m), float(width_m), float(pitch), str(exposure),
                                        bool(background)))

    def query(self, points: npt.ArrayLike, frame: str = "enu", *, directions: npt.ArrayLike = (0.0, 0.0, -1.0), footprint_m: float = 0.0,
              colors: bool = True) -> PointColors:
        """Density and colour at points, blended over blocks as in renderings: the sample that a ray would take there.

        points: (..., 3) in the frame "enu", "utm" or "wgs84" (longitude, latitude, height). directions: from the viewer to the point, in ENU, one (3,)
        for all or one for each point; colours depend on it. footprint_m: width of the pixel that a point stands for; 0: the finest that was trained.
        colors: False is faster, and color is NaN. Raises UsageError.
        """
        places = _doubles(points)
        if places.ndim < 1 or places.shape[-1] != 3:
            raise UsageError(f"points have the shape {places.shape}: it must be (..., 3)")
        ways = _doubles(directions)
        density, color = self._open().query(places.reshape(-1, 3), frame, ways.reshape(-1, ways.shape[-1] if ways.ndim else 1), float(footprint_m),
                                            bool(colors))
        return PointColors(density.reshape(places.shape[:-1]), color.reshape(places.shape))

    def heights(self, places: npt.ArrayLike, frame: str = "enu", *, width_m: float = 0.0) -> Doubles:
        """Heights of the surface seen from above, as in dsm.tif: (...) metres in the frame's heights, for places (..., 2): x, y in "enu"; easting,
        northing in "utm"; longitude, latitude in "wgs84". NaN where there is no surface and outside the blocks.
        width_m: of the column that is looked at; 0: the scene's ground sampling distance. In "enu" looks along the z axis, else along the vertical."""
        plan = _doubles(places)
        if plan.ndim < 1 or plan.shape[-1] != 2:
            raise UsageError(f"places have the shape {plan.shape}: it must be (..., 2)")
        return self._open().heights(plan.reshape(-1, 2), frame, float(width_m)).reshape(plan.shape[:-1])

    def to_enu(self, points: npt.ArrayLike, frame: str) -> Doubles:
        """(..., 3) in ENU of points (..., 3) in "utm" or "wgs84"; NaN for what is not on Earth."""
        return self._convert(points, frame, True)

    def from_enu(self, points: npt.ArrayLike, frame: str) -> Doubles:
        """(..., 3) in "utm" or "wgs84" of points (..., 3) in ENU."""
        return self._convert(points, frame, False)

    def _convert(self, points: npt.ArrayLike, frame: str, to_enu: bool) -> Doubles:
        places = _doubles(points)
        if places.ndim < 1 or places.shape[-1] != 3:
            raise UsageError(f"points have the shape {places.shape}: it must be (..., 3)")
        return self._open().convert(places.reshape(-1, 3), frame, to_enu).reshape(places.shape)


def _doubles(values: npt.ArrayLike) -> Doubles:
    try:
        return np.ascontiguousarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise UsageError(f"these are not numbers: {error}") from error


def _number(value: Any) -> Any:
    """For poses with numpy's numbers and arrays."""
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    raise UsageError(f"a pose cannot hold {value!r}")


def _with_fov(where: Any, fov: float) -> Any:
    """Poses as the reader of paths takes them; those without a field of view get this one."""
    if isinstance(where, Mapping):
        return {**where, "views": _with_fov(where.get("views"), fov)}
    if not isinstance(where, Sequence) or not all(isinstance(pose, Mapping) for pose in where):
        raise UsageError(f"a pose or a path is needed, not {type(where).__name__}: give a View, a dict with position_enu, yaw and pitch, a list of either, a "
                         "file, or cam_from_enu as array (help(skyquilt.Scene.render))")
    return [{"fov": fov, **pose} for pose in where]
