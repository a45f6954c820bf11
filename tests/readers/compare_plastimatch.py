"""compare_plastimatch.py MAP.nii.gz RTSTRUCT.dcm LABELS.nii.gz LIST.txt CONTOURS.cxt: what plastimatch made of an RTSTRUCT
and the CT's images (its map, names and contours), beside the NIfTI map and the UIDs that the RTSTRUCT has."""
import sys

import nibabel
import numpy as np
import pydicom

LEVELS = ["", *(f"C{n}" for n in range(1, 8)), *(f"T{n}" for n in range(1, 13)), *(f"L{n}" for n in range(1, 7)), "sacrum"]


def dice(a, b):
    return 2.0 * np.count_nonzero(a & b) / (np.count_nonzero(a) + np.count_nonzero(b))


def on_grid(image, like):
    """The voxels of an image of the same grid whose axes may run the other way round."""
    step = np.linalg.inv(like.affine) @ image.affine
    turn = np.rint(step[:3, :3])
    assert np.abs(step[:3, :3] - turn).max() < 1e-4 and np.array_equal(np.abs(turn).sum(axis=0), np.ones(3))
    axes = [int(np.argmax(np.abs(turn[:, n]))) for n in range(3)]
    voxels = np.asarray(image.dataobj).transpose(np.argsort(axes))
    flipped = [n for n in range(3) if turn[n].sum() < 0]
    voxels = np.flip(voxels, flipped)
    ends = [like.shape[n] - 1 if n in flipped else 0 for n in range(3)]
    assert voxels.shape == like.shape and np.abs(step[:3, 3] - ends).max() < 1e-2
    return voxels


def read_cxt(path):
    """The CT's UIDs, as they stand in the first lines, and ROI number, image UID and z of each contour."""
    uids, contours = {}, []
    with open(path, encoding="utf-8") as file:
        for line in file:
            fields = line.rstrip("\n").split("|")
            if len(fields) == 6:
                contours.append((int(fields[0]), fields[4], float(fields[5].split("\\")[2])))
            elif line.startswith("CT_"):
                uids.update([line.split()])
    return uids, contours


def main():
    image = nibabel.load(sys.argv[1])
    labels = np.asarray(image.dataobj)
    data = pydicom.dcmread(sys.argv[2])
    voxels = on_grid(nibabel.load(sys.argv[3]), image)
    with open(sys.argv[4], encoding="utf-8") as file:
        # Names come in the order of the numbers, which begin with 1 in the map and with 0 here.
        number = {name: int(n) + 1 for n, _, name in (line.rstrip("\n").split("|") for line in file)}
    names = [LEVELS[int(n)] for n in np.unique(labels)[1:]]
    is_good = list(number) == names
    print(f"plastimatch, RTSTRUCT: names {' '.join(number)}")
    for name in names:
        mask, found = labels == LEVELS.index(name), voxels == number.get(name)
        index = dice(mask, found)
        is_good &= index >= 0.98
        missed, added = np.count_nonzero(mask & ~found), np.count_nonzero(found & ~mask)
        print(f"plastimatch, RTSTRUCT, {name}: Dice {index:.6f}, {missed} voxels missed, {added} added")

    uids, contours = read_cxt(sys.argv[5])
    frame = data.ReferencedFrameOfReferenceSequence[0]
    study = frame.RTReferencedStudySequence[0]
    ours = {"CT_FRAME_OF_REFERENCE_UID": frame.FrameOfReferenceUID, "CT_STUDY_UID": data.StudyInstanceUID,
            "CT_SERIES_UID": study.RTReferencedSeriesSequence[0].SeriesInstanceUID}
    is_good &= uids == ours and study.ReferencedSOPInstanceUID == data.StudyInstanceUID
    is_good &= all(roi.ReferencedFrameOfReferenceUID == frame.FrameOfReferenceUID for roi in data.StructureSetROISequence)
    print("plastimatch, CT's frame of reference, study and series:", "ours" if uids == ours else f"{uids}, not {ours}")
    named = sorted((roi.ReferencedROINumber, one.ContourImageSequence[0].ReferencedSOPInstanceUID, float(one.ContourData[2]))
                   for roi in data.ROIContourSequence for one in roi.ContourSequence)
    wrong = sum(a[:2] != b[:2] or abs(a[2] - b[2]) > 0.01 for a, b in zip(named, sorted(contours)))
    is_good &= wrong == 0 and len(named) == len(contours)
    print(f"plastimatch, RTSTRUCT: {len(contours)} contours, we wrote {len(named)}, {wrong} on other images")
    return 0 if is_good else 1


sys.exit(main())
