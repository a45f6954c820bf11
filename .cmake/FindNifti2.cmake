# Finds libnifti2 and makes the target Nifti2::nifti2. Debian 12's own NIFTIConfig.cmake names files that its packages
# do not have.
include(${CMAKE_CURRENT_LIST_DIR}/ImportedLibrary.cmake)
find_imported_library(Nifti2 Nifti2::nifti2 nifti2_io.h nifti nifti2)
