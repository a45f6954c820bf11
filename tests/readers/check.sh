#!/bin/sh
# check.sh SPINALTAP CT LABELS [OPTIONS]: see README.md
set -eu
spinaltap=$1 ct=$2 labels=$3
shift 3
here=$(cd "$(dirname "$0")" && pwd)
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
for name in map.nii.gz map.dcm map.rtstruct.dcm; do
  "$spinaltap" segment "$ct" --labels "$labels" --all "$@" -o "$out/$name" > /dev/null
done
for name in map.dcm map.rtstruct.dcm; do
  dciodvfy "$out/$name" > "$out/words" 2>&1 || true
  cat "$out/words"
  if grep -q '^Error' "$out/words"; then
    echo "$name: dciodvfy finds errors"
    exit 1
  fi
done
/usr/bin/python3 "$here/read_with_pydicom.py" "$out/map.nii.gz" "$out/map.dcm" "$out/map.rtstruct.dcm"
if [ -n "${NODE_FOLDER:-}" ]; then
  cp "$here/read_with_node.mjs" "$NODE_FOLDER/"
  node "$NODE_FOLDER/read_with_node.mjs" "$out/map.dcm" "$out/node.json"
  /usr/bin/python3 "$here/compare_node.py" "$out/map.nii.gz" "$out/map.dcm" "$out/node.json"
fi
