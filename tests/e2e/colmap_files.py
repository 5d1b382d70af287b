"""The images and points of COLMAP's binary models, read and written. Needs only Python's standard library."""
import dataclasses
import struct

IMAGE, POINT, COUNT = struct.Struct("<I7dI"), struct.Struct("<Q3d3Bd"), struct.Struct("<Q")
OBSERVATION_BYTES, TRACK_ENTRY = 24, struct.Struct("<II")


@dataclasses.dataclass
class Image:
    id: int
    rotation: tuple  # quaternion, w x y z: x_in_camera = rotation x + translation
    translation: tuple
    camera_id: int
    name: str
    observations: bytes  # as in the file, without their number


@dataclasses.dataclass
class Point:
    id: int
    head: tuple  # position, colour, error
    track: list  # of (image id, place among the image's observations)


def read_images(file):
    data, images = file.read_bytes(), []
    (n_images,), at = COUNT.unpack_from(data), COUNT.size
    for _ in range(n_images):
        image_id, *pose, camera_id = IMAGE.unpack_from(data, at)
        at += IMAGE.size
        end = data.index(b"\0", at)
        name, at = data[at:end].decode(), end + 1
        size = COUNT.unpack_from(data, at)[0] * OBSERVATION_BYTES
        at += COUNT.size
        images.append(Image(image_id, tuple(pose[:4]), tuple(pose[4:]), camera_id, name, data[at:at + size]))
        at += size
    return images


def write_images(file, images):
    parts = [COUNT.pack(len(images))]
    for image in images:
        parts += [IMAGE.pack(image.id, *image.rotation, *image.translation, image.camera_id), image.name.encode() + b"\0",
                  COUNT.pack(len(image.observations) // OBSERVATION_BYTES), image.observations]
    file.write_bytes(b"".join(parts))


def read_points(file):
    data, points = file.read_bytes(), []
    (n_points,), at = COUNT.unpack_from(data), COUNT.size
    for _ in range(n_points):
        point_id, *head = POINT.unpack_from(data, at)
        at += POINT.size
        size = COUNT.unpack_from(data, at)[0] * TRACK_ENTRY.size
        at += COUNT.size
        points.append(Point(point_id, tuple(head), list(TRACK_ENTRY.iter_unpack(data[at:at + size]))))
        at += size
    return points


def write_points(file, points):
    parts = [COUNT.pack(len(points))]
    for point in points:
        parts += [POINT.pack(point.id, *point.head), COUNT.pack(len(point.track)), *(TRACK_ENTRY.pack(*entry) for entry in point.track)]
    file.write_bytes(b"".join(parts))
