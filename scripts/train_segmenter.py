#!/usr/bin/env python3
"""Trains a small network that finds what moves, on simulated photos, and writes it with its configuration for `skyquilt run --segment`.

  skyquilt simulate town -o S1 --image-width 960 --seed 1 --set simulate.class_images=all --set simulate.people=300 --set simulate.moving_cars=120
  scripts/train_segmenter.py S1 S2 S3 -o movers              # writes movers.onnx and movers.toml
  scripts/train_segmenter.py S1 S2 --check-on S3 -o movers   # also tells how well it does on a survey that it has not seen
  skyquilt run photos/ -o out --segment movers.onnx --segment-config movers.toml

Surveys are folders of `skyquilt simulate` with simulate.class_images = all; several with different seeds and suns teach more than one with more
photos. What is ignored: --ignore, class names of core/survey/surface_class.h. A photo has far fewer pixels of people than of ground, so crops are
chosen around what is ignored as often as anywhere. A network that has seen simulated places only knows what these have: it is a start, not a judge
of real photos. Look through survey/made_masks/look/ before trusting it.
Needs Debian's python3-torch and python3-pil: apt install python3-torch python3-pil. Neither building nor testing Skyquilt needs them.
Exit status: 0 done, 1 an input cannot be used, 2 wrong usage or a missing module.
"""
import argparse
import json
import random
import sys
import time
from pathlib import Path

CLASSES = ["none", "roof", "wall", "ground", "road", "tree", "parked car", "moving car", "water", "person", "lamp"]
MEAN, STD = (0.45, 0.45, 0.45), (0.25, 0.25, 0.25)
OPSET = 11  # which OpenCV 4.6 runs
DEPTH = 3  # times the picture is halved; sizes must be multiples of 2 ** DEPTH


def fail(message, status=1):
    print(f"train_segmenter: {message}", file=sys.stderr)
    sys.exit(status)


try:
    import numpy
    import torch
    from PIL import Image
    from torch import nn
except ImportError as error:
    fail(f"{error.name} is missing. Install it: apt install python3-torch python3-pil", 2)


def block(inputs, outputs):
    return nn.Sequential(nn.Conv2d(inputs, outputs, 3, padding=1), nn.BatchNorm2d(outputs), nn.ReLU(),
                         nn.Conv2d(outputs, outputs, 3, padding=1), nn.BatchNorm2d(outputs), nn.ReLU())


class UNet(nn.Module):
    """Ronneberger et al. 2015, with few channels: `width` at full size, twice as many each time the picture is halved. Logits of two classes."""

    def __init__(self, width):
        super().__init__()
        sizes = [width * 2**level for level in range(DEPTH + 1)]
        self.down = nn.ModuleList([block(3 if level == 0 else sizes[level - 1], sizes[level]) for level in range(DEPTH + 1)])
        self.up = nn.ModuleList([nn.ConvTranspose2d(sizes[level + 1], sizes[level], 2, stride=2) for level in range(DEPTH)])
        self.join = nn.ModuleList([block(2 * sizes[level], sizes[level]) for level in range(DEPTH)])
        self.head = nn.Conv2d(width, 2, 1)
        self.pool = nn.MaxPool2d(2)

    def forward(self, x):
        kept = []
        for level, down in enumerate(self.down):
            x = down(x if level == 0 else self.pool(x))
            kept.append(x)
        for level in reversed(range(DEPTH)):
            x = self.join[level](torch.cat([self.up[level](x), kept[level]], 1))
        return self.head(x)


class Survey:
    """Photos of a simulated survey, with the pixels that are to be ignored."""

    def __init__(self, folder, ignored, photo_width):
        self.folder = Path(folder)
        if not (self.folder / "simulate.json").is_file():
            fail(f"{folder}: is no simulated survey. Make one: skyquilt simulate town -o {folder} --set simulate.class_images=all")
        self.photos = []
        for photo in sorted((self.folder / "images").glob("*.jpg")):
            labels = self.folder / "truth" / "classes" / (photo.stem + ".png")
            if labels.is_file():
                self.photos.append((photo, labels))
        if len(self.photos) < 2:
            fail(f"{folder}: has class images of {len(self.photos)} photos. Simulate it with --set simulate.class_images=all")
        width = Image.open(self.photos[0][0]).width
        self.ignored, self.photo_width = ignored, min(photo_width or width, width)

    def load(self, index):
        """RGB as height x width x 3 and the pixels to ignore as height x width, both of 8 bits."""
        photo, labels = self.photos[index]
        rgb = Image.open(photo).convert("RGB")
        target = numpy.isin(numpy.asarray(Image.open(labels)), self.ignored).astype(numpy.uint8)
        if rgb.width > self.photo_width:
            size = (self.photo_width, round(rgb.height * self.photo_width / rgb.width))
            rgb = rgb.resize(size, Image.BOX)
            target = (numpy.asarray(Image.fromarray(target * 255).resize(size, Image.BOX)) > 127).astype(numpy.uint8)
        return numpy.asarray(rgb), target


