#!/usr/bin/env bash
# VTK's vtkDICOMImageReader takes the row spacing for x and the column spacing for y: a bone of 6 x 6 mm becomes one of 9 x 4 mm, silently.
# Version: python3-vtk9 9.1.0; beside it vtk-dicom 0.8.14 (dicomtonifti), which reads the series as it should (Debian 12, amd64).
# Seen, for CT slices of 20 columns (i) and 16 rows (j), 8 slices 1.25 mm apart, with a block of 700 HU of 12 x 8 voxels in 4 slices:
#   columns 0.5 mm apart, rows 0.75   vtkDICOMImageReader: spacing 0.75, 0.5, 1.25 (i, j, k), also for one file alone, and from
#   (PixelSpacing 0.75\0.5)           GetPixelSpacing; the surface at 350 HU is 9 x 4 x 5 mm
#                                     dicomtonifti, vtkNIFTIImageReader: spacing 0.5, 0.75, 1.25; the surface is 6 x 6 x 5 mm
#   both 0.5 mm apart                 either: spacing 0.5, 0.5, 1.25; the surface is 6 x 4 x 5 mm
# No message, exit code 0; the CT numbers are right. DICOM PS3.3, 10.7.1.3: the first value of PixelSpacing is the distance between rows
# (down, y), the second that between columns (x). GetPixelSpacing is documented as "the pixel spacing (in X, Y, Z)"; a warning on the class
# says that "the x,y pixel spacing" is assumed to stand in 0028,0030, which has the assumption but not that it is wrong.
# Why it hurts: reformatted (sagittal, coronal) slices of a spine and scans resampled along one axis may have oblong pixels. A width is
# half as much again or a third less here; the volume is right (as the product of the spacings is), and so are usual axial series.
# Known like it: MRtrix (mrtrix-signed-ct.sh), and dcm2mnc in a public issue; VTK's own was not found among public issues.
# Seen on 2026-11-30. Needs Debian 12 (amd64) with root and apt. Exit 0: as described; else changed or (2, 3) not these versions.
set -euo pipefail
packages=(python3-vtk9=9.1.0+really9.1.0+dfsg2-5+deb12u1 vtk-dicom-tools=0.8.14-3.1 python3-pydicom=2.3.1-1)
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
import os
from array import array
from pydicom.dataset import Dataset, FileMetaDataset
from pydicom.uid import ExplicitVRLittleEndian
ct = "1.2.840.10008.5.1.4.1.1.2"
for number, (name, rows_apart) in enumerate({"oblong": "0.75", "square": "0.5"}.items(), 1):
    uid = lambda *parts: f"2.25.8154.{number}." + ".".join(str(p) for p in parts)
    os.makedirs(name)
    for k in range(8):
        d = Dataset(); d.file_meta = FileMetaDataset(); d.is_little_endian = True; d.is_implicit_VR = False
        d.SOPClassUID = d.file_meta.MediaStorageSOPClassUID = ct
        d.SOPInstanceUID = d.file_meta.MediaStorageSOPInstanceUID = uid(1, k + 1)
        d.file_meta.TransferSyntaxUID = ExplicitVRLittleEndian; d.file_meta.ImplementationClassUID = "2.25.8154"
        d.StudyInstanceUID, d.SeriesInstanceUID, d.FrameOfReferenceUID = uid(2), uid(3), uid(4)
        d.Modality = "CT"; d.Manufacturer = "none"; d.PatientName = "A^B"; d.PatientID = "1"; d.KVP = "120"; d.Laterality = ""
        d.PatientBirthDate = d.PatientSex = d.AccessionNumber = d.ReferringPhysicianName = d.PositionReferenceIndicator = ""
        d.StudyDate = d.SeriesDate = d.ContentDate = "20260101"; d.StudyTime = d.SeriesTime = d.ContentTime = "120000"
        d.StudyID = d.SeriesNumber = d.AcquisitionNumber = "1"; d.InstanceNumber = str(k + 1)
        d.ImageType = ["ORIGINAL", "PRIMARY", "AXIAL"]; d.PatientPosition = "HFS"; d.SliceThickness = "1.25"
        d.PixelSpacing = [rows_apart, "0.5"]; d.ImageOrientationPatient = ["1", "0", "0", "0", "1", "0"]
        d.ImagePositionPatient = ["-10", "20", str(30 + 1.25 * k)]
        d.SamplesPerPixel = 1; d.PhotometricInterpretation = "MONOCHROME2"; d.Rows, d.Columns = 16, 20
        d.BitsAllocated, d.BitsStored, d.HighBit, d.PixelRepresentation = 16, 16, 15, 1
        d.RescaleIntercept, d.RescaleSlope, d.RescaleType = "0", "1", "HU"
        inside = lambda i, j: 4 <= i < 16 and 4 <= j < 12 and 2 <= k < 6
        d.PixelData = array("h", [700 if inside(i, j) else 0 for j in range(16) for i in range(20)]).tobytes()
        d["PixelData"].VR = "OW"
        d.save_as(f"{name}/{k}.dcm", write_like_original=False)
