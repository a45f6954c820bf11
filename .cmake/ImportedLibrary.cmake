# For find modules: find_imported_library(<package> <target> <header> <folder> <names>...) finds a C library by its
# header, perhaps in <folder> below the include folders, and by one of its names, and makes the imported target.
macro(find_imported_library package target header folder)
  find_path(${package}_INCLUDE_DIR ${header} PATH_SUFFIXES ${folder})
  find_library(${package}_LIBRARY NAMES ${ARGN})
  include(FindPackageHandleStandardArgs)
  find_package_handle_standard_args(${package} REQUIRED_VARS ${package}_LIBRARY ${package}_INCLUDE_DIR)
  if(${package}_FOUND AND NOT TARGET ${target})
    add_library(${target} UNKNOWN IMPORTED)
    set_target_properties(${target} PROPERTIES
      IMPORTED_LOCATION "${${package}_LIBRARY}" INTERFACE_INCLUDE_DIRECTORIES "${${package}_INCLUDE_DIR}")
  endif()
  mark_as_advanced(${package}_INCLUDE_DIR ${package}_LIBRARY)
endmacro()
