# cmake -D WORK_DIR=... -D CHECK=check_folders.cmake -P: each broken rule alone must be found, and a good tree pass.
cmake_minimum_required(VERSION 3.25)
function(check out)
  execute_process(COMMAND ${CMAKE_COMMAND} -D SOURCE_DIR=${WORK_DIR} -P ${CHECK} RESULT_VARIABLE result
                  OUTPUT_QUIET ERROR_VARIABLE message)
  set(${out} ${result} PARENT_SCOPE)
  set(message "${message}" PARENT_SCOPE)
endfunction()

function(fresh_tree)
  file(REMOVE_RECURSE ${WORK_DIR})
  file(WRITE ${WORK_DIR}/README.md "good\n")
  file(WRITE ${WORK_DIR}/.hidden/file "good\n")
  file(WRITE ${WORK_DIR}/build-debug/other.cpp "#include <QWidget>\n")
  file(WRITE ${WORK_DIR}/core/ct/read.cpp "#include <gdcmReader.h>\n#include <Eigen/Core>\n")
  file(WRITE ${WORK_DIR}/core/ct/read.h "// #include \"vdb/bake/bake.h\"\n#include \"core/base/error.h\"\n")
  file(WRITE ${WORK_DIR}/core/files/json_file.h "#include <nlohmann/json_fwd.hpp>\n")
  file(WRITE ${WORK_DIR}/core/files/detail/tool_json.h "#include \"core/files/json_file.h\"\n")
  file(WRITE ${WORK_DIR}/core/files/plan.cpp "#include <nlohmann/json.hpp>\n#include \"core/files/detail/tool_json.h\"\n")
  file(WRITE ${WORK_DIR}/vdb/detail/grids.h "#include <openvdb/openvdb.h>\n")
  file(WRITE ${WORK_DIR}/vdb/bake/bake.cpp "#include \"vdb/detail/grids.h\"\n#include \"vdb/bake/detail/one.h\"\n")
  file(WRITE ${WORK_DIR}/core/session/operator/operator.cpp "#include \"core/session/operator/operator.h\"\n")
  file(WRITE ${WORK_DIR}/vdb/sim/replay.cpp "#include \"vdb/bake/bake.h\"\n#include \"core/files/plan.h\"\n")
  file(WRITE ${WORK_DIR}/mesh/io.cpp "#include <OpenMesh/Core/IO/MeshIO.hh>\n#include \"vdb/bake/bake.h\"\n")
  file(WRITE ${WORK_DIR}/apps/examples/openvdb_grids.cpp "#include <openvdb/openvdb.h>\n")
  file(WRITE ${WORK_DIR}/apps/spinaltap/main.cpp "#include <CLI/CLI.hpp>\n#include \"mesh/io.h\"\n")
endfunction()

fresh_tree()
check(result)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "a tree that keeps the rules was rejected:\n${message}")
endif()

# file, line
set(broken
    core/ct/x.cpp [[#include "vdb/bake/bake.h"]]
    core/ct/x.h [[#  include "mesh/io.h"]]
    core/ct/x.cpp [[#include <openvdb/openvdb.h>]]
    core/ct/x.cpp [[#include <nlohmann/json.hpp>]]
    core/ct/x.h [[#include <gdcmReader.h>]]
    core/ct/x.h [[#include <nifti2_io.h>]]
    vdb/x.cpp [[#include "mesh/io.h"]]
    vdb/x.h [[#include <openvdb/Grid.h>]]
    vdb/x.cpp [[#include <gdcmReader.h>]]
    mesh/x.h [[#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>]]
    mesh/x.cpp [[#include "apps/report/text.h"]]
    core/ct/x.cpp [[#include <pybind11/pybind11.h>]]
    apps/spinaltap/x.cpp [[#include <Python.h>]]
    apps/python/x.cpp [[#include "apps/report/text.h"]]
    apps/link/x.cpp [[#include "vdb/sim/build_session.h"]]
    apps/spinaltap/x.cpp [[#include <openvdb/openvdb.h>]]
    apps/examples/x.cpp [[#include <openvdb/openvdb.h>]]
    apps/examples/openvdb_x.cpp [[#include <spinaltap/spinaltap.h>]]
    core/ct/x.cpp [[#include "core/segment/seed.h"]]
    core/study/x.h [[#include "core/files/plan.h"]]
    core/surface/x.cpp [[#include "core/base/detail/hdf5_parts.h"]]
    core/other/x.cpp [[int x]]
    core/files/x.h [[#include <nlohmann/json.hpp>]]
    core/files/x.h [[#include <nlohmann/json_fwd.hpp>]]
    core/files/x.h [[#include "core/files/json_file.h"]]
    vdb/x.cpp [[#include "vdb/sim/replay.h"]]
    vdb/grid/x.cpp [[#include "vdb/bake/bake.h"]]
    vdb/remaining/x.cpp [[#include "vdb/bake/detail/one_piece.h"]]
    vdb/other/x.cpp [[int x]]
    core/session/operator/x.cpp [[#include "core/session/drill_session.h"]]
    vdb/sim/x.cpp [[#include "vdb/detail/grids.h"]]
    vdb/sim/x.cpp [[#include "mesh/io.h"]]
    vdb/sim/x.cpp [[#include <nlohmann/json.hpp>]]
    vdb/sim/x.h [[#include "core/files/json_file.h"]]
    apps/report/x.h [[#include "apps/spinaltap/command.h"]]
    apps/spinaltap-planner/x.cpp [[#include "apps/spinaltap/command.h"]]
    mesh/x.cpp [[#include "vdb/detail/grids.h"]]
    apps/spinaltap/x.cpp [[#include <QWidget>]]
    apps/report/x.cpp [[#include <gtest/gtest.h>]]
    src/x.cpp [[int x]]
    notes.txt [[notes]])
while(broken)
  list(POP_FRONT broken file line)
  fresh_tree()
  file(WRITE ${WORK_DIR}/${file} "${line}\n")
  check(result)
  string(REGEX MATCH "^[^/]+" top ${file})
  if(result EQUAL 0 OR NOT message MATCHES "${top}")
    message(FATAL_ERROR "not found: ${line} in ${file}\n${message}")
  endif()
endwhile()
file(REMOVE_RECURSE ${WORK_DIR})
