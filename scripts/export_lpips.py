#!/usr/bin/env python3
"""Writes the LPIPS network of the Python package `lpips` as an ONNX file for `skyquilt evaluate --lpips FILE`, or checks such a file.

  scripts/export_lpips.py lpips_alex.onnx
  scripts/export_lpips.py lpips_vgg.onnx --net vgg --size 1000x750
  scripts/export_lpips.py --check lpips_alex.onnx

Exporting needs PyTorch and lpips (pip install torch lpips); the package loads its weights from the network at the first use. Checking needs nothing
but Python. After an export the file is checked, and run with onnxruntime if that is installed (pip install onnxruntime).
The contract: two float inputs of 1 x 3 x H x W, RGB display values scaled to [-1,1], and one output. H and W are free or those of --size.
Exit status: 0 done, 1 the file breaks the contract, 2 wrong usage or a missing module.
"""
import argparse
import inspect
import sys
from pathlib import Path

INPUTS, OUTPUT = ("in0", "in1"), "distance"
OPSET = 11  # as in tests/core/metrics/lpips_test.cpp, which OpenCV 4.6 runs
FLOAT = 1


def fields(message):
    """The fields of a protobuf message: (number, value), where the value is a number or bytes."""
    at = 0

    def varint():
        nonlocal at
        value = shift = 0
        while True:
            byte = message[at]
            at += 1
            value |= (byte & 127) << shift
            shift += 7
            if byte < 128:
                return value

    while at < len(message):
        key = varint()
        kind = key & 7
        if kind == 0:
            yield key >> 3, varint()
            continue
        if kind not in (1, 2, 5):
            raise ValueError("not protobuf")
        size = varint() if kind == 2 else 8 if kind == 1 else 4
        if at + size > len(message):
            raise ValueError("truncated")
        yield key >> 3, message[at:at + size]
        at += size


def first(message, number, default=b""):
    return next((value for n, value in fields(message) if n == number), default)


def tensor(value_info):
    """Name, element type and shape (0: free) of a graph's input or output; field numbers of onnx.proto."""
    kind = first(first(value_info, 2), 1)
    shape = [first(size, 1, 0) for n, size in fields(first(kind, 2)) if n == 1]
    return first(value_info, 1).decode(), first(kind, 1, 0), shape


def problem(file):
    """What is wrong with the file, or ""."""
    try:
        graph = first(file.read_bytes(), 7)
        weights = {first(value, 8).decode() for n, value in fields(graph) if n == 5}
        inputs = [t for t in (tensor(value) for n, value in fields(graph) if n == 11) if t[0] not in weights]
        outputs = [tensor(value) for n, value in fields(graph) if n == 12]
    except OSError as error:
        return str(error)
    except (IndexError, ValueError, AttributeError, TypeError):
        return f"{file} is not an ONNX network"
    if not graph:
        return f"{file} is not an ONNX network"
    if len(inputs) != 2 or len(outputs) != 1:
        return f"{file} has {len(inputs)} inputs and {len(outputs)} outputs; wanted are two and one"
    for name, kind, shape in inputs:
        if kind != FLOAT or len(shape) != 4 or shape[0] not in (0, 1) or shape[1] not in (0, 3) or shape != inputs[0][2]:
            return f"{file}: input '{name}' is not 1 x 3 x H x W of floats, the same for both inputs: shape {shape}"
    return ""


def export(file, net, size):
    try:
        import torch
        import lpips
    except ImportError as error:
        print(f"export_lpips: the Python module '{error.name}' is missing. Install both with: pip install torch lpips", file=sys.stderr)
        sys.exit(2)
    width, height = size or (64, 64)
    model = lpips.LPIPS(net=net, spatial=False).eval()
    images = [torch.rand(1, 3, height, width) * 2 - 1 for _ in INPUTS]
    options = {"input_names": list(INPUTS), "output_names": [OUTPUT], "opset_version": OPSET}
    if size is None:
        options["dynamic_axes"] = {name: {2: "height", 3: "width"} for name in INPUTS}
    if "dynamo" in inspect.signature(torch.onnx.export).parameters:
        options["dynamo"] = False  # the newer exporter writes operators that OpenCV 4.6 does not know
    with torch.no_grad():
        expected = float(model(*images))
        torch.onnx.export(model, tuple(images), str(file), **options)
    try:
        import onnxruntime
    except ImportError:
        print("export_lpips: the network was not run, because onnxruntime is not installed (pip install onnxruntime)")
        return
    session = onnxruntime.InferenceSession(str(file), providers=["CPUExecutionProvider"])
    found = float(session.run(None, {name: image.numpy() for name, image in zip(INPUTS, images)})[0].ravel()[0])
    if abs(found - expected) > 1e-4 + 1e-3 * abs(expected):
        sys.exit(f"export_lpips: {file} gives {found:.6f} where PyTorch gives {expected:.6f}")
    print(f"export_lpips: run with onnxruntime, {found:.6f}; PyTorch {expected:.6f}")


def image_size(text):
    width, _, height = text.partition("x")
    if not (width.isdigit() and height.isdigit() and int(width) >= 32 and int(height) >= 32):
        raise argparse.ArgumentTypeError(f"'{text}' is not WIDTHxHEIGHT of at least 32x32, for instance 1000x750")
    return int(width), int(height)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0], formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", type=Path, help="ONNX file to write, or to check")
    parser.add_argument("--net", choices=("alex", "vgg"), default="alex", help="alex: small and fast, the usual choice for scores; vgg: larger")
    parser.add_argument("--size", type=image_size, help="fixed size of the images, WIDTHxHEIGHT; without it any size works")
    parser.add_argument("--check", action="store_true", help="only check the inputs and outputs of the file")
    arguments = parser.parse_args()
    if not arguments.check:
        export(arguments.file, arguments.net, arguments.size)
    wrong = problem(arguments.file)
    if wrong:
        print("export_lpips: " + wrong, file=sys.stderr)
        sys.exit(1)
    print(f"export_lpips: {arguments.file} has the inputs and the output that skyquilt evaluate needs")


if __name__ == "__main__":
    main()
