# Finds libnifti2 and makes the target Nifti2::nifti2. Debian 12's own NIFTIConfig.cmake names files that its packages
# do not have.
find_path(Nifti2_INCLUDE_DIR nifti2_io.h PATH_SUFFIXES nifti)
find_library(Nifti2_LIBRARY nifti2)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(Nifti2 REQUIRED_VARS Nifti2_LIBRARY Nifti2_INCLUDE_DIR)
if(Nifti2_FOUND AND NOT TARGET Nifti2::nifti2)
  add_library(Nifti2::nifti2 UNKNOWN IMPORTED)
  set_target_properties(Nifti2::nifti2 PROPERTIES
    IMPORTED_LOCATION "${Nifti2_LIBRARY}" INTERFACE_INCLUDE_DIRECTORIES "${Nifti2_INCLUDE_DIR}")
endif()
mark_as_advanced(Nifti2_INCLUDE_DIR Nifti2_LIBRARY)
