#!/usr/bin/env python3
"""Checks the Markdown files of the repository. Prints FILE:LINE: fault, one per line, and ends with 1 when there is any.

  tests/docs/links.py

Checked:
  - relative links and pictures lead to a file or folder, and not out of the repository;
  - #anchors lead to a heading (as GitHub names them) or to an HTML id;
  - paths of our sources in code, as `core/geo/utm.h`, exist;
  - README.md has at most 1,200 words;
  - in pages of figures, the text above a table of figures says where they come from: the command (in code), the date (2026-11-22), the commit
    (c99d8c3) and the machine (its processor, cores or memory). Text above a table is the text between it and the table before, and the text between
    the section's heading and its first table or subsection. The machine may also be named once, in a line that begins with "**Machine:**".
    Rows with a link need nothing, because the linked place names it.
Python's standard library only.
"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import urllib.parse

README_WORDS = 1200
PAGES_OF_FIGURES = ("docs/benchmarks.md", "docs/brightness.md")
NOT_OURS = {".git", ".cache", "build", "out"}
SOURCE_ENDINGS = (".h", ".cpp", ".py", ".sh", ".toml", ".md", ".css", ".js", ".in", ".cmake", ".slurm", "CMakeLists.txt")

FENCE = re.compile(r"^ {0,3}(```+|~~~+)")
HEADING = re.compile(r"^ {0,3}(#{1,6})\s+(.*?)\s*#*\s*$")
CODE = re.compile(r"(`+)(.+?)\1")
LINK_END = re.compile(r"\]\(\s*<?([^)<>\s]*)>?(?:\s+\"[^\"]*\")?\s*\)")  # a link's text may begin on the line before
LINK_IN_TITLE = re.compile(r"!?\[([^\[\]]*)\]\([^)]*\)")
REFERENCE = re.compile(r"^ {0,3}\[[^\]]+\]:\s*<?(\S+?)>?(?:\s+\"[^\"]*\")?\s*$")
HTML_LINK = re.compile(r"<(?:a|img)\b[^>]*?\b(?:href|src)=\"([^\"]+)\"", re.IGNORECASE)
HTML_ID = re.compile(r"<[a-z]+\b[^>]*?\b(?:id|name)=\"([^\"]+)\"", re.IGNORECASE)
SCHEME = re.compile(r"^[a-z][a-z0-9+.-]*:|^//", re.IGNORECASE)
PATH = re.compile(r"(?<![\w./~$<>*{-])(?:\./)?((?:[\w.-]+/)+[\w.-]*)(?![\w/<>*{}$])")
FIGURE = re.compile(r"^[^\w`]*\d")
COMMAND = re.compile(r"^(?:mpirun\b.*)?(?:skyquilt |scripts/|build/|cmake |ctest )")
DATE = re.compile(r"\b20\d\d-\d\d-\d\d\b")
COMMIT = re.compile(r"(?:commit |`)[0-9a-f]{7,40}\b|\b(?=[0-9a-f]*\d)(?=[0-9a-f]*[a-f])[0-9a-f]{7,40}\b")
MACHINE = re.compile(r"\b(?:\d+ cores?|\d+ GiB|EPYC|Zen \d|Xeon|Core i\d|Ryzen)\b")
MACHINE_OF_PAGE = re.compile(r"^\*\*Machine:\*\* .*" + MACHINE.pattern)


def tracked(root):
    """Files of the repository, relative, with '/'. Outside of git: all but what is built."""
    if (root / ".git").exists():
        try:
            listed = subprocess.run(["git", "-C", str(root), "ls-files", "-z", "--cached", "--others", "--exclude-standard"], check=True,
                                    capture_output=True).stdout
            names = [name for name in listed.decode(errors="surrogateescape").split("\0") if name and (root / name).exists()]
            if names:
                return sorted(set(names))
        except (OSError, subprocess.CalledProcessError):
            pass
    names = []
    for folder, folders, files in os.walk(root):
        folders[:] = sorted(name for name in folders if name not in NOT_OURS)
        names += [(pathlib.Path(folder) / name).relative_to(root).as_posix() for name in files]
    return sorted(names)


class Page:
    """Lines of a Markdown file, each with whether it is in a code block, and what can be linked to."""

    def __init__(self, root, name):
        self.name = name
        self.text = (root / name).read_text(encoding="utf-8")
        self.lines = []  # (number, text, in a code block)
        fence = None
        for number, line in enumerate(self.text.splitlines(), 1):
            mark = FENCE.match(line)
            if fence is not None:
                self.lines.append((number, line, True))
                if mark and mark[1][0] == fence[0] and len(mark[1]) >= len(fence) and line.strip() == mark[1]:
                    fence = None
            elif mark:
                fence = mark[1]
                self.lines.append((number, line, True))
            else:
                self.lines.append((number, line, False))
        self.headings = [(number, len(found[1]), found[2]) for number, line, code in self.lines if not code and (found := HEADING.match(line))]
        self.anchors = set(HTML_ID.findall(self.text))
        for _, _, title in self.headings:
            slug = first = slug_of(title)
            count = 0
            while slug in self.anchors:
                count += 1
                slug = f"{first}-{count}"
            self.anchors.add(slug)


def slug_of(title):
    """The anchor that GitHub gives a heading."""
    title = LINK_IN_TITLE.sub(lambda found: found[1], title)
    title = re.sub(r"<[^>]+>", "", title).replace("`", "").replace("*", "")
    return re.sub(r"[^\w\- ]", "", title.strip().lower()).replace(" ", "-")


def link_faults(root, page, pages, files):
    folders = {parent.as_posix() for name in files for parent in pathlib.PurePosixPath(name).parents}
    for number, line, code in page.lines:
        if code:
            continue
        plain = CODE.sub(lambda found: "`" * len(found[0]), line)
        targets = LINK_END.findall(plain) + HTML_LINK.findall(plain)
        if reference := REFERENCE.match(plain):
            targets.append(reference[1])
        for target in targets:
            if SCHEME.match(target):
                continue
            path, _, anchor = target.partition("#")
            path = urllib.parse.unquote(path)
            if path.startswith("/"):
                yield number, f"link '{target}' is absolute: give it relative to this file"
                continue
            where = os.path.normpath(os.path.join(os.path.dirname(page.name), path)) if path else page.name
            if where.startswith(".."):
                yield number, f"link '{target}' leads out of the repository"
            elif where not in files and where not in folders and not (root / where).exists():
                yield number, f"link '{target}' leads to no file"
            elif anchor and where in pages and urllib.parse.unquote(anchor) not in pages[where].anchors:
                yield number, f"link '{target}': {where} has no heading '#{anchor}'"


def path_faults(page, files):
    """Paths in code that begin with one of our folders."""
    ours = {name.split("/")[0] for name in files if "/" in name}
    folders = {parent.as_posix() for name in files for parent in pathlib.PurePosixPath(name).parents}
    for number, line, code in page.lines:
        for piece in [line] if code else [found[2] for found in CODE.finditer(line)]:
            for found in PATH.finditer(piece):
                path = found[1].rstrip(".")
                if path.split("/")[0] not in ours:
                    continue
                if path.endswith("/"):
                    if path.rstrip("/") not in folders:
                        yield number, f"there is no folder '{path}'"
                elif (path.startswith("scripts/") or path.endswith(SOURCE_ENDINGS)) and path not in files and path not in folders:
                    yield number, f"there is no file '{path}'"


def tables_of(page):
    """(number of the first row with a figure, lines of text above it) of every table that holds figures."""
    inherited = {}  # by level of heading: the text before the first table or subsection
    for k, (start, level, _) in enumerate(page.headings):
        end = page.headings[k + 1][0] if k + 1 < len(page.headings) else len(page.lines) + 1
        above, first_table, figure, in_table = list(inherited.get(level - 1, [])) if level > 2 else [], True, None, False
        intro = above
        for number, line, code in page.lines[start:end - 1] + [(end, "", False)]:
            if line.startswith("|") and not code:
                if figure is None and is_figure_row(line):
                    figure = number
                in_table = True
                continue
            if in_table:
                if figure is not None:
                    yield figure, above
                if first_table:
                    intro, first_table = above, False
                above, figure, in_table = list(intro), None, False
            above = above + [(line, code)]
        inherited[level] = above if first_table else intro


def is_figure_row(line):
    """Whether a row of a table has a number, outside of code, at the start of any cell but the first."""
    cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
    return "](" not in line and any(FIGURE.match(cell) for cell in cells[1:])


def figure_faults(page):
    machine_of_page = any(MACHINE_OF_PAGE.match(line) for _, line, code in page.lines if not code)
    for number, above in tables_of(page):
        text = " ".join(line for line, code in above if not code)
        pieces = [line for line, code in above if code] + [found[2] for found in CODE.finditer(text)]
        told = {
            "the command": any(COMMAND.match(piece.strip()) for piece in pieces),
            "the date (as 2026-11-22)": DATE.search(text),
            "the commit (as c99d8c3)": COMMIT.search(text),
            "the machine (processor, cores or memory)": MACHINE.search(text) or machine_of_page,
        }
        missing = [what for what, found in told.items() if not found]
        if missing:
            yield number, "the text above this table of figures does not name " + ", ".join(missing)


def faults(root):
    files = tracked(root)
    pages = {name: Page(root, name) for name in files if name.endswith(".md")}
    known = set(files)
    for name, page in pages.items():
        found = list(link_faults(root, page, pages, known)) + list(path_faults(page, known))
        if name in PAGES_OF_FIGURES:
            found += figure_faults(page)
        if name == "README.md" and (words := len(page.text.split())) > README_WORDS:
            found.append((1, f"has {words} words, more than {README_WORDS}: move details to docs/"))
        for number, what in sorted(set(found)):
            yield f"{name}:{number}: {what}"


GOOD = {
    "README.md": "# Top\n[page](docs/page.md#a-heading-with-code)\n![picture](docs/picture.png)\n[up\nthere](#top) `core/a.h` `out/x.h` `core/<name>.h`\n",
    "docs/page.md": "# A heading, with `code`\n```\n[not a link](nowhere.md)\n```\n[back](../README.md) [again](#twice-1)\n## Twice\n## Twice\n",
    "docs/picture.png": "",
    "docs/benchmarks.md": "# Figures\n## Speed\n```\nskyquilt bench kernel\n```\nMeasured 2026-11-22 at commit `c99d8c3`,\n2 cores.\n"
                          "### Fast\n| what | s |\n|---|---|\n| a | 1.5 |\n\nand\n\n| what | s |\n|---|---|\n| a | 1.5 |\n"
                          "## Summary\n| what | s |\n|---|---|\n| a | 1.5 ([speed](#speed)) |\n",
    "core/a.h": "",
}
BAD = {
    "README.md": "# Top\n[gone](docs/gone.md \"so\")\n[anchor](docs/page.md#gone)\n`core/b.h`\n[out](../x.md)\n`scripts/none --now`\n" + "word " * 1200,
    "docs/page.md": "# Page\n![picture](gone.png)\n[absolute](/README.md)\n",
    "docs/benchmarks.md": "# Figures\n## Speed\n| what | s |\n|---|---|\n| a | 1.5 |\n"
                          "## Again\n`skyquilt run`, commit c99d8c3\n\n|x|y|\n|-|-|\n|a|2|\n",
    "core/a.h": "",
    "scripts/some.sh": "",
}
EXPECTED = [
    "README.md:1: has 1209 words",
    "README.md:2: link 'docs/gone.md' leads to no file",
    "README.md:3: link 'docs/page.md#gone': docs/page.md has no heading '#gone'",
    "README.md:4: there is no file 'core/b.h'",
    "README.md:5: link '../x.md' leads out of the repository",
    "README.md:6: there is no file 'scripts/none'",
    "docs/benchmarks.md:5: the text above this table of figures does not name the command, the date (as 2026-11-22), the commit (as c99d8c3), the machine",
    "docs/benchmarks.md:11: the text above this table of figures does not name the date (as 2026-11-22), the machine",
    "docs/page.md:2: link 'gone.png' leads to no file",
    "docs/page.md:3: link '/README.md' is absolute",
]


def finds_known_faults():
    """A checker that finds nothing proves nothing: a good tree and a bad one, made up."""
    for tree, expected in ((GOOD, []), (BAD, EXPECTED)):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            for name, text in tree.items():
                (root / name).parent.mkdir(parents=True, exist_ok=True)
                (root / name).write_text(text)
            found = list(faults(root))
        matched = len(found) == len(expected) and all(line.startswith(start) for line, start in zip(found, expected))
        if not matched:
            print("links.py itself is broken: expected", *expected, "found", *found, sep="\n  ")
            return False
    return True


def main():
    if not finds_known_faults():
        return 1
    found = list(faults(pathlib.Path(__file__).resolve().parents[2]))
    for line in found:
        print(line)
    print(f"{len(found)} fault(s)" if found else "no faults")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
