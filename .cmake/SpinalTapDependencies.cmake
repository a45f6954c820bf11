# Debian's packages; docs/building.md has their versions. `./run build` installs them.
find_package(Threads REQUIRED)
find_package(TBB REQUIRED)
# 3.4 or any later: Eigen 5, which came after it, calls itself another package than 3.4.
find_package(Eigen3 REQUIRED NO_MODULE)
if(Eigen3_VERSION VERSION_LESS 3.4)
  message(FATAL_ERROR "expected Eigen 3.4 or later, found ${Eigen3_VERSION}")
endif()

# GDCM's config warns about programs that only libgdcm-tools installs, and VTK is not wanted from it.
set(GDCM_SKIP_USE_VTK ON)
find_package(GDCM 3.0 REQUIRED)
find_package(Nifti2 REQUIRED)
find_package(ZLIB REQUIRED)
find_package(Hdf5C REQUIRED)
find_path(SPINALTAP_NANOFLANN_DIR nanoflann.hpp REQUIRED)  # headers only, in .cpp files only
find_package(OpenMesh REQUIRED)

# FindOpenVDB.cmake lies in the OpenVDB package's own folder.
find_path(SPINALTAP_OPENVDB_MODULE_DIR FindOpenVDB.cmake
          PATHS /usr/lib/${CMAKE_CXX_LIBRARY_ARCHITECTURE}/cmake/OpenVDB /usr/lib/cmake/OpenVDB /usr/lib64/cmake/OpenVDB
          REQUIRED)
list(APPEND CMAKE_MODULE_PATH ${SPINALTAP_OPENVDB_MODULE_DIR})
find_package(OpenVDB 10 REQUIRED COMPONENTS openvdb)

find_package(CLI11 REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(PNG REQUIRED)
find_package(OpenIGTLink REQUIRED MODULE)
find_package(SndFile REQUIRED MODULE)
if(SPINALTAP_TESTS)
  find_package(GTest REQUIRED)
  if(SPINALTAP_BENCHMARKS)
    find_package(benchmark REQUIRED)
  endif()
endif()

# For the planner's window only. VTK comes in parts; those that draw bones.
if(SPINALTAP_PLANNER)
  set(required "")
  if(NOT SPINALTAP_PLANNER STREQUAL AUTO)
    set(required REQUIRED)
  endif()
  find_package(VTK 9.1 ${required} QUIET COMPONENTS CommonCore CommonDataModel CommonTransforms FiltersSources
               ImagingCore RenderingAnnotation RenderingCore RenderingFreeType RenderingOpenGL2)
  # The Qt that VTK is built with: its packages bring that one.
  set(qt Qt5)
  if(VTK_QT_VERSION AND NOT VTK_QT_VERSION VERSION_LESS 6)
    set(qt Qt6)
  endif()
  find_package(${qt} 5.15 ${required} QUIET COMPONENTS Svg Widgets)
  if(${qt}_FOUND AND VTK_FOUND)
    set(SPINALTAP_PLANNER ON)
    set(SPINALTAP_VTK ${VTK_LIBRARIES})
    # The drill as it is heard; without, the window says so.
    find_package(${qt}Multimedia 5.15 QUIET)
  else()
    set(SPINALTAP_PLANNER OFF)
  endif()
endif()

# For the Python package only: Debian's own Python 3, whatever others are in the path.
if(SPINALTAP_PYTHON)
  set(required "")
  if(NOT SPINALTAP_PYTHON STREQUAL AUTO)
    set(required REQUIRED)
  endif()
  if(NOT Python_EXECUTABLE AND EXISTS /usr/bin/python3)
    set(Python_EXECUTABLE /usr/bin/python3)
  endif()
  find_package(Python 3.9 ${required} QUIET COMPONENTS Interpreter Development.Module)
  find_package(pybind11 2.10 ${required} QUIET)
  set(has_numpy 1)
  if(Python_FOUND)
    execute_process(COMMAND ${Python_EXECUTABLE} -c "import numpy" RESULT_VARIABLE has_numpy OUTPUT_QUIET ERROR_QUIET)
  endif()
  if(Python_FOUND AND pybind11_FOUND AND has_numpy EQUAL 0)
    set(SPINALTAP_PYTHON ON)
  elseif(required)
    message(FATAL_ERROR "The Python package needs numpy for ${Python_EXECUTABLE}: python3-numpy")
  else()
    set(SPINALTAP_PYTHON OFF)
  endif()
endif()
