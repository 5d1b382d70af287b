"""Cameras and where they stand."""
from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from . import _skyquilt
from .errors import UsageError


@dataclasses.dataclass(frozen=True)
class Camera:
    """A lens and an image size, with COLMAP's models and parameters (docs/coordinates.md lists them).

    model: "SIMPLE_PINHOLE" (f, cx, cy), "PINHOLE" (fx, fy, cx, cy), "OPENCV" (fx, fy, cx, cy, k1, k2, p1, p2), ...
    width, height, and the lengths among the parameters: pixels, counted from the image's corner (first pixel's centre: 0.5, 0.5).
    """

    model: str
    width: int
    height: int
    params: tuple[float, ...]

    @staticmethod
    def pinhole(width: int, height: int, fov: float = 60.0) -> Camera:
        """Without distortion, with square pixels and the principal point in the middle. fov: degrees across the width, between 0 and 180."""
        if not (width > 0 and height > 0 and 0.0 < fov < 180.0):
            raise UsageError(f"a picture of {width} x {height} pixels with a field of view of {fov} degrees: sizes must be positive, and the field of "
                             "view between 0 and 180")
        model, params = _skyquilt.pinhole(int(width), int(height), float(fov))
        return Camera(model, int(width), int(height), tuple(params))

    @property
    def matrix(self) -> npt.NDArray[np.float64]:
        """(3, 3): pixels from camera coordinates, without distortion."""
        one_focal = self.model in ("SIMPLE_PINHOLE", "SIMPLE_RADIAL", "RADIAL", "SIMPLE_RADIAL_FISHEYE", "RADIAL_FISHEYE")
        fx, fy = (self.params[0], self.params[0]) if one_focal else self.params[:2]
        cx, cy = self.params[1:3] if one_focal else self.params[2:4]
        return np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])


@dataclasses.dataclass(frozen=True)
class View:
    """A camera at a place.

    rotation_wxyz, translation_m: cam_from_enu as unit quaternion and metres, x_cam = R x_enu + t; the camera looks along +z, y is down.
    """

    name: str
    camera: Camera
    rotation_wxyz: tuple[float, float, float, float]
    translation_m: tuple[float, float, float]

    @staticmethod
    def looking_at(eye: Sequence[float], target: Sequence[float], camera: Camera, name: str = "view") -> View:
        """From `eye` to `target` (ENU, metres) with a level horizon; straight up or down, north is up in the picture."""
        eye3, target3 = ([float(x) for x in place] for place in (eye, target))
        if len(eye3) != 3 or len(target3) != 3 or not np.isfinite(eye3 + target3).all() or eye3 == target3:
            raise UsageError(f"eye {eye3} and target {target3} must be two different places of three numbers each")
        rotation, translation = _skyquilt.look_at(eye3, target3)
        return View(name, camera, tuple(rotation), tuple(translation))

    @staticmethod
    def from_matrix(cam_from_enu: npt.ArrayLike, camera: Camera, name: str = "view") -> View:
        """Of a rigid transform, (3, 4) or (4, 4), metres."""
        matrix = np.asarray(cam_from_enu, dtype=np.float64)
        if matrix.shape not in ((3, 4), (4, 4)):
            raise UsageError(f"cam_from_enu has the shape {matrix.shape}: it must be (3, 4) or (4, 4)")
        rotation = matrix[:3, :3]
        if not np.isfinite(matrix).all() or abs(np.linalg.det(rotation) - 1.0) > 1e-6 or not np.allclose(rotation @ rotation.T, np.eye(3), atol=1e-6):
            raise UsageError("cam_from_enu does not begin with a rotation: its rows must have length 1 and right angles, its determinant must be 1")
        return View(name, camera, _quaternion_of(rotation), tuple(float(x) for x in matrix[:3, 3]))

    @property
    def cam_from_enu(self) -> npt.NDArray[np.float64]:
        """(4, 4), metres."""
        return matrices_of(np.array([self.rotation_wxyz]), np.array([self.translation_m]))[0]

    @property
    def center(self) -> npt.NDArray[np.float64]:
        """(3,): the camera's place in ENU, metres."""
        matrix = self.cam_from_enu
        return -matrix[:3, :3].T @ matrix[:3, 3]

    def _tuple(self) -> tuple:
        return (self.name, self.camera.model, self.camera.width, self.camera.height, list(self.camera.params), list(self.rotation_wxyz),
                list(self.translation_m))

    @staticmethod
    def _of_tuple(parts: tuple) -> View:
        name, model, width, height, params, rotation, translation = parts
        return View(name, Camera(model, width, height, tuple(params)), tuple(rotation), tuple(translation))


def matrices_of(rotation_wxyz: npt.NDArray[np.float64], translation_m: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """(N, 4, 4) of N unit quaternions and translations."""
    w, x, y, z = rotation_wxyz.T
    matrices = np.zeros((len(rotation_wxyz), 4, 4))
    matrices[:, 0, :3] = np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)], axis=1)
    matrices[:, 1, :3] = np.stack([2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)], axis=1)
    matrices[:, 2, :3] = np.stack([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)], axis=1)
    matrices[:, :3, 3] = translation_m
    matrices[:, 3, 3] = 1.0
    return matrices


def _quaternion_of(rotation: npt.NDArray[np.float64]) -> tuple[float, float, float, float]:
    """w, x, y, z by the largest of the four, which is exact to rounding for every rotation (Shepperd 1978)."""
    m = rotation
    squares = np.array([1 + m[0, 0] + m[1, 1] + m[2, 2], 1 + m[0, 0] - m[1, 1] - m[2, 2], 1 - m[0, 0] + m[1, 1] - m[2, 2],
                        1 - m[0, 0] - m[1, 1] + m[2, 2]])
    products = {0: (squares[0], m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]),
                1: (m[2, 1] - m[1, 2], squares[1], m[1, 0] + m[0, 1], m[0, 2] + m[2, 0]),
                2: (m[0, 2] - m[2, 0], m[1, 0] + m[0, 1], squares[2], m[2, 1] + m[1, 2]),
                3: (m[1, 0] - m[0, 1], m[0, 2] + m[2, 0], m[2, 1] + m[1, 2], squares[3])}
    quaternion = np.array(products[int(np.argmax(squares))])
    w, x, y, z = (float(q) for q in quaternion / np.linalg.norm(quaternion))
    return w, x, y, z
