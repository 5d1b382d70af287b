#!/usr/bin/env python3
"""SSIM of two pictures in the ways that are in use: figures of different programs cannot be compared without knowing by how much these differ.

  /usr/bin/python3 scripts/compare_ssim.py                        the pictures of tests/core/metrics/ssim_test.cpp
  /usr/bin/python3 scripts/compare_ssim.py photo.png              a picture and itself at half its size, enlarged again: sharp and blurred
  /usr/bin/python3 scripts/compare_ssim.py photo.png render.png   two pictures of one size

Needs NumPy and scikit-image (Debian: apt-get install python3-skimage), whose own function gives the rows of its name. torchmetrics is no package of Debian:
its row is its formula, written anew after the source of structural_similarity_index_measure (github.com/Lightning-AI/torchmetrics, commit 000fc920: Gaussian
window 11, sigma 1.5, pictures reflected at their borders, all pixels count). So is that of Mega-NeRF (mega_nerf/metrics.py, after tf.image.ssim: zeros beyond
the borders, all pixels count). Nothing of the build or the tests needs this script.
"""
import argparse
import sys

try:
    import numpy as np
    from skimage import __version__ as skimage_version
    from skimage import io
    from skimage.metrics import structural_similarity
except ImportError as error:
    sys.exit(f"{error}: install python3-skimage and run this with Debian's /usr/bin/python3")

C1, C2, HALF = 0.01**2, 0.03**2, 5


def made_pictures():
    """Stripes and grain, and the same blurred with other grain: whole numbers, so that C++ makes the same."""
    width, height = 64, 48

    def picture(seed, blurred):
        state = seed
        pixels = np.zeros((height, width, 3), np.uint8)
        for y in range(height):
            for x in range(width):
                for c in range(3):
                    state = (state * 1664525 + 1013904223) % 2**32
                    wave = abs((x + 2 * y + 5 * c) % 32 - 16) + (0 if blurred else (x * y + 3 * c) % 7)
                    pixels[y, x, c] = 40 + 9 * wave + (state >> 28)
        return pixels

    return picture(1, False), picture(2, True)


def blurred(picture):
    """Means of 2 x 2 pixels, each four times; an odd row or column at the end is left out of both."""
    height, width = picture.shape[0] // 2 * 2, picture.shape[1] // 2 * 2
    sharp = picture[:height, :width]
    means = sharp.reshape(height // 2, 2, width // 2, 2, -1).mean((1, 3))
    return sharp, np.rint(means).astype(np.uint8).repeat(2, 0).repeat(2, 1)


def gaussian():
    weights = np.exp(-0.5 * (np.arange(-HALF, HALF + 1) / 1.5) ** 2)
    return weights / weights.sum()


def filtered(channel):
    """Weighted means over 11 x 11 windows; those that lie inside."""
    rows = np.apply_along_axis(np.convolve, 0, channel, gaussian(), "valid")
    return np.apply_along_axis(np.convolve, 1, rows, gaussian(), "valid")


def ssim(a, b, pad=None):
    """Mean over channels and pixels. pad: how numpy.pad continues the pictures; none: only windows inside count."""
    scores = []
    for c in range(a.shape[2]):
        x, y = (channel if pad is None else np.pad(channel, HALF, mode=pad) for channel in (a[..., c], b[..., c]))
        mx, my = filtered(x), filtered(y)
        vx, vy, vxy = filtered(x * x) - mx * mx, filtered(y * y) - my * my, filtered(x * y) - mx * my
        vx, vy = np.maximum(vx, 0.0), np.maximum(vy, 0.0)
        scores.append(((2 * mx * my + C1) * (2 * vxy + C2) / ((mx * mx + my * my + C1) * (vx + vy + C2))).mean())
    return float(np.mean(scores))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pictures", nargs="*", help="one or two pictures; none: made ones")
    files = parser.parse_args().pictures
    if len(files) > 2:
        parser.error("give no more than two pictures")
    given = [io.imread(file)[..., :3] for file in files]
    a, b = given if len(given) == 2 else blurred(given[0]) if given else made_pictures()
    if a.shape != b.shape or a.dtype != np.uint8 or b.dtype != np.uint8 or a.ndim != 3:
        parser.error("the pictures must have one size, three channels and 8 bits")
    a, b = a / 255.0, b / 255.0
    known = {"channel_axis": 2, "data_range": 1.0}
    wang = {"gaussian_weights": True, "sigma": 1.5, "use_sample_covariance": False}
    rows = [("Skyquilt: Gaussian 11, sigma 1.5, windows inside", ssim(a, b)),
            (f"scikit-image {skimage_version}, gaussian_weights, sigma 1.5, use_sample_covariance=False", structural_similarity(a, b, **known, **wang)),
            ("  the same with use_sample_covariance=True", structural_similarity(a, b, **known, **dict(wang, use_sample_covariance=True))),
            ("  its defaults: uniform 7 x 7, sample covariance", structural_similarity(a, b, **known)),
            ("torchmetrics (formula): Gaussian 11, reflected borders", ssim(a, b, "reflect")),
            ("Mega-NeRF, PlenOctrees (formula): Gaussian 11, zeros beyond borders", ssim(a, b, "constant"))]
    print(f"{a.shape[1]} x {a.shape[0]} pixels, data range 1, mean over channels")
    for name, value in rows:
        print(f"{value:.10f}  {value - rows[0][1]:+.6f}  {name}")


if __name__ == "__main__":
    main()
