"""How alike two pictures are. All functions take two arrays of one shape, (H, W) or (H, W, channels): float display values 0 to 1, or uint8, which are
divided by 255. mask: (H, W), False or 0 where a pixel does not count; None: all count. NaN when nothing counts. UsageError for other shapes."""
from __future__ import annotations

import numpy as np
import numpy.typing as npt

from . import _skyquilt
from .errors import UsageError

Floats = npt.NDArray[np.float32]


def psnr(a: npt.ArrayLike, b: npt.ArrayLike, mask: npt.ArrayLike | None = None) -> float:
    """Peak signal-to-noise ratio in dB with maximum 1; infinite for equal pictures."""
    return _skyquilt.psnr(*_pair(a, b, mask))


def ssim(a: npt.ArrayLike, b: npt.ArrayLike, mask: npt.ArrayLike | None = None) -> float:
    """Structural similarity (Wang et al. 2004), at most 1: Gaussian window of 11 x 11, averaged over channels, without a border of 5 pixels."""
    return _skyquilt.ssim(*_pair(a, b, mask))[0]


def ssim_map(a: npt.ArrayLike, b: npt.ArrayLike, mask: npt.ArrayLike | None = None) -> Floats:
    """(H, W) of the same; NaN where nothing was scored."""
    return _skyquilt.ssim(*_pair(a, b, mask))[1]


def flip(a: npt.ArrayLike, b: npt.ArrayLike, mask: npt.ArrayLike | None = None, *, threads: int = 0) -> float:
    """FLIP (Andersson et al. 2020): the difference that a person sees who flips between two colour pictures, 0 to 1; 67 pixels per degree."""
    return _skyquilt.flip(*_rgb_pair(a, b, mask), threads)[0]


def flip_map(a: npt.ArrayLike, b: npt.ArrayLike, mask: npt.ArrayLike | None = None, *, threads: int = 0) -> Floats:
    """(H, W) of the same; NaN where the mask ignores."""
    return _skyquilt.flip(*_rgb_pair(a, b, mask), threads)[1]


def _display(picture: npt.ArrayLike) -> Floats:
    array = np.asarray(picture)
    if array.dtype == np.uint8:
        return (array / 255.0).astype(np.float32)
    return np.ascontiguousarray(array, dtype=np.float32)


def _pair(a: npt.ArrayLike, b: npt.ArrayLike, mask: npt.ArrayLike | None) -> tuple[Floats, Floats, npt.NDArray[np.uint8] | None]:
    first, second = _display(a), _display(b)
    if first.shape != second.shape or first.ndim not in (2, 3) or 0 in first.shape:
        raise UsageError(f"pictures of the shapes {first.shape} and {second.shape}: both must be (H, W) or (H, W, channels), and the same")
    if mask is None:
        return first, second, None
    counts = np.asarray(mask)
    if counts.shape != first.shape[:2]:
        raise UsageError(f"a mask of the shape {counts.shape} for pictures of {first.shape}: it must be {first.shape[:2]}")
    return first, second, np.where(counts != 0, 255, 0).astype(np.uint8)


def _rgb_pair(a: npt.ArrayLike, b: npt.ArrayLike, mask: npt.ArrayLike | None) -> tuple[Floats, Floats, npt.NDArray[np.uint8] | None]:
    pair = _pair(a, b, mask)
    if pair[0].ndim != 3 or pair[0].shape[2] != 3:
        raise UsageError(f"FLIP compares colours: pictures must have the shape (H, W, 3), not {pair[0].shape}")
    return pair
