#!/bin/bash
# ./run cluster-test: studies and the cohort's workflow on a Slurm of this computer's own; docs/cluster.md.
#   cluster_test.sh PROGRAM SOURCE_FOLDER [FOLDER]
# As root, with slurm-wlm, munge and snakemake installed. Everything is in a temporary folder, or in FOLDER, which is kept.
set -euo pipefail
program=$(realpath "$1")
source_folder=$(realpath "$2")
if [ $# -gt 2 ]; then
  mkdir -p "$3"
  here=$(realpath "$3")
  keeps=yes
else
  here=$(mktemp -d /tmp/spinaltap-cluster-XXXXXX)
  keeps=
fi
chmod 0755 "$here"  # munge works in no other
export SPINALTAP_DATA_DIR=${SPINALTAP_DATA_DIR:-$source_folder/data}
export USER=${USER:-root} TMPDIR=$here/tmp
mkdir -p "$TMPDIR"
cd "$here"
# shellcheck source=tests/cluster/slurm.sh
. "$source_folder/tests/cluster/slurm.sh"

step() { echo "[$SECONDS s] $*"; }
wrong() { echo "cluster-test: $*" >&2; exit 1; }
# Runs the program; what it prints is seen only where it fails.
tap() { "$program" "$@" >>"$here/program.log" 2>&1 || { tail -n 5 "$here/program.log" >&2; wrong "failed: $*"; }; }
same() {
  local file
  for file in runs.csv summary.json breach_map.csv report.html; do
    cmp "$1/$file" "$2/$file" || wrong "$file of $2 differs"
  done
}
clean_up() {
  local code=$?
  set +e
  if [ "$code" -ne 0 ]; then
    [ ! -f "${SLURM_CONF:-none}" ] || squeue >&2
    tail -n 15 "$here"/*/slurm/*.log "$here"/*.log >&2
  fi
  end_slurm
  [ -n "$keeps" ] || rm -rf "$here"
  exit "$code"
}
trap clean_up EXIT
trap 'exit 1' INT TERM

# --- A study on one computer, in three ways -----------------------------------------------------------------------
step "a vertebra, and its study on this computer"
tap phantom l3 --size 128 --pixel 1 --slices 40 --slice-step 1.2
cat >study.json <<'JSON'
{
  "format": "spinaltap-study", "version": 2, "name": "cluster-test",
  "bone": "l3/ground_truth.vdb", "plan": "l3/plan.json", "path": "left",
  "volume": {"spacing_mm": 0.15},
  "operator": {"kind": "feed", "feed_mm_s": 1.0, "step_mm": 0.003, "tremor_mm": 0.05},
  "design": {"runs": 60, "sampling": "latin-hypercube", "seed": 1, "factors": {
    "entry_left_mm": {"normal": {"mean": 0.0, "deviation": 1.5}},
    "angle_head_deg": {"normal": {"mean": 0.0, "deviation": 2.0}}}}
}
JSON
tap study study.json -o one --threads 1
tap study study.json -o two --threads 2
same one two
for shard in 1 2 3 4; do tap study study.json -o shards --shard "$shard/4"; done
tap merge shards --force
same one shards
step "the same bytes with one thread, two, and four shards"

# --- Slurm ----------------------------------------------------------------------------------------------------------
step "Slurm begins"
start_slurm "$here/slurm-state"

state_of() { squeue --noheader --array --jobs="$1" --format=%T 2>/dev/null || true; }
rows_of() { cat array/part-"$1"-of-4.* 2>/dev/null | wc -l; }
has_rows() { [ "$(rows_of "$1")" -ge "$2" ]; }
is_gone() { [ -z "$(state_of "$1")" ]; }
is_state() { [ "$(state_of "$1")" = "$2" ]; }
# The program that does a shard.
worker() { pgrep -f -- "^$program study .*-o $here/array --shard $1/4" | head -n 1; }

tap study submit study.json -o array --shards 4 --run-seconds 0.5 --time 00:20:00 --json submitted.json
array=$(python3 -c 'import json; print(json.load(open("submitted.json"))["array"])')
merge=$(python3 -c 'import json; print(json.load(open("submitted.json"))["merge"])')
step "the array is job $array, its merge job $merge"

wait_for "the first task's first row" 300 has_rows 1 2
kill -KILL "$(worker 1)"
step "task 1: its program killed by -9 after $(($(rows_of 1) - 1)) rows"
wait_for "the second task's first row" 300 has_rows 2 2
[ "$(ls array/bone-*.json | wc -l)" -eq 1 ] || wrong "expected what is known of the bone in the study's folder"
rm array/bone-*.json
step "what is known of the bone: deleted under way"
scontrol requeue "${array}_2"
step "task 2: requeued after $(($(rows_of 2) - 1)) rows"
wait_for "the third task's first row" 300 has_rows 3 2
scancel "${array}_3"
step "task 3: cancelled after $(($(rows_of 3) - 1)) rows"
wait_for "task 1" 400 is_gone "${array}_1"
grep -q "ended with 137" array/slurm/shard-1.log || wrong "task 1 did not see that its program was killed"
wait_for "task 3" 120 is_gone "${array}_3"
# A requeued job would wait for two minutes.
wait_for "task 2 in the queue again" 60 is_state "${array}_2" PENDING
scontrol update JobId="${array}_2" StartTime=now
wait_for "task 2" 400 is_gone "${array}_2"
wait_for "task 4" 400 is_gone "${array}_4"
grep -q "told to leave by SIGTERM" array/slurm/shard-2.log || wrong "task 2 did not leave between rows"
grep -q "start 2" array/slurm/shard-2.log || wrong "task 2 was not begun again"
wait_for "the merge, which waits for what never comes, to be given up" 120 is_gone "$merge"
[ ! -e array/runs.csv ] || wrong "there are results without the third task"

tap study status array --json status.json
python3 - <<'PYTHON'
import json
status = json.load(open("status.json"))
assert status["done"] + status["left"] == status["runs"] == 60, status
assert status["left"] > 0 and status["shards"][2]["state"] == "not in the queue", status
assert [n for n in (0, 1, 3) if status["shards"][n]["state"] != "done"] == [], status
PYTHON
tap study resume array --json resumed.json
[ "$(python3 -c 'import json; print(json.load(open("resumed.json"))["missing"])')" = "[3]" ] || wrong "another shard than 3"
merge=$(python3 -c 'import json; print(json.load(open("resumed.json"))["merge"])')
wait_for "the merge" 400 is_gone "$merge"
same one array
[ "$(ls array/bone-*.json | wc -l)" -eq 1 ] || wrong "what is known of the bone was not found again"
step "the same bytes from Slurm: one task killed, one requeued, one cancelled and resumed"

# --- The cohort's workflow ------------------------------------------------------------------------------------------
cohort=$source_folder/data/workflows/cohort
export XDG_CACHE_HOME=$here/cache
workflow() {
  snakemake --snakefile "$cohort/Snakefile" --configfile "$cohort/example.yaml" --directory "$@" \
    --config spinaltap="$program" >>"$here/workflow.log" 2>&1 || wrong "the workflow failed: $*"
}
step "the cohort's workflow on this computer"
workflow local --cores 2
step "and on Slurm"
workflow cluster --slurm --jobs 20 --max-status-checks-per-second 1
same local/cohort cluster/cohort
cmp local/patients.csv cluster/patients.csv || wrong "the table of patients differs"
[ "$(wc -l <local/cohort/runs.csv)" -eq 201 ] ||
  wrong "expected ten screws of 20 runs each, found $(wc -l <local/cohort/runs.csv) lines"
python3 - <<'PYTHON'
import csv
rows = list(csv.DictReader(open("local/cohort/runs.csv")))
assert {row["patient"] for row in rows} == set("12345"), "five patients"
assert {row["side"] for row in rows} == {"left", "right"}, "both sides"
assert all(row["screw_grade"] in set("ABCDE") for row in rows), "every screw graded"
PYTHON
workflow cluster --cores 2
grep -q "Nothing to be done" workflow.log || wrong "a workflow that is done did something when called again"
step "five phantoms to one report, the same on both"
step "done"
