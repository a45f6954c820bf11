# Targets of this project: spinaltap_library(core), spinaltap_link(core PUBLIC Eigen3::Eigen).
include(CheckCXXSymbolExists)

# The name of our own target for `core`, `vdb`, ..., or the name itself for a foreign one.
function(spinaltap_target_name out folder)
  if(TARGET spinaltap_${folder})
    set(${out} spinaltap_${folder} PARENT_SCOPE)
  else()
    set(${out} ${folder} PARENT_SCOPE)
  endif()
endfunction()

# Links `target` of `folder` to libraries, rejecting those that SPINALTAP_LINKS_<folder> does not list.
function(spinaltap_link folder target scope)
  foreach(library IN LISTS ARGN)
    if(NOT library IN_LIST SPINALTAP_LINKS_${folder})
      message(FATAL_ERROR "${folder}/ may not link ${library}; the root CMakeLists.txt lists what it may")
    endif()
    spinaltap_target_name(name ${library})
    target_link_libraries(${target} ${scope} ${name})
  endforeach()
  set_property(GLOBAL APPEND PROPERTY SPINALTAP_TARGETS_${folder} ${target})
endfunction()

# A static library spinaltap_<folder> of all sources below the current folder, with the alias spinaltap::<folder>.
function(spinaltap_library folder)
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS *.cpp *.h)
  add_library(spinaltap_${folder} STATIC ${sources})
  add_library(spinaltap::${folder} ALIAS spinaltap_${folder})
  set_target_properties(spinaltap_${folder} PROPERTIES EXPORT_NAME ${folder})
  target_compile_features(spinaltap_${folder} PUBLIC cxx_std_20)
  target_include_directories(spinaltap_${folder} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_link_libraries(spinaltap_${folder} PRIVATE $<BUILD_INTERFACE:spinaltap_flags>)
endfunction()

# Adds kernels (see core/base/kernel_sets.h) to a target: sources of the current folder, compiled once for each set of
# vector instructions with that set's flags, alone and without a precompiled header.
function(spinaltap_kernels target)
  check_cxx_symbol_exists(__x86_64__ "" SPINALTAP_IS_X86)
  foreach(source IN LISTS ARGN)
    cmake_path(GET source STEM name)
    cmake_path(RELATIVE_PATH CMAKE_CURRENT_SOURCE_DIR BASE_DIRECTORY ${PROJECT_SOURCE_DIR} OUTPUT_VARIABLE folder)
    foreach(set IN ITEMS "portable;portable;16" "avx2;AVX2;32;-mavx2"
                         "avx512;AVX-512;64;-mavx512f;-mavx512bw;-mavx512vl;-mavx512dq")
      list(POP_FRONT set id words bytes)
      if(id STREQUAL portable OR SPINALTAP_IS_X86)
        set(generated ${CMAKE_CURRENT_BINARY_DIR}/kernels/${name}_${id}.cpp)
        file(CONFIGURE OUTPUT ${generated} @ONLY CONTENT
             "#define SPINALTAP_KERNEL_SET @id@
#define SPINALTAP_KERNEL_NAME \"@words@\"
#define SPINALTAP_VECTOR_BYTES @bytes@
#include \"@folder@/@source@\"
")
        target_sources(${target} PRIVATE ${generated})
        # Square roots and choices in vectors; nobody here reads errno or floating-point exceptions.
        set_source_files_properties(${generated} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON SKIP_PRECOMPILE_HEADERS ON
                                    COMPILE_OPTIONS "-fno-math-errno;-fno-trapping-math;${set}")
      endif()
    endforeach()
  endforeach()
endfunction()

# What a program links: spinaltap::spinaltap, the three libraries; and spinaltap::shared, the same objects in one shared
# library. In the build tree too `#include <spinaltap/spinaltap.h>` finds them.
function(spinaltap_whole)
  set(include ${CMAKE_BINARY_DIR}/include/spinaltap)
  file(MAKE_DIRECTORY ${include})
  foreach(folder core vdb mesh)
    file(CREATE_LINK ${PROJECT_SOURCE_DIR}/${folder} ${include}/${folder} SYMBOLIC)
  endforeach()
  file(CREATE_LINK ${PROJECT_SOURCE_DIR}/vdb/sim/spinaltap.h ${include}/spinaltap.h SYMBOLIC)
  file(CREATE_LINK ${PROJECT_SOURCE_DIR}/vdb/sim/spinaltap_c.h ${include}/spinaltap_c.h SYMBOLIC)

  add_library(spinaltap_all INTERFACE)
  add_library(spinaltap::spinaltap ALIAS spinaltap_all)
  set_target_properties(spinaltap_all PROPERTIES EXPORT_NAME spinaltap)
  target_link_libraries(spinaltap_all INTERFACE spinaltap_mesh spinaltap_vdb spinaltap_core)
  target_include_directories(spinaltap_all INTERFACE $<BUILD_INTERFACE:${CMAKE_BINARY_DIR}/include>)

  add_library(spinaltap_shared SHARED $<TARGET_OBJECTS:spinaltap_core> $<TARGET_OBJECTS:spinaltap_vdb>
              $<TARGET_OBJECTS:spinaltap_mesh>)
  add_library(spinaltap::shared ALIAS spinaltap_shared)
  set_target_properties(spinaltap_shared PROPERTIES EXPORT_NAME shared OUTPUT_NAME spinaltap VERSION ${PROJECT_VERSION}
                        SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
  target_compile_features(spinaltap_shared PUBLIC cxx_std_20)
  target_include_directories(spinaltap_shared PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<BUILD_INTERFACE:${CMAKE_BINARY_DIR}/include>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_link_libraries(spinaltap_shared PUBLIC Eigen3::Eigen TBB::tbb)
  target_link_libraries(spinaltap_shared PRIVATE gdcmMSFF Nifti2::nifti2 ZLIB::ZLIB hdf5::hdf5 OpenVDB::openvdb
                        OpenMeshCore OpenMeshTools)
  # Who hands vectors of Eigen's over must agree on how they lie in memory, whatever CPU each side is compiled for.
  target_compile_definitions(spinaltap_shared INTERFACE $<INSTALL_INTERFACE:EIGEN_MAX_ALIGN_BYTES=16>)
  target_compile_definitions(spinaltap_core INTERFACE $<INSTALL_INTERFACE:EIGEN_MAX_ALIGN_BYTES=16>)
endfunction()

# Fails the configuration when a target links something that its folder's list does not have.
function(spinaltap_check_links)
  foreach(folder core vdb mesh apps tests)
    set(allowed spinaltap_flags "$<BUILD_INTERFACE:spinaltap_flags>")
    foreach(library IN LISTS SPINALTAP_LINKS_${folder})
      spinaltap_target_name(name ${library})
      list(APPEND allowed ${name})
    endforeach()
    get_property(targets GLOBAL PROPERTY SPINALTAP_TARGETS_${folder})
    list(REMOVE_DUPLICATES targets)
    foreach(target IN LISTS targets)
      get_target_property(linked ${target} LINK_LIBRARIES)
      foreach(library IN LISTS linked)
        if(NOT library IN_LIST allowed)
          message(FATAL_ERROR "${target} links ${library}, which the root CMakeLists.txt does not allow for ${folder}/")
        endif()
      endforeach()
    endforeach()
  endforeach()
endfunction()
