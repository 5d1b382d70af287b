#!/usr/bin/env python3
"""Trains and evaluates the field of `skyquilt bench kernel` in PyTorch on the CPU and prints samples per second.

  /usr/bin/python3 scripts/compare_pytorch.py
  /usr/bin/python3 scripts/compare_pytorch.py --skyquilt build/release/skyquilt
  /usr/bin/python3 scripts/compare_pytorch.py --threads 1 --batch 262144 --rounds 5

Needs PyTorch. Debian: apt-get install python3-torch libopenblas0-pthread (without OpenBLAS, matrix products use the slow
reference BLAS). With --skyquilt, `skyquilt bench kernel` runs on the same sizes and threads, one round after each round of
PyTorch. Do not use the machine meanwhile. Exit status: 0 done, 1 skyquilt failed, 2 wrong usage or no PyTorch.
"""
import argparse
import json
import math
import os
import statistics
import subprocess
import sys
import time

try:
    import torch
    import torch.nn.functional as F
except ImportError:
    torch = None

BASE_RESOLUTION = 16
FINEST_RESOLUTION = 2048
GEOMETRY = 16  # outputs of the density network
SAMPLES_PER_RAY = 16
HASH = (1, 2654435761 - 2**32, 805459861)  # as signed 32-bit numbers; the low bits, which are used, are the same


class Encoding:
    """Multi-resolution hash grid over the unit cube (Mueller et al. 2022): one embedding table per level."""

    def __init__(self, levels, features, log2_table_size):
        growth = math.exp(math.log(FINEST_RESOLUTION / BASE_RESOLUTION) / (levels - 1)) if levels > 1 else 1.0
        self.levels = []  # resolution, factor of each coordinate, dense, entries
        for level in range(levels):
            resolution = BASE_RESOLUTION * growth**level
            points = math.ceil(resolution - 1e-9) + 1
            dense = points**3 <= 2**log2_table_size
            factors = (1, points, points * points) if dense else HASH
            entries = points**3 if dense else 2**log2_table_size
            self.levels.append((resolution, torch.tensor(factors, dtype=torch.int32).view(1, 3, 1), dense, entries))
        self.tables = [torch.empty(entries, features).uniform_(-1e-4, 1e-4).requires_grad_() for *_, entries in self.levels]

    def __call__(self, position):
        """position: 3 rows of n."""
        return torch.cat([Lookup.apply(table, *self.corners(position, level)) for table, level in zip(self.tables, self.levels)], dim=1)

    @staticmethod
    def corners(position, level):
        """Entries and trilinear weights of the eight corners, both n x 8.

        Computed in rows of n with 32-bit integers, which is several times faster than n x 2 x 2 x 2 with 64 bits.
        """
        resolution, factors, dense, entries = level
        scaled = position * resolution
        low = scaled.floor()
        fraction = scaled - low
        low = low.int()
        x, y, z = (torch.stack([low, low + 1]) * factors).unbind(1)
        x, y, z = x[None, None, :], y[None, :, None], z[:, None, None]
        index = x + y + z if dense else (x ^ y ^ z) & (entries - 1)
        wx, wy, wz = torch.stack([1 - fraction, fraction]).unbind(1)
        weight = wx[None, None, :] * wy[None, :, None] * wz[:, None, None]
        return index.view(8, -1).t().contiguous(), weight.view(8, -1).t().contiguous()


if torch is not None:
    class Lookup(torch.autograd.Function):
        """Weighted sum of eight table rows, by the fastest of embedding, embedding_bag, indexing and their backward passes.

        embedding_bag does not store the rows in between. scatter_add_ per feature adds gradients several times faster than the backward
        passes of these functions. Sparse gradients are slower still, because SparseAdam must sort them.
        """

        @staticmethod
        def forward(ctx, table, index, weight):
            ctx.save_for_backward(index, weight)
            ctx.entries = table.shape[0]
            return F.embedding_bag(index, table, per_sample_weights=weight, mode="sum")

        @staticmethod
        def backward(ctx, gradient):
            index, weight = ctx.saved_tensors
            index = index.view(-1).long()
            table_gradient = torch.zeros(ctx.entries, gradient.shape[1])
            for feature in range(gradient.shape[1]):
                table_gradient[:, feature].scatter_add_(0, index, (weight * gradient[:, feature:feature + 1]).view(-1))
            return table_gradient, None, None


