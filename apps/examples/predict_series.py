#!/usr/bin/env python3
"""Predicts how many screws of published series of robots come out with which grade, from their errors alone.

    predict_series.py VERTEBRA... -o FOLDER [--spinaltap PROGRAM] [--runs N]

VERTEBRA: bone.vdb files, or closed meshes of vertebrae in mm (STL, PLY, OBJ), which are scanned first; MESH:ALS says to
which sides of the patient its axes point, where that is not LPS. Each pedicle gets the
screw that `plan --auto` would take. The series say how far screws ended from their plans, as lengths, and not to which
side: what they do not say is varied, one thing at a time and in pairs, and the predictions' range is told beside the
published shares. Nothing is fitted: no number below was changed after the first run (see docs/series.md).

Research and training software, not a medical device.
"""

import argparse
import csv
import json
import math
import pathlib
import subprocess
import sys

# Means and standard deviations: mm at the screw's tip and tail (its entry), degrees. Shares: % of the screws, and of how
# many. Where a series has no deviations, those of the first, of the same robot, as parts of the means.
SERIES = [
    {
        "name": "726 screws",
        "source": "BMC Surgery 2022, doi 10.1186/s12893-022-01838-y",
        "tip": (1.9, 1.5),
        "tail": (2.2, 1.4),
        "angle": (2.9, 2.3),
        "screws": 726,
        "shares": {"A+B": 97.9, "C": 1.7, "D": 0.4, "E": 0.0},
    },
    {
        "name": "326 screws",
        "source": "Operative Neurosurgery 24:242-247, 2023 (its summary)",
        "tip": (1.9, None),
        "tail": (2.0, None),
        "angle": (2.6, None),
        "screws": 326,
        "shares": {"A": 82.0, "B": 15.5, "A+B": 97.5, "C": 1.5, "D": 1.0, "E": 0.0},
    },
    {
        "name": "292 screws",
        "source": "Journal of Robotic Surgery 2019, doi 10.1007/s11701-019-01007-z (its summary)",
        "tip": (1.9, None),
        "tail": (2.3, None),
        "angle": (2.8, None),
        "screws": 292,
        "shares": {"A+B": 98.3, "C": 1.0, "D": 0.7, "E": 0.0},
    },
]

# What no series says. `medial`: share of the mean square that goes to the left and right; `bias`: towards where entries
# err on the whole, by half of their root mean square; `length`: of the screws, mm, by which the tip's error tells how
# entry and direction go together.
VARIANTS = [{"medial": 0.5, "bias": None, "length": 45.0}]
VARIANTS += [{"medial": medial, "bias": None, "length": 45.0} for medial in (0.0, 1.0)]
VARIANTS += [{"medial": 0.5, "bias": None, "length": length} for length in (40.0, 50.0)]
VARIANTS += [
    {"medial": medial, "bias": bias, "length": 45.0}
    for medial in (0.0, 0.5, 1.0)
    for bias in ("medial", "lateral", "cranial", "caudal")
]
GRADES = ("A", "B", "C", "D", "E")


def with_deviation(figure, like):
    mean, deviation = figure
    return (mean, deviation if deviation is not None else mean * like[1] / like[0])


def weibull_shape(mean, deviation):
    """Of the law of lengths with that mean and deviation."""
    low, high = 0.5, 50.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        variation = math.sqrt(max(0.0, math.gamma(1 + 2 / middle) / math.gamma(1 + 1 / middle) ** 2 - 1))
        low, high = (middle, high) if variation > deviation / mean else (low, middle)
    return 0.5 * (low + high)


def sides(total, medial_share, bias=None, size=0.0):
    """Means and deviations to the sides, of a mean square `total` that the bias is a part of."""
    rest = total - size * size
    means = {
        "medial": {"medial": size, "lateral": -size}.get(bias, 0.0),
        "cranial": {"cranial": size, "caudal": -size}.get(bias, 0.0),
    }
    return {
        "medial": {"mean": means["medial"], "sd": math.sqrt(medial_share * rest)},
        "cranial": {"mean": means["cranial"], "sd": math.sqrt((1 - medial_share) * rest)},
    }


