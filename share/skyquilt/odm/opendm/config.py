"""The options of 'skyquilt odm' as argparse knows them. NodeODM loads this file to learn what the engine takes; the program does not use it.

Their one table is options.json beside this file, which is also built into the program.
"""
import argparse
import json
import os

FOLDER = os.path.dirname(os.path.abspath(__file__))


def _version():
    with open(os.path.join(FOLDER, os.pardir, "VERSION"), encoding="utf-8") as file:
        return file.readline().strip()


def path_or_json_string(text):
    """A path, or JSON text: either is checked by the program."""
    return text


def _words(option):
    """Keyword arguments of add_argument."""
    words = {"help": _help(option).replace("%", "%%")}
    kind = option["kind"]
    if kind == "flag":
        return dict(words, action="store_true", default=False)
    words["metavar"] = "<" + option.get("domain", "string") + ">"
    if kind == "choice":
        words["choices"] = option["choices"]
    else:
        words["type"] = {"int": int, "float": float, "json": path_or_json_string}.get(kind, str)
    if option["name"] == "--max-concurrency":
        words["default"] = os.cpu_count() or 1
    elif "default" in option:
        words["default"] = words["type"](option["default"]) if kind in ("int", "float") else option["default"]
    return words


def _help(option):
    if "refused" in option:
        return option["help"] + " Refused: " + option["refused"] + "."
    if "no_effect" in option:
        return option["help"] + " Taken, without effect: " + option["no_effect"] + "."
    return option["help"]


def config(argv=None, parser=None):
    """Declares all options and parses argv (None: the process's own). parser: takes the declarations instead of a new ArgumentParser."""
    if parser is None:
        parser = argparse.ArgumentParser(prog="run.sh", description="Skyquilt with OpenDroneMap's options")
    parser.add_argument("name", metavar="<dataset name>", nargs="?", default="code", help="folder of the dataset within the project path")
    parser.add_argument("--version", action="version", version="skyquilt " + _version(), help="show the version and end")
    with open(os.path.join(FOLDER, "options.json"), encoding="utf-8") as file:
        options = json.load(file)
    for option in options:
        names = [option["name"]] + ([option["short"]] if "short" in option else [])
        parser.add_argument(*names, **_words(option))
    return parser.parse_args(argv)
