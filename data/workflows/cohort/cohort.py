"""Joins the studies of a cohort: one table of all runs, and a page with the share of each grade by screw and of all.

The interval of all screws knows that runs of one patient belong together: patients are drawn again, with replacement.
"""
import csv
import html
import random

SEED, DRAWS = 1, 2000
GRADES = "ABCDE"


def share(runs):
    return sum(grade <= 1 for grade in runs) / len(runs)


def bootstrap(patients):
    """Of the share of A and B, from 2.5 to 97.5 %; `patients`: the grades of each."""
    numbers = random.Random(SEED)
    drawn = sorted(
        share([grade for _ in patients for grade in numbers.choice(patients)]) for _ in range(DRAWS)
    )
    return drawn[int(0.025 * DRAWS)], drawn[int(0.975 * DRAWS) - 1]


def cells(values, kind="td"):
    return "<tr>" + "".join(f"<{kind}>{html.escape(str(value))}</{kind}>" for value in values) + "</tr>\n"


def row(name, side, grades, link=""):
    counts = [f"{100 * sum(grade == n for grade in grades) / len(grades):.1f}" for n in range(len(GRADES))]
    text = cells([name, side, len(grades), *counts, f"{100 * share(grades):.1f}"])
    return text.replace("<td>", f'<td><a href="{html.escape(link)}">', 1).replace("</td>", "</a></td>", 1) if link else text


rows, by_patient, body = [], {}, ""
head = None
for (patient, side), name in zip(snakemake.params.studies, snakemake.input):
    with open(name, newline="") as file:
        reader = csv.reader(file)
        columns = next(reader)
        if head not in (None, columns):
            raise SystemExit(f"the columns of {name} are others: expected those of {snakemake.input[0]}")
        head = columns
        grades = []
        for values in reader:
            rows.append([patient, side, *values])
            grades.append(GRADES.index(values[head.index("grade")]))
    by_patient.setdefault(patient, []).extend(grades)
    body += row(patient, side, grades, f"merged/{patient}-{side}/report.html")
with open(snakemake.output.table, "w", newline="") as file:
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(["patient", "side", *head])
    writer.writerows(rows)

everyone = [grade for grades in by_patient.values() for grade in grades]
low, high = bootstrap(list(by_patient.values()))
with open(snakemake.output.report, "w") as file:
    file.write(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Cohort</title><style>"
        "body{font:15px/1.5 sans-serif;max-width:60em;margin:2em auto}td,th{padding:.2em .8em;text-align:right}"
        "</style></head><body>\n<h1>Cohort</h1>\n"
        f"<p>{len(by_patient)} patients, {len(snakemake.input)} screws, {len(everyone)} runs. Shares of the bit's "
        "Gertzbein-Robbins grades, in per cent.</p>\n<table>\n"
        + cells(["patient", "side", "runs", *GRADES, "A and B"], "th")
        + body
        + row("all", "", everyone)
        + f"</table>\n<p>A and B of all: {100 * share(everyone):.1f} %, 95 % interval {100 * low:.1f} to "
        f"{100 * high:.1f} % (bootstrap over patients, {DRAWS} draws, seed {SEED}).</p>\n"
        "<p>Research and training software, not a medical device.</p>\n</body></html>\n"
    )
