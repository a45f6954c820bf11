"""read_with_pydicom.py MAP.nii.gz SEG.dcm RTSTRUCT.dcm: Dice of each label, as pydicom, nibabel and NumPy read them."""
import sys

import nibabel
import numpy as np
import pydicom
from pydicom.pixel_data_handlers.numpy_handler import unpack_bits

LEVELS = ["", *(f"C{n}" for n in range(1, 8)), *(f"T{n}" for n in range(1, 13)), *(f"L{n}" for n in range(1, 7)), "sacrum"]


def truth(path):
    """Voxels by level, and the matrix from indices to LPS."""
    image = nibabel.load(path)
    labels = np.asarray(image.dataobj)
    lps = np.diag([-1.0, -1.0, 1.0, 1.0]) @ image.affine
    return {LEVELS[int(n)]: labels == n for n in np.unique(labels) if n}, lps


def dice(a, b):
    return 2.0 * np.count_nonzero(a & b) / (np.count_nonzero(a) + np.count_nonzero(b))


def frames_of_seg(data):
    """Each frame's segment, position and pixels."""
    bits = unpack_bits(data.PixelData)
    size = data.Rows * data.Columns
    for n, group in enumerate(data.PerFrameFunctionalGroupsSequence):
        pixels = bits[n * size:(n + 1) * size].reshape(data.Rows, data.Columns).astype(bool)
        yield (group.SegmentIdentificationSequence[0].ReferencedSegmentNumber,
               np.array(group.PlanePositionSequence[0].ImagePositionPatient, float), pixels)


def masks_of_seg(path, names, shape, lps):
    data = pydicom.dcmread(path)
    shared = data.SharedFunctionalGroupsSequence[0]
    row, column = np.array(shared.PlaneOrientationSequence[0].ImageOrientationPatient, float).reshape(2, 3)
    down, across = (float(x) for x in shared.PixelMeasuresSequence[0].PixelSpacing)
    label = {s.SegmentNumber: s.SegmentLabel for s in data.SegmentSequence}
    masks = {name: np.zeros(shape, bool) for name in names}
    to_index = np.linalg.inv(lps)
    for segment, position, pixels in frames_of_seg(data):
        j, i = np.nonzero(pixels)
        points = position + np.outer(i * across, row) + np.outer(j * down, column)
        index = np.rint((to_index @ np.c_[points, np.ones(len(points))].T)[:3]).astype(int)
        masks[label[segment]][tuple(index)] = True
    return masks


def is_inside(polygon, size_i, size_j):
    """Even-odd rule for all pixel centres, edge by edge."""
    j, i = np.mgrid[0:size_j, 0:size_i]
    inside = np.zeros((size_j, size_i), bool)
    for (x0, y0), (x1, y1) in zip(polygon, np.roll(polygon, -1, axis=0)):
        if y0 == y1:
            continue
        crosses = (y0 <= j) != (y1 <= j)
        inside ^= crosses & (i < x0 + (j - y0) / (y1 - y0) * (x1 - x0))
    return inside.T


def masks_of_rtstruct(path, names, shape, lps):
    data = pydicom.dcmread(path)
    label = {s.ROINumber: s.ROIName for s in data.StructureSetROISequence}
    masks = {name: np.zeros(shape, bool) for name in names}
    to_index = np.linalg.inv(lps)
    for roi in data.ROIContourSequence:
        for contour in roi.ContourSequence:
            assert contour.ContourGeometricType == "CLOSED_PLANAR"
            points = np.array(contour.ContourData, float).reshape(-1, 3)
            assert len(points) == contour.NumberOfContourPoints
            index = (to_index @ np.c_[points, np.ones(len(points))].T)[:3].T
            k = int(np.rint(index[0, 2]))
            assert np.abs(index[:, 2] - k).max() < 0.01
            masks[label[roi.ReferencedROINumber]][:, :, k] ^= is_inside(index[:, :2], *shape[:2])
    return masks


def main():
    names, lps = truth(sys.argv[1])
    shape = next(iter(names.values())).shape
    is_good = True
    for kind, found, least in (("SEG", masks_of_seg(sys.argv[2], names, shape, lps), 1.0),
                               ("RTSTRUCT", masks_of_rtstruct(sys.argv[3], names, shape, lps), 0.98)):
        for name, mask in names.items():
            index = dice(mask, found[name])
            is_good &= index >= least
            print(f"pydicom, {kind}, {name}: Dice {index:.6f}")
    return 0 if is_good else 1


sys.exit(main())
