"""Trains the learned step of the automatic smoother (smoothing/automatic/learned) and writes its weights.

    train.py SITES WEIGHTS_CPP [--epochs N] [--seed N]

SITES: from train_sites (sites.cpp there says how the file is laid out). Learns, with Adam, to choose a height
whose squared distance to the true surface is small in the mean: not the height of the surface itself, which
nobody knows where a point may have come from either sheet of a wall. Every tenth cloud is kept out and only
measured. Same sites, seed and numpy: the same weights.
"""

import argparse
import time

import numpy as np

FIRST, SECOND = 128, 48  # units of the layers, as in weights.h
LEAK, FAR, REACH = 0.1, 6.0, 4.0  # as in network.cpp and sites.cpp
FARTHEST = 16  # s^2: strays are lost anyway


def read(name):
    with open(name, "rb") as file:
        version, even, odd, targets = np.frombuffer(file.read(16), np.int32)
        rows = np.fromfile(file, np.float32).reshape(-1, 1 + even + odd + targets)
    inputs = 1 + even + odd
    return version, even, rows[:, 0].astype(int), rows[:, 1:inputs], np.minimum(rows[:, inputs:], FARTHEST)


def leaky(a):
    return np.maximum(a, LEAK * a)


def slope(a):
    return np.where(a > 0, np.float32(1), np.float32(LEAK))


def distance(table, height):
    """Squared distance at the heights (s), from rows of distances on a grid, and its derivative."""
    step = 2 * REACH / (table.shape[1] - 1)
    at = np.clip((height + REACH) / step, 0, table.shape[1] - 1.001)
    low = at.astype(int)
    row = np.arange(len(height))
    a, b = table[row, low], table[row, low + 1]
    beyond = height - np.clip(height, -REACH, REACH)  # nothing is known there but that it is farther
    return a + (at - low) * (b - a) + beyond**2, (b - a) / step + 2 * beyond


class Network:
    def __init__(self, even, inputs, random):
        def weights(rows, columns):
            return (random.standard_normal((rows, columns)) * np.sqrt(2 / rows)).astype(np.float32)

        self.even = even
        self.parts = [weights(inputs, FIRST), np.zeros(FIRST, np.float32), weights(FIRST, SECOND),
                      np.zeros(SECOND, np.float32), 0.1 * weights(SECOND, 1)]

    def run(self, x):
        w, b, u, c, v = self.parts
        even, odd = x[:, :self.even] @ w[:self.even] + b, x[:, self.even:] @ w[self.even:]
        self.kept = []
        both = []
        for sign in (1, -1):
            first = even + sign * odd
            hidden = leaky(first)
            second = hidden @ u + c
            both.append(leaky(second) @ v)
            self.kept.append((first, hidden, second))
        return (0.5 * (both[0] - both[1]))[:, 0]

    def gradients(self, x, by_result):
        u, v = self.parts[2], self.parts[4]
        g = [np.zeros_like(p) for p in self.parts]
        by_first = []
        for sign, (first, hidden, second) in zip((1, -1), self.kept):
            by = (0.5 * sign * by_result)[:, None]
            g[4] += leaky(second).T @ by
            by_second = (by @ v.T) * slope(second)
            g[2] += hidden.T @ by_second
            g[3] += by_second.sum(0)
            by_first.append((by_second @ u.T) * slope(first))
        g[0][:self.even] = x[:, :self.even].T @ (by_first[0] + by_first[1])
        g[0][self.even:] = x[:, self.even:].T @ (by_first[0] - by_first[1])
        g[1] = (by_first[0] + by_first[1]).sum(0)
        return g


