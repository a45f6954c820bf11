#!/usr/bin/env bash
# gmsh keeps only the first triangle of every polygon of a PLY: half of a surface of quads is missing, without a word.
# Version: gmsh 4.8.4 (Debian 12, amd64).
# Seen, for a closed box of 20 x 10 x 6 mm (area 760 mm2) in ASCII PLY:
#   12 triangles                 12 triangles, area 760, no edge open
#   6 quads                      6 triangles, area 380, 14 edges open; it says "6 triangles"
#   2 quads and 8 triangles      10 triangles, area 560, 6 edges open
# No warning or error, exit code 0. In "The PLY Polygon File Format" (G. Turk) a face is a list of any number of vertices, and the first
# example there is a cube of six quads.
# Why it hurts: remeshed surfaces of bone and implants are often of quads (Blender, Instant Meshes). gmsh is the way to a mesh for finite
# elements; areas and contacts are halved, and that the volume cannot be meshed is blamed on the surface, which is closed.
# Seen on 2026-11-28. Needs Debian 12 (amd64) with root and apt. Exit 0: as described; else changed or (2, 3) not these versions.
set -euo pipefail
packages=(gmsh=4.8.4+ds2-3)
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
corners=("1 2 3" "21 2 3" "21 12 3" "1 12 3" "1 2 9" "21 2 9" "21 12 9" "1 12 9")
quads=("0 3 2 1" "4 5 6 7" "0 1 5 4" "1 2 6 5" "2 3 7 6" "3 0 4 7")
halves() { local a b c d; for q in "$@"; do read -r a b c d <<< "$q"; printf '%s\n' "3 $a $b $c" "3 $a $c $d"; done; }
ply() {  # NAME, then faces with their number of corners in front
  { printf '%s\n' ply "format ascii 1.0" "element vertex 8" "property float x" "property float y" "property float z" \
      "element face $(($# - 1))" "property list uchar int vertex_indices" end_header "${corners[@]}" "${@:2}"; } > "$1.ply"
}
mapfile -t triangles < <(halves "${quads[@]}"); mapfile -t rest < <(halves "${quads[@]:2}")
ply triangles "${triangles[@]}"
ply quads "${quads[@]/#/4 }"
ply mixed "4 ${quads[0]}" "4 ${quads[1]}" "${rest[@]}"
for file in triangles.ply quads.ply mixed.ply; do
  rm -f out.msh; inside gmsh -0 $file -format msh22 -o out.msh > log 2>&1; code=$?
  awk -v file=$file -v code=$code '
    $1 == "$Nodes" { part = "n"; getline; next }
    $1 == "$Elements" { part = "e"; getline; next }
    /^\$/ { part = "" }
    part == "n" { x[$1] = $2; y[$1] = $3; z[$1] = $4 }
    part == "e" && $2 == 2 {
      a = $(NF - 2); b = $(NF - 1); c = $NF; ++count; edge[a " " b]++; edge[b " " c]++; edge[c " " a]++
      ux = x[b] - x[a]; uy = y[b] - y[a]; uz = z[b] - z[a]; vx = x[c] - x[a]; vy = y[c] - y[a]; vz = z[c] - z[a]
      area += sqrt((uy * vz - uz * vy) ^ 2 + (uz * vx - ux * vz) ^ 2 + (ux * vy - uy * vx) ^ 2) / 2
    }
    END {
      for (e in edge) { split(e, p); if (!((p[2] " " p[1]) in edge)) ++open }
      printf "%s: exit code %d, triangles %d, area %g, open edges %d\n", file, code, count, area, open
    }' out.msh
  grep -iE 'warning|error' log || true
done | tee seen
cat > wanted <<'T'
triangles.ply: exit code 0, triangles 12, area 760, open edges 0
quads.ply: exit code 0, triangles 6, area 380, open edges 14
mixed.ply: exit code 0, triangles 10, area 560, open edges 6
T
diff wanted seen
echo "as described"
