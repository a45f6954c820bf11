#!/usr/bin/env bash
# pyopenvdb takes the memory of a numpy array in C order whatever its strides: a volume as nibabel returns it comes into a grid shuffled.
# Version: python3-openvdb 10.0.1 with numpy 1.24.2, nibabel 5.0.0 (Debian 12, amd64).
# Seen, for a NIfTI label map of 6 x 5 x 4 voxels with a block of 3 x 2 x 2 voxels, its corner at (1, 1, 1):
#   copyFromArray of np.ascontiguousarray(image.get_fdata())   as it should be: 12 active voxels from (1, 1, 1) to (3, 2, 2)
#   of image.get_fdata(), in Fortran order                     12 active from (1, 0, 0) to (3, 4, 3), 20 of 120 voxels wrong
#   of a transposed view (z, y, x turned to x, y, z)           the same
#   of a view of every second plane of a larger array          8 active from (2, 1, 1) to (4, 2, 2), 12 wrong
#   copyToArray into an array in Fortran order                 sum 12 as it should be, 20 of 120 voxels wrong
# No exception, no warning. The documentation of copyFromArray asks for an array of the right shape and type, with no word on its order, and
# a numpy array's value at an index is defined by its strides (NumPy's "The N-dimensional array", internal memory layout).
# Why it hurts: nibabel reads all NIfTI files in Fortran order, and turning SimpleITK's z, y, x round gives a view: the two ways by which a
# segmented bone comes to Python. Counts and sums stay right; the shape is shreds, and a cube of equal sides that is symmetric hides it.
# Seen on 2026-11-28. Needs Debian 12 (amd64) with root and apt. Exit 0: as described; else changed or (2, 3) not these versions.
set -euo pipefail
packages=(python3-openvdb=10.0.1-2 python3-nibabel=5.0.0-2 python3-numpy=1:1.24.2-1+deb12u1)
# The same in every script: exactly these Debian packages in a root in a temp folder, from this machine's own apt sources (Python files
# not byte-compiled, to save time); inside COMMAND runs in that root's /work. Mounts lie in namespaces that end with the command.
dir=$(mktemp -d); root=$dir/root; trap 'rm -rf --one-file-system "$dir"' EXIT
make_root() {
  local sources=/etc/apt/sources.list.d/debian.sources; [ -e $sources ] || sources=/etc/apt/sources.list
  command -v mmdebstrap || { apt-get update && apt-get install -y mmdebstrap; } || return
  TMPDIR=$dir unshare --mount mmdebstrap --variant=essential --include="${packages[*]}" --aptopt='APT::Sandbox::User "root"' \
    --essential-hook='ln -s /bin/true "$1/usr/sbin/py3compile"' --dpkgopt=force-unsafe-io \
    --dpkgopt=path-exclude=/usr/{include,share/{doc,locale,man}}/'*' bookworm "$root" $sources && mkdir "$root/work"
}
inside() { unshare --mount-proc="$root/proc" chroot "$root" env -i -C /work PATH=/usr/bin:/bin HOME=/work LC_ALL=C.UTF-8 "$@"; }
make_root > "$dir/log" 2>&1 || { tail -n 20 "$dir/log"; echo "cannot install ${packages[*]}"; exit 2; }
for p in "${packages[@]}"; do
  v=$(inside dpkg-query -W -f='${Version}' "${p%%=*}"); [ "$v" = "${p#*=}" ] || { echo "expected $p, found $v"; exit 3; }
done
cd "$root/work"
cat > grids.py <<'PY'
import nibabel
import numpy as np
import pyopenvdb
block = np.zeros((6, 5, 4), np.uint8)
block[1:4, 1:3, 1:3] = 1
nibabel.save(nibabel.Nifti1Image(block, np.diag([0.5, 0.5, 1.25, 1])), "label.nii")
image = nibabel.load("label.nii").get_fdata()
wide = np.zeros((12, 5, 4)); wide[::2] = image
views = {"C order": np.ascontiguousarray(image), "nibabel's": image, "every second": wide[::2],
         "transposed": np.ascontiguousarray(image.transpose()).transpose()}
for name, array in views.items():
    assert np.array_equal(array, block)
    grid = pyopenvdb.FloatGrid(); grid.copyFromArray(array)
    accessor = grid.getAccessor()
    wrong = sum(accessor.getValue(index) != value for index, value in np.ndenumerate(block))
    print(f"{name}: C {array.flags.c_contiguous}, F {array.flags.f_contiguous}, {wrong} of {array.size} voxels wrong,",
          f"{grid.activeVoxelCount()} active in", *grid.evalActiveVoxelBoundingBox())
grid = pyopenvdb.FloatGrid(); grid.copyFromArray(views["C order"])
for order in "CF":
    array = np.zeros(block.shape, np.float32, order=order); grid.copyToArray(array)
    print(f"copyToArray, {order} order: {np.count_nonzero(array != block)} of {array.size} voxels wrong, sum {array.sum():g}")
PY
inside python3 grids.py 2>&1 | tee seen
cat > wanted <<'T'
C order: C True, F False, 0 of 120 voxels wrong, 12 active in (1, 1, 1) (3, 2, 2)
nibabel's: C False, F True, 20 of 120 voxels wrong, 12 active in (1, 0, 0) (3, 4, 3)
every second: C False, F False, 12 of 120 voxels wrong, 8 active in (2, 1, 1) (4, 2, 2)
transposed: C False, F True, 20 of 120 voxels wrong, 12 active in (1, 0, 0) (3, 4, 3)
copyToArray, C order: 0 of 120 voxels wrong, sum 12
copyToArray, F order: 20 of 120 voxels wrong, sum 12
T
diff wanted seen
echo "as described"
