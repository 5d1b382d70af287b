#!/usr/bin/env python3
"""Measures `skyquilt view` without a browser: seconds to the first and to the full picture, four clients at once, picks, and memory over many moves.

  scripts/bench_viewer.py build/release/skyquilt PROJECT [--moves 2000] [--ranks N]

Prints medians over --repeats. The front end's frames per second are measured by web/test/page/speed.mjs.
"""
import argparse
import math
import pathlib
import statistics
import sys
import threading
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "tests" / "e2e"))
from harness import Skyquilt  # noqa: E402
from web_client import Viewer, looking  # noqa: E402

FULL = (1000, 563)


class Orbit:
    """Views from a circle around the middle of the scene."""

    def __init__(self, project):
        low, high = project["min_enu"], project["max_enu"]
        self.middle = [(a + b) / 2 for a, b in zip(low, high)]
        self.middle[2] = project["ground_m"]
        self.radius = 0.35 * max(high[0] - low[0], high[1] - low[1])

    def pose(self, turn, near=1.0):
        eye = [self.middle[0] + near * self.radius * math.cos(turn), self.middle[1] + near * self.radius * math.sin(turn),
               self.middle[2] + near * self.radius]
        return eye, looking(eye, self.middle)


def median(values):
    return statistics.median(values)


def passes(socket, orbit, seq, turn):
    """Seconds from asking to each pass."""
    start = time.monotonic()
    socket.view(seq, *orbit.pose(turn), *FULL)
    seconds = []
    while True:
        frame = socket.frame(seq)
        seconds.append(time.monotonic() - start)
        if frame.complete:
            return seconds


def four_clients(viewer, orbit, seq, turn):
    """Seconds until the last of four clients that ask at the same time has its small picture."""
    sockets = [viewer.socket() for _ in range(4)]
    seconds = []

    def ask(index):
        start = time.monotonic()
        sockets[index].view(seq, *orbit.pose(turn + index), *FULL)
        sockets[index].frame(seq)
        seconds.append(time.monotonic() - start)

    threads = [threading.Thread(target=ask, args=(index,)) for index in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for socket in sockets:
        socket.close()
    if len(seconds) != len(sockets):
        raise RuntimeError(f"only {len(seconds)} of {len(sockets)} clients got a picture")
    return max(seconds)


def memory_over_moves(viewer, socket, orbit, moves):
    """Largest resident memory in the first and the last quarter of the moves. Every tenth view is waited for until its last pass."""
    quarter = {0: 0, 3: 0}
    for move in range(moves):
        seq = 1_000_000 + move
        socket.view(seq, *orbit.pose(0.01 * move, 0.5 + 0.5 * ((move * 7) % 11) / 11), 320, 180)
        if move % 10 == 0:
            socket.last_frame(seq)
        elif move % 3 == 0:
            socket.frame(seq)
        part = 4 * move // moves
        if part in quarter:
            quarter[part] = max(quarter[part], viewer.rss_bytes())
    return quarter[0], quarter[3]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("project")
    parser.add_argument("--moves", type=int, default=2000)
    parser.add_argument("--repeats", type=int, default=7)
    parser.add_argument("--ranks", type=int, default=0)
    options = parser.parse_args()
    start = time.monotonic()
    viewer = Viewer(Skyquilt(options.program), options.project, ranks=options.ranks).log_in()
    print(f"link printed after           {time.monotonic() - start:8.2f} s")
    try:
        start = time.monotonic()
        orbit = Orbit(viewer.project())
        print(f"project.json                 {time.monotonic() - start:8.2f} s")
        socket = viewer.socket()
        while not socket.welcome["engine"]["ready"]:
            socket.welcome = socket.text("engine")
        print(f"engine ready after           {time.monotonic() - start:8.2f} s")
        runs = [passes(socket, orbit, 1 + i, 0.9 * i) for i in range(options.repeats)]
        for number in range(len(runs[0])):
            print(f"pass {number + 1} of {FULL[0]} x {FULL[1]}        {median([run[number] for run in runs]):8.2f} s")
        print(f"small picture, 4 clients     {median([four_clients(viewer, orbit, 100 + i, 0.31 + 0.1 * i) for i in range(3)]):8.2f} s")
        picks = []
        for i in range(options.repeats):
            eye, _ = orbit.pose(i)
            start = time.monotonic()
            socket.send({"type": "pick", "id": 1 + i, "project": "main", "origin": eye, "direction": [m - e for m, e in zip(orbit.middle, eye)],
                         "pixel_pitch": 0.001, "pixel_width_m": 0.0})
            socket.text("picked")
            picks.append(time.monotonic() - start)
        print(f"pick                         {1000 * median(picks):8.2f} ms")
        if options.moves:
            first, last = memory_over_moves(viewer, socket, orbit, options.moves)
            print(f"memory, first quarter        {first / 2**20:8.0f} MiB\nmemory, last quarter         {last / 2**20:8.0f} MiB, {last / first:.3f} times")
    finally:
        viewer.close()


if __name__ == "__main__":
    main()
