"""Options of stages as keyword arguments, in the form in which the program reads them."""
from __future__ import annotations

import difflib
import os
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from . import _skyquilt
from .errors import UsageError


def _seconds(value: Any) -> str:
    """Of a duration: "20min", "1h30m", or a number of seconds; in whole milliseconds, as the text must read back to the same number."""
    return f"{round(_skyquilt.seconds_of(str(value)) * 1000.0) / 1000.0:f}"


def _gib(value: Any) -> str:
    return _skyquilt.gib_of(str(value))


def _file(value: Any) -> str:
    text = os.fspath(value)
    return os.path.abspath(text) if text else text


def _text(value: Any) -> str:
    """As in TOML; texts without quotes, lists without brackets."""
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, str):
        return value
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if isinstance(value, (float, np.floating)):
        return repr(float(value))
    if isinstance(value, (int, np.integer)):
        return str(int(value))
    if isinstance(value, Iterable) and not isinstance(value, Mapping):
        return ",".join(_text(one) for one in value)
    raise UsageError(f"an option cannot have the value {value!r}: give a number, a text, True or False, or a list")


def _bars(value: Any) -> str:
    return value if isinstance(value, str) else "|".join(_text(one) for one in value)


# What the flags of the same names of the commands set.
_TRAINING = {
    "time_budget": (("run.time_budget_s",), _seconds),
    "steps": (("train.steps",), _text),
    "checkpoint_every": (("context.checkpoint_every_s", "train.checkpoint_every_s"), _seconds),
    "memory": (("run.memory_gb",), _gib),
    "seed": (("run.seed",), _text),
    "brightness": (("brightness.correction",), _text),
}
_PLACE = {
    "gcp": (("prepare.gcp",), _file),
    "check_points": (("prepare.check_points",), _text),
    "up": (("prepare.up",), _text),
    "scale_bars": (("prepare.scale_bars",), _bars),
    "holdout": (("prepare.holdout",), _text),
    "masks": (("prepare.masks",), _text),
}
_GRID = {
    "blocks": (("partition.blocks",), _text),
    "altitudes": (("partition.altitudes",), _text),
    "image_width": (("run.image_width",), _text),
}
_BOUNDARY = {"boundary": (("products.boundary",), _file), "memory": (("run.memory_gb",), _gib)}
_THREADS = {"threads": (("run.threads",), _text)}
SHORT = {
    "simulate": {"flight": (("simulate.flight",), _text), "seed": (("simulate.seed",), _text), "image_width": (("simulate.image_width",), _text),
                 "altitudes": (("simulate.altitudes",), _text)},
    "prepare": _PLACE,
    "partition": {**_GRID, "time_budget": _TRAINING["time_budget"]},
    "train": _TRAINING,
    "merge": {},
    "products": {**_BOUNDARY, "exposure": (("products.exposure",), _text), "resolution": (("products.resolution_m",), _text)},
    "surface": _BOUNDARY,
    "buildings": {"memory": (("run.memory_gb",), _gib)},
    "evaluate": {"memory": (("run.memory_gb",), _gib)},
    "run": {**_PLACE, **_GRID, **_BOUNDARY, **_TRAINING, "within": (("run.within_s",), _seconds)},
}


def overrides(stage: str, options: Mapping[str, Any]) -> list[tuple[str, str]]:
    """("section.key", value) pairs of a stage's keyword arguments, sections first, so that the short names win. Whether sections, keys and values are
    known is checked where they are read, but for the names of arguments, which are checked here."""
    short = {**SHORT[stage], **_THREADS}
    sections = _skyquilt.sections()
    found: list[tuple[str, str]] = []
    for name, value in options.items():
        if name in short:
            continue
        if name in sections and isinstance(value, Mapping):
            found += [(f"{name}.{key}", _text(one)) for key, one in value.items()]
        elif "." in name:
            found.append((name, _text(value)))
        elif name in sections:
            raise UsageError(f"{name} is a section of options: give a dict, such as {name}={{'key': value}}")
        else:
            near = difflib.get_close_matches(name, [*short, *sections], 1)
            raise UsageError(f"skyquilt.{stage} has no argument '{name}'" + (f". Did you mean '{near[0]}'?" if near else "") +
                             f" It takes {', '.join(sorted(short))}, and sections: {', '.join(sections)}")
    for name, value in options.items():
        if name in short:
            keys, text = short[name]
            found += [(key, text(value)) for key in keys]
    return found
