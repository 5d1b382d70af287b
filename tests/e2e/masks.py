"""Masks by a network and of ground to ignore, and what moved between photos: made over ranks, used from training to report, refused with a remedy where they cannot be made."""
import json
import math
import struct

from harness import SMALL, expect, main, replaced, small_survey


def varint(value):
    out = bytearray()
    while value > 127:
        out.append(value & 127 | 128)
        value >>= 7
    return bytes(out + bytes([value]))


def number(field, value):
    return varint(field << 3) + varint(value)


def text(field, content):
    content = content.encode() if isinstance(content, str) else content
    return varint(field << 3 | 2) + varint(len(content)) + content


def bright_finder(least):
    """An ONNX network of one 1x1 convolution: class 1 where the sum of red, green and blue (0 to 1 each) is above `least`."""
    def value(name, channels):
        dims = b"".join(text(1, number(1, n) if n else text(2, f"free{i}")) for i, n in enumerate((1, channels, 0, 0)))
        return text(1, name) + text(2, text(1, number(1, 1) + text(2, dims)))

    def weights(name, shape, values):
        return b"".join(number(1, n) for n in shape) + number(2, 1) + text(8, name) + text(9, struct.pack(f"<{len(values)}f", *values))

    node = text(1, "photo") + text(1, "weights") + text(1, "bias") + text(2, "scores") + text(3, "convolution") + text(4, "Conv")
    node += text(5, text(1, "kernel_shape") + number(8, 1) + number(8, 1) + number(20, 7))
    graph = text(1, node) + text(2, "graph") + text(5, weights("weights", (2, 3, 1, 1), (0, 0, 0, 1, 1, 1)))
    graph += text(5, weights("bias", (2,), (0, -least))) + text(11, value("photo", 3)) + text(12, value("scores", 2))
    return number(1, 7) + text(8, number(2, 11)) + text(7, graph)


CONFIG = """input_width = 64
input_height = 48
photo_width = 160
overlap = 8
classes = ["other", "bright"]
ignore = ["bright"]
"""


def square(survey, east_m, north_m, half_m):
    """GeoJSON with a square around a place in ENU."""
    origin = json.loads((survey / "survey.json").read_text())["origin"]
    latitude, longitude = origin["latitude_deg"], origin["longitude_deg"]
    corners = []
    for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1), (-1, -1)):
        corners.append([longitude + (east_m + half_m * x) / (111320.0 * math.cos(math.radians(latitude))), latitude + (north_m + half_m * y) / 110900.0])
    return json.dumps({"type": "Feature", "properties": {}, "geometry": {"type": "Polygon", "coordinates": [corners]}})


def table(project):
    return json.loads((project / "survey" / "made_masks" / "masks.json").read_text())


