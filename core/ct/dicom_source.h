#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/ct/grid_geometry.h"

namespace spinaltap {

/// The DICOM images that a CT's slices were read from, by their UIDs: what a segmentation must name so that viewers
/// lay it over them. UIDs are all that is taken: no name, number, date or place of a patient.
struct DicomSource {
  /// One image, or a frame of one.
  struct Image {
    std::string sop_class;
    std::string sop_instance;
    int frame = 0;  ///< counted from 1; 0: the image has one
  };
  std::string study_uid;
  std::string series_uid;
  std::string frame_of_reference_uid;
  std::vector<std::optional<Image>> slices;  ///< by k; nothing where no image lies at a slice, or all, of no DICOM
};

/// Finds the images below a folder, or in a file, that lie where the slices of `geometry` do. `series`
/// and `stack` as CtReadOptions has them. Where several series do, the one with most such images. No images where there
/// are none, as for a CT out of another format.
DicomSource find_dicom_source(const std::filesystem::path& path, const std::string& series, int stack,
                              const GridGeometry& geometry, const Progress& progress = {});

}  // namespace spinaltap
