#!/usr/bin/env python3
"""Writes a transforms.json for a data set in the form of Mega-NeRF (Mill 19, UrbanScene3D), whose cameras are PyTorch files.

  scripts/convert_mega_nerf.py rubble-pixsfm
  skyquilt run rubble-pixsfm --model rubble-pixsfm/transforms.json -o out

Reads coordinates.pt and {train,val}/metadata/NAME.pt, and names the pictures {train,val}/rgbs/NAME.jpg (or .png), which stay where they are. Those of val
are held out. Needs PyTorch (pip install torch, or Debian's python3-torch). PyTorch's files may hold code that runs when they are read; here they are read
without it, which needs PyTorch 2.0 or later. With an older one (Debian 12 has 1.13) add --trust, if you trust where the files come from.

Conventions (Turki et al. 2022, github.com/cmusatyalab/mega-nerf, README.md and ray_utils.py): c2w is 3 x 4, from the camera (right, up, backwards) to a world
of axes down, right, backwards, in units of pose_scale_factor metres about origin_drb. Pixels are looked at through their middle, and cx and cy count from
the picture's corner. Written are metres about origin_drb with x right, y forwards (what Mega-NeRF calls backwards, reversed) and z up.
Exit status: 0 done, 2 wrong usage or a missing module, 3 a file is missing or not as described; the message says which.
"""
import argparse
import inspect
import json
import math
import sys
from pathlib import Path

EXTENSIONS = (".jpg", ".JPG", ".png", ".PNG")
# Rows: right, forwards and up in Mega-NeRF's down, right, backwards.
OURS_FROM_DRB = ((0.0, 1.0, 0.0), (0.0, 0.0, -1.0), (-1.0, 0.0, 0.0))


class BadData(Exception):
    pass


def load(file, trusted):
    """The dictionary in a PyTorch file."""
    import torch

    if not file.is_file():
        raise BadData(f"{file}: no such file. Give the data set's folder, with coordinates.pt and the folders train and val")
    try:
        if trusted:  # without the word for versions that do not know it, and with it for those whose default is the other
            known = "weights_only" in inspect.signature(torch.load).parameters
            content = torch.load(file, map_location="cpu", **({"weights_only": False} if known else {}))
        else:
            content = torch.load(file, map_location="cpu", weights_only=True)
    except Exception as error:  # pickle, zip and PyTorch all have their own
        first = (str(error).splitlines() or [""])[0]
        advice = "" if trusted else ", or add --trust if you trust where it comes from: PyTorch before 2.0 reads it only then"
        raise BadData(f"{file}: cannot be read by PyTorch {torch.__version__} ({type(error).__name__}: {first}). Download it again{advice}") from error
    if not isinstance(content, dict):
        raise BadData(f"{file}: holds no dictionary. Download it again")
    return content


def numbers(file, content, key, *shape):
    """A tensor or number as nested lists of floats; of that shape."""
    if key not in content:
        raise BadData(f"{file}: has no '{key}'. Download it again, or write it as Mega-NeRF's README says")
    value = content[key]
    value = value.tolist() if hasattr(value, "tolist") else value

    def checked(part, sizes):
        if not sizes:
            if isinstance(part, bool) or not isinstance(part, (int, float)) or not math.isfinite(part):
                raise BadData(f"{file}: '{key}' must be made of finite numbers, not {part!r}")
            return float(part)
        if not isinstance(part, (list, tuple)) or len(part) != sizes[0]:
            raise BadData(f"{file}: '{key}' must have the shape {' x '.join(map(str, shape))}")
        return [checked(one, sizes[1:]) for one in part]

    return checked(value, shape)


def turned(vector):
    return [sum(a * b for a, b in zip(row, vector)) for row in OURS_FROM_DRB]


def transform_matrix(c2w, scale):
    """Camera to world in metres, right, up, backwards to right, forwards, up."""
    columns = [turned([row[i] for row in c2w]) for i in range(4)]
    columns[3] = [scale * x for x in columns[3]]
    return [[column[r] for column in columns] for r in range(3)] + [[0.0, 0.0, 0.0, 1.0]]


def frame_of(folder, part, metadata, scale, trusted):
    content = load(metadata, trusted)
    stem = metadata.stem
    picture = next((Path(part) / "rgbs" / (stem + e) for e in EXTENSIONS if (folder / part / "rgbs" / (stem + e)).is_file()), None)
    if picture is None:
        raise BadData(f"{folder / part / 'rgbs' / stem}.jpg: no such picture, for {metadata}. Copy the photos as Mega-NeRF's README says")
    size = {key: numbers(metadata, content, name) for key, name in (("w", "W"), ("h", "H"))}
    if any(value < 1 or value != int(value) for value in size.values()):
        raise BadData(f"{metadata}: 'W' and 'H' must be whole numbers of pixels")
    fx, fy, cx, cy = numbers(metadata, content, "intrinsics", 4)
    return {"file_path": picture.as_posix(), "w": int(size["w"]), "h": int(size["h"]), "fl_x": fx, "fl_y": fy, "cx": cx, "cy": cy,
            "transform_matrix": transform_matrix(numbers(metadata, content, "c2w", 3, 4), scale)}


def convert(folder, trusted):
    coordinates = load(folder / "coordinates.pt", trusted)
    scale = numbers(folder / "coordinates.pt", coordinates, "pose_scale_factor")
    numbers(folder / "coordinates.pt", coordinates, "origin_drb", 3)
    if scale <= 0.0:
        raise BadData(f"{folder / 'coordinates.pt'}: 'pose_scale_factor' must be more than 0")
    frames, held_out = [], []
    for part in ("train", "val"):
        found = sorted((folder / part / "metadata").glob("*.pt"))
        if not found:
            raise BadData(f"{folder / part / 'metadata'}: has no .pt files. Give the data set's folder, with coordinates.pt and the folders train and val")
        for metadata in found:
            frames.append(frame_of(folder, part, metadata, scale, trusted))
            if part == "val":
                held_out.append(frames[-1]["file_path"])
    return {"camera_model": "PINHOLE", "up": [0.0, 0.0, 1.0], "metres_per_unit": 1.0, "test_filenames": held_out, "frames": frames}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, help="the data set: coordinates.pt, train/ and val/")
    parser.add_argument("-o", "--out", type=Path, help="file to write; default: transforms.json in the folder. Its pictures count from where it lies")
    parser.add_argument("--trust", action="store_true", help="let the files run code while they are read, as PyTorch did before 2.0")
    arguments = parser.parse_args()
    out = arguments.out or arguments.folder / "transforms.json"
    if out.resolve().parent != arguments.folder.resolve():
        print(f"{out}: the file must lie in {arguments.folder}, because it names the pictures from there", file=sys.stderr)
        return 2
    try:
        import torch  # noqa: F401
    except ImportError:
        print("PyTorch is needed to read the files: pip install torch, or Debian's python3-torch", file=sys.stderr)
        return 2
    try:
        content = convert(arguments.folder, arguments.trust)
    except BadData as error:
        print(error, file=sys.stderr)
        return 3
    out.write_text(json.dumps(content, indent=1) + "\n")
    print(f"{out}: {len(content['frames'])} pictures, {len(content['test_filenames'])} of them held out")
    return 0


if __name__ == "__main__":
    sys.exit(main())