PY
cat > read.py <<'PY'
import sys
from vtkmodules.vtkFiltersCore import vtkMarchingCubes, vtkMassProperties
from vtkmodules.vtkIOImage import vtkDICOMImageReader, vtkNIFTIImageReader
show = lambda values: " x ".join(f"{v:g}" for v in values)
def look(name, reader):
    reader.Update(); image = reader.GetOutput(); low, high = image.GetScalarRange()
    surface = vtkMarchingCubes(); surface.SetInputData(image); surface.SetValue(0, 350); surface.ComputeNormalsOff(); surface.Update()
    b = surface.GetOutput().GetBounds()
    mass = vtkMassProperties(); mass.SetInputConnection(surface.GetOutputPort()); mass.Update()
    print(f"{name}: {show(image.GetDimensions())} voxels of {show(image.GetSpacing())}, {low:g} .. {high:g} HU,",
          f"surface {show(round(b[i + 1] - b[i], 4) for i in (0, 2, 4))}, volume {mass.GetVolume():.1f}")
name = sys.argv[1]
series = vtkDICOMImageReader(); series.SetDirectoryName(name); look("series", series)
print(f"GetPixelSpacing: {show(series.GetPixelSpacing())}, orientation {show(series.GetImageOrientationPatient())}")
one = vtkDICOMImageReader(); one.SetFileName(name + "/3.dcm"); one.Update(); print(f"one file: {show(one.GetOutput().GetSpacing())}")
other = vtkNIFTIImageReader(); other.SetFileName(name + ".nii"); look("vtk-dicom", other)
PY
inside python3 write.py
for name in oblong square; do
  echo "$name"
  inside dicomtonifti -o $name.nii $name > log
  code=0; inside python3 read.py $name 2> messages || code=$?
  echo "exit code $code, $(wc -l < messages) messages"
done | tee seen
cat > wanted <<'T'
oblong
series: 20 x 16 x 8 voxels of 0.75 x 0.5 x 1.25, 0 .. 700 HU, surface 9 x 4 x 5, volume 174.7
GetPixelSpacing: 0.75 x 0.5 x 1.25, orientation 1 x 0 x 0 x 0 x 1 x 0
one file: 0.75 x 0.5 x 1.25
vtk-dicom: 20 x 16 x 8 voxels of 0.5 x 0.75 x 1.25, 0 .. 700 HU, surface 6 x 6 x 5, volume 174.7
exit code 0, 0 messages
square
series: 20 x 16 x 8 voxels of 0.5 x 0.5 x 1.25, 0 .. 700 HU, surface 6 x 4 x 5, volume 116.5
GetPixelSpacing: 0.5 x 0.5 x 1.25, orientation 1 x 0 x 0 x 0 x 1 x 0
one file: 0.5 x 0.5 x 1.25
vtk-dicom: 20 x 16 x 8 voxels of 0.5 x 0.5 x 1.25, 0 .. 700 HU, surface 6 x 4 x 5, volume 116.5
exit code 0, 0 messages
T
diff wanted seen
echo "as described"