def train(network, x, table, weight, epochs, random, report):
    batch, rate, towards_zero = 512, 1e-3, 1e-5
    first = [np.zeros_like(p) for p in network.parts]
    second = [np.zeros_like(p) for p in network.parts]
    steps = epochs * (len(x) // batch)
    step, usual = 0, None  # length of the gradient
    for epoch in range(epochs):
        order = random.permutation(len(x))
        for begin in range(0, len(x) - batch + 1, batch):
            pick = order[begin:begin + batch]
            rows = x[pick]
            _, by = distance(table[pick], network.run(rows))
            by = (np.clip(by, -3, 3) * weight[pick] / batch).astype(np.float32)
            step += 1
            now = np.float32(rate * max(0.01, 0.5 * (1 + np.cos(np.pi * step / steps))))
            gradients = network.gradients(rows, by)
            length = np.sqrt(sum(float((g * g).sum()) for g in gradients))
            usual = length if usual is None else usual + 0.01 * (min(length, 3 * usual) - usual)
            shorter = np.float32(min(1, 3 * usual / max(length, 1e-30)))  # one batch must not undo the others
            for k, g in enumerate(gradients):
                g = shorter * g + np.float32(towards_zero) * network.parts[k]
                first[k] += np.float32(0.1) * (g - first[k])
                second[k] += np.float32(0.001) * (g * g - second[k])
                network.parts[k] -= now * (first[k] / np.float32(1 - 0.9**step)) / (
                    np.sqrt(second[k] / np.float32(1 - 0.999**step)) + np.float32(1e-8))
        report(epoch)


def whole(matrix, axis):
    """16-bit numbers and the unit of every row (axis 1) or of all (None)."""
    unit = np.maximum(np.abs(matrix).max(axis=axis), 1e-12) / 32767
    return np.rint(matrix / (unit[:, None] if axis == 1 else unit)).astype(int), unit


def write(name, version, centre, scale, parts):
    w, w_unit = whole(parts[0], 1)
    u, u_unit = whole(parts[2], 1)
    v, v_unit = whole(parts[4], None)

    def table(kind, label, values, number):
        text = ", ".join(number(x) for x in np.ravel(values))
        return f"const {kind} {label}[] = {{{text}}};\n"

    def real(x):
        return f"{float(x):.9e}F"

    with open(name, "w") as file:
        file.write("// Made by tests/bench/train/train.sh; not to be edited.\n"
                   '#include "smoothing/automatic/learned/weights.h"\n\n'
                   "// clang-format off\n"
                   "namespace rfsmooth::smoothing::learned {\n\n"
                   f'static_assert(kFormat == {version}, "weights of another format: train anew");\n'
                   f"static_assert(kInputs == {len(centre)} && kFirst == {FIRST} && kSecond == {SECOND});\n\n")
        file.write(table("float", "kCentre", centre, real) + table("float", "kScale", scale, real))
        file.write(table("float", "kFirstUnit", w_unit, real) + table("float", "kSecondUnit", u_unit, real))
        file.write(f"const float kLastUnit = {real(v_unit)};\n")
        file.write(table("float", "kFirstBias", parts[1], real) + table("float", "kSecondBias", parts[3], real))
        for label, values in (("kFirstWeight", w), ("kSecondWeight", u), ("kLastWeight", v)):
            file.write(table("std::int16_t", label, values, str))
        file.write("\n}  // namespace rfsmooth::smoothing::learned\n")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("sites")
    parser.add_argument("weights")
    parser.add_argument("--epochs", type=int, default=16)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    version, even, cloud, x, table = read(options.sites)
    held = cloud % 10 == 9
    centre = x[~held].mean(0)
    centre[even:] = 0
    scale = 1 / (np.sqrt(((x[~held] - centre)**2).mean(0)) + 1e-3)
    x = np.clip((x - centre) * scale, -FAR, FAR).astype(np.float32)
    # What counts is by what part the error of a cloud falls: thick shapes, which have little, as much as thin.
    at_rest = table[:, table.shape[1] // 2]
    error = np.bincount(cloud, at_rest) / np.maximum(np.bincount(cloud), 1)
    weight = (1 / (0.05 + error[cloud])).astype(np.float32)
    random = np.random.default_rng(options.seed)
    network = Network(even, x.shape[1], random)
    start = time.time()

    def report(epoch):
        result = distance(table[held], network.run(x[held]))[0]
        clouds = np.unique(cloud[held])
        sizes = np.bincount(cloud[held])
        ratio = (np.bincount(cloud[held], result) / np.maximum(sizes, 1))[clouds] / error[clouds]
        print(f"epoch {epoch + 1}, {time.time() - start:.0f} s: kept-out clouds {at_rest[held].mean():.4f} -> "
              f"{result.mean():.4f}; ratios: mean {ratio.mean():.3f}, largest {ratio.max():.3f}", flush=True)

    train(network, x[~held], table[~held], weight[~held], options.epochs, random, report)
    write(options.weights, version, centre, scale, network.parts)


if __name__ == "__main__":
    main()
