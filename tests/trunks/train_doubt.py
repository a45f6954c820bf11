#!/usr/bin/python3
"""usage: train_doubt.py TRAINING.csv UNSEEN.csv...

Whether doubt that is learned is better than the rules' severity. From TRAINING, levels of random trunks as trunk_levels
writes them, it learns how likely a level that was found is wrong: by logistic regression on all figures, on the two that
mean the same in phantoms and in real CTs, and by boosted trees. Settings are chosen by cross-validation over trunks.
For the training's trunks, left out in turns, and for each other table it prints how well each tells wrong levels from
right ones. The same tables give the same lines.
"""
import csv
import sys

import numpy

FIRST_FIGURE = "probability"  # figures stand behind this column
FOLDS = 6


def read_levels(file):
    with open(file, newline="") as table:
        rows = [row for row in csv.DictReader(table) if row["found"] == "1"]
    columns = list(rows[0])
    names = columns[columns.index(FIRST_FIGURE) + 1:]
    figures = numpy.array([[float(row[name]) for name in names] for row in rows])
    wrong = numpy.array([float(row["is_wrong"]) for row in rows])
    seeds = numpy.array([row["seed"] for row in rows])
    return names, figures, wrong, seeds


def probability(logit):
    return 1.0 / (1.0 + numpy.exp(-numpy.clip(logit, -30.0, 30.0)))


def log_loss(p, wrong):
    p = numpy.clip(p, 1e-6, 1.0 - 1e-6)
    return float(-numpy.mean(wrong * numpy.log(p) + (1.0 - wrong) * numpy.log(1.0 - p)))


class Regression:
    """Logistic regression with a square penalty, on figures in units of their spread, cut at three of them."""

    settings = (0.3, 1.0, 3.0, 10.0, 30.0)

    def __init__(self, penalty):
        self.penalty = penalty

    def scaled(self, figures):
        return numpy.clip((figures - self.mean) / self.spread, -3.0, 3.0)

    def learn(self, figures, wrong):
        self.mean = figures.mean(axis=0)
        self.spread = numpy.maximum(figures.std(axis=0), 1e-3)
        x = numpy.column_stack([numpy.ones(len(wrong)), self.scaled(figures)])
        keep = numpy.diag([1e-6] + [self.penalty] * figures.shape[1])
        self.weights = numpy.zeros(x.shape[1])
        for _ in range(60):  # Newton's method
            p = probability(x @ self.weights)
            slope = x.T @ (wrong - p) - keep @ self.weights
            bend = x.T @ (x * (p * (1.0 - p))[:, None]) + keep
            step = numpy.linalg.solve(bend, slope)
            self.weights += step * min(1.0, 2.0 / max(1e-9, float(numpy.abs(step).max())))
            if numpy.abs(step).max() < 1e-9:
                break
        return self

    def __call__(self, figures):
        return probability(self.weights[0] + self.scaled(figures) @ self.weights[1:])


