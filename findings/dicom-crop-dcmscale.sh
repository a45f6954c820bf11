#!/usr/bin/env bash
# DCMTK's dcmscale stretches a clipped region over the whole image: half of the columns are written with twice their spacing, silently.
# Version: dcmtk 3.6.7 (Debian 12, amd64). 3.6.9 (Debian 13) did the same when tried by hand.
# Seen, for a CT slice of 8 columns 0.5 mm apart and 6 rows 0.75 mm apart (PixelSpacing 0.75\0.5), its first pixel at (-10, 20, 30):
#   dcmscale +C 2 3 4 3     4 columns 1 mm apart, 3 rows 1.5 mm apart, first pixel still at (-10, 20, 30); should be 0.5 and 0.75 mm, and
#                           (-9, 22.25, 30): its pixels are those of columns 2 .. 5 and rows 3 .. 5
#   dcmscale +C 0 0 4 6     4 columns 1 mm apart, 6 rows 0.75 mm apart
#   dcmscale -i -a +Sxv 16  (scaled by 2, not clipped) 16 columns 0.25 mm apart, 12 rows 0.375 mm apart, as it should be
# No message, exit code 0; the CT numbers are right, and DerivationDescription says "Clipped rectangular image region". DICOM PS3.3,
# 10.7.1.3: PixelSpacing is the distance between the centres of adjacent rows, then columns; C.7.6.2.1.1: the position is that of the
# first pixel. dcmscale's manual has nothing on either for --clip-region.
# Why it hurts: a CT cropped to the bone that matters comes back at another size, 10 mm as 20 mm where half is kept, its
# depth as before; it is a plausible DICOM, and contours or an implant planned on the uncropped series no longer lie on it.
# Seen on 2026-11-29. Needs Debian 12 (amd64) with root and apt. Exit 0: as described; else changed or (2, 3) not these versions.
set -euo pipefail
packages=(dcmtk=3.6.7-9~deb12u4)
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
{
  cat <<'T'
(0002,0010) UI =LittleEndianExplicit
(0008,0008) CS ORIGINAL\PRIMARY\AXIAL
(0008,0016) UI =CTImageStorage
(0008,0018) UI 2.25.8153.1
(0008,0020) DA 20260101
(0008,0023) DA 20260101
(0008,0030) TM 120000
(0008,0033) TM 120000
(0008,0050) SH
(0008,0060) CS CT
(0008,0070) LO none
(0008,0090) PN
(0010,0010) PN A^B
(0010,0020) LO 1
(0010,0030) DA
(0010,0040) CS
(0018,0050) DS 1.25
(0018,0060) DS 120
(0018,5100) CS HFS
(0020,000d) UI 2.25.8153.2
(0020,000e) UI 2.25.8153.3
(0020,0010) SH 1
(0020,0011) IS 1
(0020,0012) IS 1
(0020,0013) IS 1
(0020,0032) DS -10\20\30
(0020,0037) DS 1\0\0\0\1\0
(0020,0052) UI 2.25.8153.4
(0020,1040) LO
(0028,0002) US 1
(0028,0004) CS MONOCHROME2
(0028,0010) US 6
(0028,0011) US 8
(0028,0030) DS 0.75\0.5
(0028,0100) US 16
(0028,0101) US 16
(0028,0102) US 15
(0028,0103) US 0
(0028,1052) DS -1024
(0028,1053) DS 1
(0028,1054) LO HU
T
  # Row j, column i: 1000 + 100 * j + 10 * i stored, that is 1024 less in HU.
  printf '(7fe0,0010) OW '
  for j in {0..5}; do for i in {0..7}; do printf '%s%04x' "${sep-}" $((1000 + 100 * j + 10 * i)); sep='\'; done; done; echo
} > slice.dump
inside dump2dcm -q slice.dump slice.dcm
value() { inside dcmdump -q +P "$2" "$1" | sed -E 's/^[^[]* US ([0-9]+) .*/\1/; s/^[^[]*\[([^]]*)\].*/\1/' | head -n 1; }
look() {
  local offset words first
  offset=$(value $1 0028,1052); words=$(inside dcmdump -q +L +P 7fe0,0010 $1 | sed -E 's/^\S+ OW ([0-9a-f]{4}).*/\1/')
  first=$((16#$words)); [ "$(value $1 0028,0103)" = 0 ] || [ $first -lt 32768 ] || first=$((first - 65536))
  echo "$(value $1 0028,0011) columns, $(value $1 0028,0010) rows, spacing $(value $1 0028,0030)," \
    "first pixel $((first + offset)) HU at $(value $1 0020,0032)"
}
{
  echo "slice: $(look slice.dcm)"
  while read -r options; do
    code=0; inside dcmscale $options slice.dcm out.dcm > messages 2>&1 < /dev/null || code=$?
    echo "$options: $(look out.dcm); exit code $code, $(wc -l < messages) messages"
  done <<'T'
+C 2 3 4 3
+C 0 0 4 6
-i -a +Sxv 16
T
  inside dcmscale +C 2 3 4 3 slice.dcm out.dcm; value out.dcm 0008,2111
} | tee seen
cat > wanted <<'T'
slice: 8 columns, 6 rows, spacing 0.75\0.5, first pixel -24 HU at -10\20\30
+C 2 3 4 3: 4 columns, 3 rows, spacing 1.500000\1.000000, first pixel 296 HU at -10\20\30; exit code 0, 0 messages
+C 0 0 4 6: 4 columns, 6 rows, spacing 0.750000\1.000000, first pixel -24 HU at -10\20\30; exit code 0, 0 messages
-i -a +Sxv 16: 16 columns, 12 rows, spacing 0.375000\0.250000, first pixel -24 HU at -10\20\30; exit code 0, 0 messages
Clipped rectangular image region
T
diff wanted seen
echo "as described"
