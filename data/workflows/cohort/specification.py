"""Writes the study of one planned screw: config["study"] with its bone, its plan and its path."""
import json
import os

output = snakemake.output[0]
side = snakemake.wildcards.side
with open(snakemake.input.plan) as file:
    names = [path["name"] for path in json.load(file)["paths"]]
paths = [name for name in names if side in name]
if len(paths) != 1:
    raise SystemExit(f"expected one path of the {side} side in {snakemake.input.plan}, found {names}")
folder = os.path.dirname(output)
study = dict(snakemake.params.study)
study.update(
    format="spinaltap-study",
    version=2,
    name=f"{snakemake.wildcards.patient}, {side}",
    bone=os.path.relpath(snakemake.input.bone, folder),
    plan=os.path.relpath(snakemake.input.plan, folder),
    path=paths[0],
)
with open(output, "w") as file:
    json.dump(study, file, indent=2)