def spherical_harmonics(direction):
    """16 values (bands 0 to 3) of each unit direction."""
    x, y, z = direction.unbind(1)
    x2, y2, z2 = x * x, y * y, z * z
    return torch.stack([
        torch.full_like(x, 0.28209479), -0.48860251 * y, 0.48860251 * z, -0.48860251 * x,
        1.09254843 * x * y, -1.09254843 * y * z, 0.94617470 * z2 - 0.31539157, -1.09254843 * x * z, 0.54627422 * (x2 - y2),
        0.59004359 * y * (y2 - 3 * x2), 2.89061144 * x * y * z, 0.45704580 * y * (1 - 5 * z2), 0.37317633 * z * (5 * z2 - 3),
        0.45704580 * x * (1 - 5 * z2), 1.44530572 * z * (x2 - y2), 0.59004359 * x * (3 * y2 - x2),
    ], dim=1)


class Network:
    """Fully connected, without biases, relu between the layers."""

    def __init__(self, *widths):
        self.weights = [torch.nn.init.xavier_uniform_(torch.empty(after, before)).requires_grad_() for before, after in zip(widths, widths[1:])]

    def __call__(self, x):
        for weight in self.weights[:-1]:
            x = F.relu(F.linear(x, weight), inplace=True)
        return F.linear(x, self.weights[-1])


class Field:
    def __init__(self, options):
        self.encoding = Encoding(options.levels, options.features, options.log2_table_size)
        self.density = Network(options.levels * options.features, options.hidden, GEOMETRY)
        self.color = Network(GEOMETRY + 16, options.hidden, options.hidden, 3)
        self.parameters = self.encoding.tables + self.density.weights + self.color.weights

    def __call__(self, position, direction):
        """Optical depth tau (rays x samples) and colour (rays x samples x 3); one direction per ray."""
        geometry = self.density(self.encoding(position))
        tau = torch.exp(geometry[:, 0] - 5)
        harmonics = spherical_harmonics(direction)[:, None].expand(-1, SAMPLES_PER_RAY, -1).reshape(-1, 16)
        color = torch.sigmoid(self.color(torch.cat([geometry, harmonics], dim=1)))
        return tau.view(-1, SAMPLES_PER_RAY), color.view(-1, SAMPLES_PER_RAY, 3)


def composite(tau, color):
    """Colour of each ray on a black background."""
    tau_behind = torch.cumsum(tau, dim=1)
    weight = torch.exp(tau - tau_behind) - torch.exp(-tau_behind)
    return (weight[:, :, None] * color).sum(dim=1)


def adam(parameters):
    settings = {"lr": 1e-4, "betas": (0.9, 0.99), "eps": 1e-15}
    try:
        return torch.optim.Adam(parameters, fused=True, **settings)  # one pass over each parameter; on the CPU since PyTorch 2.4
    except (TypeError, RuntimeError):
        return torch.optim.Adam(parameters, **settings)


class Bench:
    def __init__(self, options):
        torch.set_num_threads(options.threads)
        torch.manual_seed(7)
        rays = options.batch // SAMPLES_PER_RAY
        self.batch = options.batch
        self.position = torch.rand(3, self.batch)
        self.direction = F.normalize(torch.randn(rays, 3), dim=1)
        self.target = torch.rand(rays, 3)
        self.field = Field(options)
        self.optimizer = adam(self.field.parameters)
        self.train()  # allocates the memory that later steps use again
        self.infer()

    def train(self):
        loss = F.mse_loss(composite(*self.field(self.position, self.direction)), self.target)
        self.optimizer.zero_grad(set_to_none=True)
        loss.backward()
        self.optimizer.step()

    def infer(self):
        # Density and colour, like skyquilt's inference rate.
        with torch.inference_mode():
            self.field(self.position, self.direction)

    def rate(self, work, seconds):
        """Samples per second, measured for about `seconds` and at least one batch."""
        start = time.perf_counter()
        batches = 0
        while batches == 0 or time.perf_counter() - start < seconds:
            work()
            batches += 1
        return batches * self.batch / (time.perf_counter() - start)


