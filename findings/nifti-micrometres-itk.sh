#!/usr/bin/env bash
# Debian 12's ITK turns the voxel sizes of a NIfTI in micrometres or metres to mm, but not its origin, which is 1000 times off then.
# Version: ITK 5.2.1 (libinsighttoolkit5.2) by plastimatch 1.9.4 (Debian 12, amd64).
# Seen, for the same 3 x 4 x 5 voxels of 20 x 30 x 50 um with the first voxel's centre at LPS (-1.5, 2, 3.25) mm, sform and qform the same:
#   xyzt_units 2 (mm)   spacing 0.02 x 0.03 x 0.05, origin (-1.5, 2, 3.25)
#   xyzt_units 3 (um)   spacing 0.02 x 0.03 x 0.05, origin (-1500, 2000, 3250)
#   xyzt_units 1 (m)    spacing 0.02 x 0.03 x 0.05, origin (-0.0015, 0.002, 0.00325)
# No exception, no warning on it, exit code 0. nifti1.h: xyzt_units holds the units of pixdim (NIFTI_UNITS_METER, _MM, _MICRON), and the
# qform adds its offset to pixdim times the indices, so that the offset is in these units as well.
# Why it hurts: micro-CT of bone comes in um. Voxel size, volume and shape are right, but the image lies metres off, or all at one place: a
# mask in mm or a planned path never meets it, and resampling into the other's lattice gives an empty image.
# Seen on 2026-11-28. Needs Debian 12 (amd64) with root and apt. Exit 0: as described; else changed or (2, 3) not these versions.
set -euo pipefail
packages=(plastimatch=1.9.4+dfsg.2-0+deb12u1 libinsighttoolkit5.2=5.2.1-5+deb12u1 python3-minimal=3.11.2-1+b1)
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
cat > write.py <<'PY'
import struct
for name, code, scale in (("mm", 2, 1.0), ("um", 3, 1000.0), ("m", 1, 0.001)):
    sizes = [scale * s for s in (0.02, 0.03, 0.05)]
    first = [scale * s for s in (1.5, -2.0, 3.25)]  # NIfTI's coordinates are RAS
    rows = ((-sizes[0], 0, 0, first[0]), (0, -sizes[1], 0, first[1]), (0, 0, sizes[2], first[2]))
    head = struct.pack("<i10s18sihcB", 348, b"", b"", 0, 0, b"r", 0) + struct.pack("<8h", 3, 3, 4, 5, 1, 1, 1, 1)
    head += struct.pack("<3f4h", 0, 0, 0, 0, 4, 16, 0) + struct.pack("<8f", 1, *sizes, 0, 0, 0, 0) + struct.pack("<3f", 352, 1, 0)
    head += struct.pack("<hBB", 0, 0, code) + struct.pack("<4f2i", 0, 0, 0, 0, 0, 0) + bytes(104)
    head += struct.pack("<2h", 1, 1) + struct.pack("<6f", 0, 0, 1, *first) + b"".join(struct.pack("<4f", *r) for r in rows)
    head += bytes(16) + b"n+1\0"
    open(name + ".nii", "wb").write(head + bytes(4) + struct.pack("<60h", *range(60)))
PY
inside python3 write.py
for unit in mm um m; do
  inside plastimatch convert --input $unit.nii --output-img $unit.mha > log 2>&1; echo "$unit: exit code $?"
  grep -aE '^(Offset|ElementSpacing|TransformMatrix|DimSize)' $unit.mha | sort |
    awk '{ for (i = 3; i <= NF; ++i) $i = sprintf("%.5g", $i); print "  " $0 }'
  grep -iE 'unit|micro|scale' log || true
done | tee seen
cat > wanted <<'T'
mm: exit code 0
  DimSize = 3 4 5
  ElementSpacing = 0.02 0.03 0.05
  Offset = -1.5 2 3.25
  TransformMatrix = 1 0 0 0 1 0 0 0 1
um: exit code 0
  DimSize = 3 4 5
  ElementSpacing = 0.02 0.03 0.05
  Offset = -1500 2000 3250
  TransformMatrix = 1 0 0 0 1 0 0 0 1
m: exit code 0
  DimSize = 3 4 5
  ElementSpacing = 0.02 0.03 0.05
  Offset = -0.0015 0.002 0.00325
  TransformMatrix = 1 0 0 0 1 0 0 0 1
T
diff wanted seen
echo "as described"