class Trees:
    """Boosted trees of two questions each (Friedman 2001), by Newton steps."""

    settings = (10, 20, 40, 80)
    rate, penalty, least = 0.1, 3.0, 8

    def __init__(self, count):
        self.count = count

    def best_split(self, figures, slope, bend, rows):
        best = None
        for column in range(figures.shape[1]):
            values = figures[rows, column]
            for at in numpy.unique(numpy.quantile(values, numpy.linspace(0.05, 0.95, 16))):
                low = values <= at
                if low.sum() < self.least or (~low).sum() < self.least:
                    continue
                gain = 0.0
                for part in (low, ~low):
                    gain += slope[rows][part].sum() ** 2 / (bend[rows][part].sum() + self.penalty)
                if best is None or gain > best[0] + 1e-12:
                    best = (gain, column, at)
        return best

    def learn(self, figures, wrong):
        share = wrong.mean()
        self.start = float(numpy.log(share / (1.0 - share)))
        logit = numpy.full(len(wrong), self.start)
        self.trees = []
        for _ in range(self.count):
            p = probability(logit)
            slope, bend = wrong - p, p * (1.0 - p)
            leaves = []
            first = self.best_split(figures, slope, bend, numpy.arange(len(wrong)))
            for is_low in (True, False):
                rows = numpy.flatnonzero((figures[:, first[1]] <= first[2]) == is_low)
                second = self.best_split(figures, slope, bend, rows)
                parts = [(None, None, True)] if second is None else [(*second[1:], True), (*second[1:], False)]
                for column, at, side in parts:
                    inside = rows if column is None else rows[(figures[rows, column] <= at) == side]
                    value = self.rate * slope[inside].sum() / (bend[inside].sum() + self.penalty)
                    leaves.append((is_low, column, at, side, value))
                    logit[inside] += value
            self.trees.append((first[1], first[2], leaves))
        return self

    def __call__(self, figures):
        logit = numpy.full(len(figures), self.start)
        for column, at, leaves in self.trees:
            low = figures[:, column] <= at
            for is_low, second, second_at, side, value in leaves:
                inside = low == is_low
                if second is not None:
                    inside = inside & ((figures[:, second] <= second_at) == side)
                logit[inside] += value
        return probability(logit)


def chosen(kind, figures, wrong, seeds):
    """The setting with the least loss over trunks that were left out, in turns; its p for those."""
    trunks = sorted(set(seeds), key=int)
    fold = numpy.array([trunks.index(seed) % FOLDS for seed in seeds])
    best = None
    for setting in kind.settings:
        p = numpy.zeros(len(wrong))
        for left_out in range(FOLDS):
            learned = kind(setting).learn(figures[fold != left_out], wrong[fold != left_out])
            p[fold == left_out] = learned(figures[fold == left_out])
        loss = log_loss(p, wrong)
        if best is None or loss < best[0]:
            best = (loss, setting, p)
    return best


def area(p, wrong):
    """Chance that a wrong level has more doubt than a right one."""
    bad, good = p[wrong == 1.0], p[wrong == 0.0]
    return float(numpy.mean((bad[:, None] > good[None, :]) + 0.5 * (bad[:, None] == good[None, :])))


def judge(name, p, wrong, limit):
    suspect = p >= limit
    print(f"  {name:22}{area(p, wrong):6.3f}{suspect[wrong == 0.0].mean():16.1%}"
          f"{int((~suspect & (wrong == 1.0)).sum()):14d} of {int(wrong.sum())}")


def main():
    tables = [read_levels(file) for file in sys.argv[1:]]
    names, figures, wrong, seeds = tables[0]
    rules = names.index("rules")
    few = [names.index(name) for name in ("unsure", "fused")]
    everything = [n for n in range(len(names)) if n != rules]
    ways = []
    for name, kind, columns in (("regression, 2 figures", Regression, few),
                                ("regression", Regression, everything), ("trees", Trees, everything)):
        loss, setting, p = chosen(kind, figures[:, columns], wrong, seeds)
        limit = float(numpy.quantile(p[wrong == 0.0], 0.9))  # a tenth of the right ones is suspect
        ways.append((name, columns, kind(setting).learn(figures[:, columns], wrong), p, limit))
    for n, file in enumerate(sys.argv[1:]):
        _, of_file, is_wrong, _ = tables[n]
        print(f"{file}: {len(is_wrong)} levels found, {int(is_wrong.sum())} wrong"
              f"{', left out in turns' if n == 0 else ''}\n"
              f"  {'':22}{'area':>6}{'right, suspect':>16}{'wrong, not suspect':>20}")
        judge("rules", of_file[:, rules], is_wrong, 0.5)
        for name, columns, learned, left_out, limit in ways:
            judge(name, left_out if n == 0 else learned(of_file[:, columns]), is_wrong, limit)


if __name__ == "__main__":
    main()