def normalized(rgb):
    """Batch x height x width x 3 of 8 bits to what the network takes."""
    x = torch.from_numpy(rgb.astype(numpy.float32) / 255.0).permute(0, 3, 1, 2)
    return (x - torch.tensor(MEAN).view(1, 3, 1, 1)) / torch.tensor(STD).view(1, 3, 1, 1)


def varied(rgb, rng):
    """As other suns, cameras and exposures would show it."""
    gain = numpy.exp(numpy.array([rng.gauss(0, 0.08) for _ in range(3)]) + rng.gauss(0, 0.25))
    gamma = numpy.exp(rng.gauss(0, 0.15))
    light = numpy.clip(rgb / 255.0, 0, 1) ** gamma * gain
    return numpy.clip(light * 255.0 + rng.gauss(0, 4.0), 0, 255).astype(numpy.uint8)


def crop(rgb, target, size, rng):
    """A square of the photo, turned and mirrored; around a pixel to ignore in half of the calls, where there is one."""
    height, width = target.shape
    y, x = rng.randrange(max(1, height - size + 1)), rng.randrange(max(1, width - size + 1))
    places = numpy.flatnonzero(target) if rng.random() < 0.5 else []
    if len(places):
        at = int(places[rng.randrange(len(places))])
        y = min(max(0, at // width - rng.randrange(size)), max(0, height - size))
        x = min(max(0, at % width - rng.randrange(size)), max(0, width - size))
    rgb, target = rgb[y:y + size, x:x + size], target[y:y + size, x:x + size]
    pad = ((0, size - rgb.shape[0]), (0, size - rgb.shape[1]))
    rgb, target = numpy.pad(rgb, (*pad, (0, 0)), mode="edge"), numpy.pad(target, pad, mode="edge")
    turns = rng.randrange(4)
    rgb, target = numpy.rot90(rgb, turns), numpy.rot90(target, turns)
    return (rgb[:, ::-1], target[:, ::-1]) if rng.random() < 0.5 else (rgb, target)


def scores(net, surveys, tile, limit=40):
    """Pixels found, missed and wrong, on at most so many photos of each survey."""
    found = missed = wrong = 0
    net.eval()
    with torch.no_grad():
        for survey in surveys:
            for index in range(0, len(survey.photos), max(1, len(survey.photos) // limit)):
                rgb, target = survey.load(index)
                height, width = (side // tile * tile for side in target.shape)
                for y in range(0, height, tile):
                    for x in range(0, width, tile):
                        guess = net(normalized(rgb[None, y:y + tile, x:x + tile])).argmax(1)[0].numpy()
                        truth = target[y:y + tile, x:x + tile]
                        found += int(((guess == 1) & (truth == 1)).sum())
                        missed += int(((guess == 0) & (truth == 1)).sum())
                        wrong += int(((guess == 1) & (truth == 0)).sum())
    return found, missed, wrong


def tell(name, counts):
    found, missed, wrong = counts
    union = max(1, found + missed + wrong)
    print(f"{name}: finds {100 * found / max(1, found + missed):.1f} % of the pixels to ignore, {100 * wrong / max(1, found + wrong):.1f} % of what it "
          f"finds is wrong, intersection over union {found / union:.3f}")


def train(net, surveys, options):
    rng = random.Random(options.seed)
    optimizer = torch.optim.AdamW(net.parameters(), lr=options.rate, weight_decay=1e-4)
    loss_of = nn.CrossEntropyLoss(weight=torch.tensor([1.0, options.weight]))
    pool, begin, step, total = [], time.monotonic(), 0, 0.0
    while time.monotonic() - begin < 60.0 * options.minutes and (options.steps == 0 or step < options.steps):
        if len(pool) < 24 or step % 4 == 0:  # a photo is read once for several crops
            survey = surveys[rng.randrange(len(surveys))]
            pool = (pool + [survey.load(rng.randrange(len(survey.photos)))])[-24:]
        pairs = [crop(*pool[rng.randrange(len(pool))], options.tile, rng) for _ in range(options.batch)]
        rgb = numpy.stack([varied(pair[0], rng) for pair in pairs])
        target = torch.from_numpy(numpy.stack([pair[1] for pair in pairs]).astype(numpy.int64))
        share = min(1.0, max((time.monotonic() - begin) / (60.0 * options.minutes), step / options.steps if options.steps else 0.0))
        for group in optimizer.param_groups:
            group["lr"] = options.rate * max(0.02, 1.0 - share)
        net.train()
        optimizer.zero_grad()
        loss = loss_of(net(normalized(rgb)), target)
        loss.backward()
        optimizer.step()
        step, total = step + 1, total + float(loss)
        if step % 50 == 0:
            print(f"step {step}, {time.monotonic() - begin:.0f} s, loss {total / 50:.4f}", flush=True)
            total = 0.0
    print(f"{step} steps in {time.monotonic() - begin:.0f} s")


def export(net, options, names, photo_width):
    out = Path(options.out)
    out.parent.mkdir(parents=True, exist_ok=True)
    net.eval()
    torch.onnx.export(net, torch.zeros(1, 3, options.tile, options.tile), str(out) + ".onnx", opset_version=OPSET, input_names=["photo"],
                      output_names=["scores"])
    quoted = ", ".join(json.dumps(name) for name in names)
    Path(str(out) + ".toml").write_text(
        f"# Written by scripts/train_segmenter.py for {out.name}.onnx; docs/input.md explains the keys.\n"
        f"# It finds: {', '.join(names)}.\n"
        f"input_width = {options.tile}\ninput_height = {options.tile}\n"
        f"photo_width = {photo_width}\noverlap = {options.tile // 8}\n"
        f"scale = {1 / 255!r}\nmean = {list(MEAN)}\nstd = {list(STD)}\nchannels = \"rgb\"\n"
        f"classes = [\"other\", \"{' or '.join(names)}\"]\nignore = [\"{' or '.join(names)}\"]\n"
        f"dilate_px = 3  # edges, and the shadow right beside\n")
    print(f"{out}.onnx and {out}.toml: {quoted}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0], formatter_class=argparse.ArgumentDefaultsHelpFormatter)
    parser.add_argument("surveys", nargs="+", help="simulated surveys to train on")
    parser.add_argument("-o", "--out", required=True, help="files to write, without .onnx and .toml")
    parser.add_argument("--check-on", nargs="*", default=[], help="simulated surveys to test with")
    parser.add_argument("--ignore", default="person,moving car", help="classes to find, separated by commas: " + ", ".join(CLASSES))
    parser.add_argument("--minutes", type=float, default=10.0, help="training time")
    parser.add_argument("--steps", type=int, default=0, help="end after so many steps, if that is sooner; 0: by time alone")
    parser.add_argument("--photo-width", type=int, default=1000, help="photos are reduced to this width, as run.image_width does; 0: full size")
    parser.add_argument("--tile", type=int, default=256, help="side of the network's input in pixels, a multiple of 8")
    parser.add_argument("--width", type=int, default=12, help="channels at full size")
    parser.add_argument("--batch", type=int, default=8, help="crops per step")
    parser.add_argument("--rate", type=float, default=2e-3, help="learning rate at the start")
    parser.add_argument("--weight", type=float, default=3.0, help="of pixels to ignore in the loss; more finds more, and more that is wrong")
    parser.add_argument("--seed", type=int, default=1, help="random seed")
    options = parser.parse_args()
    names = [name.strip() for name in options.ignore.split(",")]
    for name in names:
        if name not in CLASSES[1:]:
            fail(f"--ignore: '{name}' is none of {', '.join(CLASSES[1:])}", 2)
    if options.tile < 32 or options.tile % 2**DEPTH:
        fail(f"--tile must be a multiple of {2**DEPTH}, at least 32", 2)
    torch.manual_seed(options.seed)
    ignored = [CLASSES.index(name) for name in names]
    surveys = [Survey(folder, ignored, options.photo_width) for folder in options.surveys]
    tests = [Survey(folder, ignored, options.photo_width) for folder in options.check_on]
    net = UNet(options.width)
    print(f"{sum(len(survey.photos) for survey in surveys)} photos, {sum(p.numel() for p in net.parameters())} weights")
    train(net, surveys, options)
    tell("trained on", scores(net, surveys, options.tile, 10))
    for survey in tests:
        tell(str(survey.folder), scores(net, [survey], options.tile))
    export(net, options, names, max(survey.photo_width for survey in surveys))


if __name__ == "__main__":
    main()
