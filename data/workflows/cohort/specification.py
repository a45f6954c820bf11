"""Writes the study of the whole cohort: config["study"] with each patient's bone and the planned paths of the sides.

And a table that tells which patient has which number in the study.
"""
import csv
import json

params, files = snakemake.params, snakemake.input
bones = []
for number, (bone, plan) in enumerate(zip(files.bones, files.plans), start=1):
    with open(plan) as file:
        names = [path["name"] for path in json.load(file)["paths"]]
    paths = []
    for side in params.sides:
        found = [name for name in names if side in name]
        if len(found) != 1:
            raise SystemExit(f"expected one path of the {side} side in {plan}, found {names}")
        paths += found
    bones.append({"bone": bone, "patient": number, "plan": plan, "paths": paths})
study = {"name": "cohort", **params.study, "format": "spinaltap-study", "version": 2, "bones": bones}
with open(snakemake.output.study, "w") as file:
    json.dump(study, file, indent=2)
with open(snakemake.output.patients, "w", newline="") as file:
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(["patient", "name"])
    writer.writerows(enumerate(params.patients, start=1))
