"""Documents and files as the page of `skyquilt view` saves them."""
import hashlib
import json
import os
import struct
import zlib


def feature(index):
    return {"type": "Feature", "properties": {"kind": "point", "name": f"point {index}", "filler": "x" * 200},
            "geometry": {"type": "Point", "coordinates": [8.5417, 47.3769, 408.0 + index]}}


def collection(size):
    return json.dumps({"type": "FeatureCollection", "features": [feature(index) for index in range(size)]})


def png(pixels):
    """A square PNG of noise, which does not get smaller."""
    def chunk(name, content):
        return struct.pack(">I", len(content)) + name + content + struct.pack(">I", zlib.crc32(name + content))
    rows = b"".join(b"\0" + os.urandom(3 * pixels) for _ in range(pixels))
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", pixels, pixels, 8, 2, 0, 0, 0)) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


def asset_path(content):
    return f"/data/tour/assets/{hashlib.sha256(content).hexdigest()}.png"


def tour(title):
    stop = {"id": "gate", "title": "The gate", "text": "", "picture": None, "link": None, "exposure_stops": None, "layers": None, "measurements": [],
            "pose": {"eye_enu": [0, 0, 50], "rotation": [0, 1, 0, 0], "fovy_deg": 60}, "pause_s": 5, "next": None, "branches": []}
    return json.dumps({"version": 1, "title": title, "start": None, "stops": [stop], "things": [], "assets": {}})