def model_of(series, variant):
    """The series' errors as spinaltap takes them, with what it does not say as the variant has it."""
    first = SERIES[0]
    tip, tail, angle = (with_deviation(series[key], first[key]) for key in ("tip", "tail", "angle"))
    square = {name: mean * mean + sd * sd for name, (mean, sd) in (("tip", tip), ("tail", tail), ("angle", angle))}
    size = 0.5 * math.sqrt(square["tail"]) if variant["bias"] else 0.0
    entry = sides(square["tail"], variant["medial"], variant["bias"], size)
    turn = sides(square["angle"], variant["medial"])
    spread = math.sqrt(square["tail"] - size * size)
    reach = math.sqrt(square["angle"]) * math.pi / 180 * variant["length"]
    together = (square["tip"] - square["tail"] - reach * reach) / (2 * spread * reach)
    return {
        "format": "spinaltap-placement-errors",
        "version": 2,
        "name": series["name"],
        "sources": [series["source"]],
        "entry": {
            "medial_mm": entry["medial"],
            "cranial_mm": entry["cranial"],
            "shape": weibull_shape(*tail),
        },
        "direction": {
            "medial_deg": turn["medial"],
            "cranial_deg": turn["cranial"],
            "shape": weibull_shape(*angle),
        },
        "correlation": max(-1.0, min(1.0, together)),
    }


def run(program, *arguments):
    done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{program} {' '.join(map(str, arguments))}:\n{done.stderr}")


def bone_of(program, vertebra, folder):
    """The vertebra's grid: made from its mesh where it is one."""
    name, _, axes = str(vertebra).partition(":")
    vertebra = pathlib.Path(name)
    if vertebra.suffix == ".vdb":
        return vertebra.resolve()
    made = folder / "bones" / vertebra.stem
    if not (made / "ground_truth.vdb").exists():
        made.parent.mkdir(parents=True, exist_ok=True)
        run(program, "phantom", made, "--mesh", vertebra, "--units", "mm", "--axes", axes or "LPS", "--force")
    return (made / "ground_truth.vdb").resolve()


def shares_of(program, folder, bones, model, runs, seed):
    """% of each grade, from `runs` draws of the model for each screw; and the 95 % interval of A and B together."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "errors.json").write_text(json.dumps(model, indent=1))
    spec = {
        "format": "spinaltap-study",
        "version": 2,
        "name": model["name"],
        "kind": "geometry",
        "bones": bones,
        "errors": "errors.json",
        "design": {"runs": runs, "seed": seed},
    }
    (folder / "study.json").write_text(json.dumps(spec, indent=1))
    run(program, "study", folder / "study.json", "-o", folder / "out", "--force")
    with open(folder / "out" / "runs.csv", newline="") as file:
        grades = [row["screw_grade"] for row in csv.DictReader(file)]
    shares = {grade: 100 * grades.count(grade) / len(grades) for grade in GRADES}
    shares["A+B"] = shares["A"] + shares["B"]
    return shares


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("vertebrae", nargs="+", type=pathlib.Path, metavar="VERTEBRA")
    parser.add_argument("-o", "--output", type=pathlib.Path, required=True, metavar="FOLDER")
    parser.add_argument("--spinaltap", default="spinaltap", metavar="PROGRAM")
    parser.add_argument("--runs", type=int, default=500, metavar="N", help="draws for each screw and variant")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    options.output.mkdir(parents=True, exist_ok=True)

    bones, screws = [], 0
    for patient, vertebra in enumerate(options.vertebrae, 1):
        bone = bone_of(options.spinaltap, vertebra, options.output)
        plan = options.output / "plans" / f"{patient}.json"
        plan.parent.mkdir(exist_ok=True)
        if not plan.exists():
            run(options.spinaltap, "plan", bone, "--auto", "--errors", "none", "-o", plan)
        screws += len(json.loads(plan.read_text())["paths"])
        bones.append({"bone": str(bone), "plan": str(plan.resolve()), "patient": patient})
    print(f"{len(bones)} vertebrae, {screws} screws, {options.runs} draws of each and each variant")

    results = []
    for series in SERIES:
        predicted = []
        for n, variant in enumerate(VARIANTS):
            place = options.output / series["name"].replace(" ", "_") / f"variant_{n:02}"
            shares = shares_of(options.spinaltap, place, bones, model_of(series, variant), options.runs, options.seed)
            predicted.append({"variant": variant, "shares": shares})
        results.append({"series": series, "predicted": predicted})
        print(f"\n{series['name']} ({series['source']})")
        print("            published   alike to all sides   as what is not said varies")
        for grade in ("A", "B", "A+B", "C", "D", "E"):
            values = [one["shares"][grade] for one in predicted]
            published = series["shares"].get(grade)
            text = f"{published:9.1f}" if published is not None else "        -"
            print(f"  {grade:>4}     {text}   {values[0]:18.1f}   {min(values):9.1f} to {max(values):.1f}")
    (options.output / "predicted.json").write_text(json.dumps(results, indent=1))


if __name__ == "__main__":
    main()