def test(skyquilt, folder):
    survey, out = small_survey(skyquilt), folder / "out"
    network, config, pond = folder / "bright.onnx", folder / "bright.toml", folder / "pond.geojson"
    network.write_bytes(bright_finder(1.9))
    config.write_text(CONFIG)
    segment = ["--segment", network, "--segment-config", config]

    skyquilt.call("prepare", survey, "-o", out)
    pond.write_text(square(out / "survey", 0.0, 0.0, 12.0))
    alone = skyquilt.call("masks", out, *segment, "--ignore-ground", pond, says=("bright.onnx finds bright in", "pond.geojson says to ignore", "look"))
    expect("photos" in alone, alone)
    made = table(out)
    shares = {part: sum(photo[part] for photo in made["photos"]) / sum(photo["pixels"] for photo in made["photos"])
              for part in ("network", "ground", "ignored")}
    expect(all(0.001 < share < 0.7 for share in shares.values()), shares)
    for photo in made["photos"]:
        expect(not photo["look"] or (out / "survey" / "made_masks" / photo["look"]).is_file(), photo)
    skyquilt.call("masks", out, says="nothing to do")
    skyquilt.call("masks", out, *segment, "--ignore-ground", "", says="running again, because its inputs have changed")
    expect(table(out)["ground"] == "" and sum(photo["ground"] for photo in table(out)["photos"]) == 0, "the pond is no longer ignored")

    # Over ranks, and with a network that is given as JSON: the same.
    config_json = folder / "bright.json"
    config_json.write_text(json.dumps({"input_width": 64, "input_height": 48, "photo_width": 160, "overlap": 8, "classes": ["other", "bright"],
                                       "ignore": ["bright"]}))
    other = folder / "ranks"
    run = replaced(SMALL, "--steps", "60")
    skyquilt.call("run", survey, "-o", other, *run, "--segment", network, "--segment-config", config_json, "--ignore-ground", pond, "--movers", "on",
                  ranks=3, says=("masks are made by 2 ranks", "of the photos could be compared with others"))
    expect(table(other) == made, "ranks make the same masks")
    page = (other / "report" / "index.html").read_text()
    expect("by network bright.onnx: bright" in page and "on ground inside pond.geojson" in page, "the report has masks")
    expect((other / "report" / "images" / "mask_0.jpg").is_file(), "the report shows masks")
    compared = json.loads((other / "movers" / "movers.json").read_text())
    expect(compared["compared"] > 0.3 and "What moved" in page, compared["compared"])
    for photo in compared["photos"]:
        expect(not photo["look"] or (other / "movers" / photo["look"]).is_file(), photo)

    # What training has seen stays; --restart removes it.
    context = other / "checkpoints" / "context.h5"
    skyquilt.call("masks", other, "--ignore-ground", "", status=2, says=("'train'", "ignored ground", "--restart"))
    skyquilt.call("run", survey, "-o", other, *run, status=2, says=("'train'", "network", "--restart"))
    skyquilt.call("train", other, "--movers", "off", status=2, says=("'train'", "robust.movers", "--restart"))
    expect(context.is_file() and table(other) == made, "nothing was changed")
    skyquilt.call("masks", other, "--ignore-ground", "", "--restart")
    expect(not context.exists() and (other / "survey" / "survey.json").is_file(), "training is removed, the survey is not")

    # What cannot be used: a message with the remedy, before anything is done.
    new, unknown, broken = folder / "new", folder / "unknown.toml", folder / "broken.geojson"
    unknown.write_text(CONFIG.replace('ignore = ["bright"]', 'ignore = ["dark"]'))
    broken.write_text(pond.read_text()[:60])
    for words, status, says in (
            (["--segment", network], 2, "--segment-config"),
            (["--segment", folder / "absent.onnx", "--segment-config", config], 3, "absent.onnx"),
            (["--segment", config, "--segment-config", config], 3, ("bright.toml", "Give a network")),
            (["--segment", network, "--segment-config", folder / "absent.toml"], 3, "absent.toml"),
            (["--segment", network, "--segment-config", unknown], 3, ("unknown.toml", "'dark'", "docs/input.md")),
            (["--ignore-ground", folder / "absent.geojson"], 3, "absent.geojson"),
            (["--ignore-ground", broken], 3, ("broken.geojson", "GeoJSON or GeoPackage"))):
        skyquilt.call("run", survey, "-o", new, *words, status=status, says=says)
    expect(not new.exists(), "no project is begun")
    pond.write_text(square(out / "survey", 90000.0, 0.0, 12.0))
    skyquilt.call("masks", out, "--ignore-ground", pond, status=3, says=("pond.geojson", "no polygon on the ground that the photos see", "Draw"))
    # A survey whose masks were not made is not trained without them.
    skyquilt.call("partition", out, "--blocks", "1x1")
    skyquilt.call("train", out, "--steps", "10", status=3, says=("masks.json", "skyquilt masks"))
    skyquilt.call("masks", out, "--ignore-ground", "")
    expect(table(out)["ground"] == "" and table(out)["network"] == "bright.onnx", table(out))


main(test)
