#!/usr/bin/env bash
# itk-wasm turns a NRRD in left-anterior-superior space by 180 degrees about the body's axis: left and right, front and back change places.
# Version: @itk-wasm/image-io 1.6.1 (npm; Node 20). Debian 12's ITK 5.2.1 does it as well; in ITK itself it was corrected in 2025.
# Seen, for the same 12 x 5 x 4 voxels of 0.5 x 0.75 x 1.25 mm written in each of the three anatomical spaces of NRRD, so that the first
# voxel lies at LPS (-10, 20, 30) mm and the second 0.5 mm further left (L is +x); ITK's coordinates are LPS:
#   left-posterior-superior, right-anterior-superior   first voxel at (-10, 20, 30), steps (0.5, 0, 0), (0, 0.75, 0), (0, 0, 1.25)
#   left-anterior-superior                             first voxel at (10, -20, 30), steps (-0.5, 0, 0), (0, -0.75, 0), (0, 0, 1.25)
# No exception, no message. NRRD's definition (teem, "space: left-anterior-superior", "LAS") says that its first axis points left, so
# only the second one is to change its sign on the way to LPS.
# Why it hurts: a spine's left pedicle is planned as its right one. A turn by 180 degrees is a rotation, so that no check for a mirror
# image (determinant, handedness) sees it, and a vertebra looks alike from both sides.
# Seen on 2026-11-28. Needs Node 20 with npm. Exit 0: as described; else changed or (2, 3) not these versions.
set -euo pipefail
packages=(@itk-wasm/image-io@1.6.1)
# The same in every script for npm: exactly these packages in a temp folder, their install scripts not run.
dir=$(mktemp -d); trap 'rm -rf --one-file-system "$dir"' EXIT; cd "$dir"
npm install --prefix "$dir" --ignore-scripts --no-audit --no-fund "${packages[@]}" > log 2>&1 ||
  { tail -n 20 log; echo "cannot install ${packages[*]}"; exit 2; }
for p in "${packages[@]}"; do
  v=$(node -p "require('./node_modules/${p%@*}/package.json').version"); [ "$v" = "${p##*@}" ] || { echo "expected $p, found $v"; exit 3; }
done
cat > read.mjs <<'JS'
import fs from 'fs';
import { readImageNode } from '@itk-wasm/image-io';
const values = Buffer.alloc(480);
for (let i = 0; i < 240; ++i) values.writeInt16LE(i, 2 * i);
const spaces = [['left-posterior-superior', 1, 1], ['right-anterior-superior', -1, -1], ['left-anterior-superior', 1, -1]];
for (const [space, x, y] of spaces) {
  const head = `NRRD0004\ntype: short\ndimension: 3\nspace: ${space}\nsizes: 12 5 4\n` +
    `space directions: (${0.5 * x},0,0) (0,${0.75 * y},0) (0,0,1.25)\nkinds: domain domain domain\nendian: little\nencoding: raw\n` +
    `space origin: (${-10 * x},${20 * y},30)\n\n`;
  fs.writeFileSync('image.nrrd', Buffer.concat([Buffer.from(head), values]));
  const image = await readImageNode('image.nrrd');
  const steps = [0, 1, 2].map((axis) => [0, 1, 2].map((row) => image.direction[3 * row + axis] * image.spacing[axis] + 0).join(','));
  console.log(`${space}: first voxel ${image.origin.join(',')}; steps ${steps.join(' ')}; values ${image.data.slice(0, 3).join(',')}`);
}
process.exit(0);
JS
node read.mjs 2>&1 | tee seen
cat > wanted <<'T'
left-posterior-superior: first voxel -10,20,30; steps 0.5,0,0 0,0.75,0 0,0,1.25; values 0,1,2
right-anterior-superior: first voxel -10,20,30; steps 0.5,0,0 0,0.75,0 0,0,1.25; values 0,1,2
left-anterior-superior: first voxel 10,-20,30; steps -0.5,0,0 0,-0.75,0 0,0,1.25; values 0,1,2
T
diff wanted seen
echo "as described"
