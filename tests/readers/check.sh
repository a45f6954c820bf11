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
# plastimatch 1.9.4 fills the contours itself, on a grid of its own (512 x 512 around them), and takes the CT's voxels from
# that. It adds closed contours up, in a label map whatever --xor-contours says, so that holes must be keyholes; of
# CLOSEDPLANAR_XOR it says on stdout that it skips them, and leaves the region empty (findings/rtstruct-xor-plastimatch.sh).
# dciodvfy of 2022 knows no such type either.
plastimatch convert --input "$out/map.rtstruct.dcm" --referenced-ct "$ct" --output-labelmap "$out/found.nii.gz" \
  --output-ss-list "$out/found.txt" --output-cxt "$out/found.cxt" > "$out/words" 2>&1 || {
  cat "$out/words"
  exit 1
}
/usr/bin/python3 "$here/compare_plastimatch.py" "$out/map.nii.gz" "$out/map.rtstruct.dcm" "$out/found.nii.gz" \
  "$out/found.txt" "$out/found.cxt"
if [ -n "${NODE_FOLDER:-}" ]; then
  cp "$here/read_with_node.mjs" "$NODE_FOLDER/"
  node "$NODE_FOLDER/read_with_node.mjs" "$out/map.dcm" "$out/node.json"
  /usr/bin/python3 "$here/compare_node.py" "$out/map.nii.gz" "$out/map.dcm" "$out/node.json"
fi