def skyquilt_rates(options):
    """(training, inference) of one round of `skyquilt bench kernel` on the same sizes."""
    command = [options.skyquilt, "bench", "kernel", "--json", "--rounds", "1", "--samples-per-ray", str(SAMPLES_PER_RAY)]
    for name in ("levels", "features", "log2_table_size", "hidden", "batch", "seconds", "threads"):
        command += ["--" + name.replace("_", "-"), str(getattr(options, name))]
    try:
        run = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)
    except OSError as error:
        sys.exit(f"compare_pytorch: cannot run {options.skyquilt}: {error.strerror}")
    if run.returncode != 0:
        sys.exit(f"compare_pytorch: {' '.join(command)} ended with status {run.returncode}:\n{run.stderr.strip()}")
    try:
        figures = json.loads(run.stdout)
        return figures["train_samples_per_second"], figures["infer_samples_per_second"]
    except (ValueError, KeyError):
        sys.exit(f"compare_pytorch: {' '.join(command)} did not print its results as JSON")


def parse():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    parser.add_argument("--skyquilt", metavar="PROGRAM", help="compare with this skyquilt")
    parser.add_argument("--batch", type=int, default=65536, metavar="N", help="samples per step (default: %(default)s)")
    parser.add_argument("--threads", type=int, default=cores, metavar="N", help="number of threads (default: all cores, %(default)s)")
    parser.add_argument("--seconds", type=float, default=5.0, metavar="S", help="training time per round; inference takes half as long (default: %(default)s)")
    parser.add_argument("--rounds", type=int, default=3, metavar="N", help="number of rounds to take the median of (default: %(default)s)")
    parser.add_argument("--levels", type=int, default=16, metavar="N", help="resolution levels of the hash grid (default: %(default)s)")
    parser.add_argument("--features", type=int, default=2, metavar="N", help="features per table entry, 2 or 4 (default: %(default)s)")
    parser.add_argument("--log2-table-size", type=int, default=19, metavar="N", help="entries per level, log2 (default: %(default)s)")
    parser.add_argument("--hidden", type=int, default=64, metavar="N", help="width of the hidden layers (default: %(default)s)")
    options = parser.parse_args()
    for ok, rule in ((options.batch >= 1024, "--batch must be at least 1024"),
                     (options.batch % SAMPLES_PER_RAY == 0, f"--batch must be a multiple of {SAMPLES_PER_RAY}"),
                     (options.threads >= 1, "--threads must be at least 1"),
                     (0.01 <= options.seconds <= 600, "--seconds must be 0.01 to 600"),
                     (options.rounds >= 1, "--rounds must be at least 1"),
                     (1 <= options.levels <= 16, "--levels must be 1 to 16"),
                     (options.features in (2, 4), "--features must be 2 or 4"),
                     (options.levels * options.features % 4 == 0, "--levels times --features must be a multiple of 4"),
                     (1 <= options.log2_table_size <= 24, "--log2-table-size must be 1 to 24"),
                     (4 <= options.hidden <= 256 and options.hidden % 4 == 0, "--hidden must be a multiple of 4 up to 256")):
        if not ok:
            parser.error(rule)
    return options


def main():
    options = parse()
    if torch is None:
        print(f"compare_pytorch: PyTorch is not installed for {sys.executable}.\n"
              "Debian: apt-get install python3-torch libopenblas0-pthread, then /usr/bin/python3 scripts/compare_pytorch.py\n"
              "(a python3 of pyenv or conda does not see Debian's packages).", file=sys.stderr)
        return 2
    bench = Bench(options)
    rounds = {"PyTorch": [], "Skyquilt": []}
    for _ in range(options.rounds):
        rounds["PyTorch"].append((bench.rate(bench.train, options.seconds), bench.rate(bench.infer, 0.5 * options.seconds)))
        if options.skyquilt:
            rounds["Skyquilt"].append(skyquilt_rates(options))

    print(f"{options.levels} levels x {options.features} features, 2^{options.log2_table_size} entries, {options.hidden}-wide networks, "
          f"{options.batch} samples per batch, {options.threads} thread{'s' if options.threads > 1 else ''}, PyTorch {torch.__version__}")
    print(f"Million samples per second, median of {options.rounds} round{'s' if options.rounds > 1 else ''} (slowest to fastest)")
    for column, what in enumerate(("training", "inference")):
        medians = {}
        for name, rates in rounds.items():
            if not rates:
                continue
            values = [1e-6 * rate[column] for rate in rates]
            medians[name] = statistics.median(values)
            print(f"  {what:<11}{name:<10}{medians[name]:8.3f}  ({min(values):.3f} to {max(values):.3f})")
        if "Skyquilt" in medians:
            print(f"  {what:<11}{'ratio':<10}{medians['Skyquilt'] / medians['PyTorch']:8.1f}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
