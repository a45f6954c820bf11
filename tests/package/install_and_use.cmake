# cmake -P: installs BUILD_DIR below WORK_DIR, configures, builds and runs CONSUMER_DIR against it, and asks the
# installed program for its version.
cmake_minimum_required(VERSION 3.25)
function(run what)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${what} failed (${result}):\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

function(expect_text what text)
  string(FIND "${output}" "${text}" found)
  if(found EQUAL -1)
    message(FATAL_ERROR "${what}: expected \"${text}\", found:\n${output}")
  endif()
endfunction()

set(prefix ${WORK_DIR}/prefix)
file(REMOVE_RECURSE ${WORK_DIR})
file(MAKE_DIRECTORY ${WORK_DIR})
# An installation packager's DESTDIR would put the files elsewhere.
unset(ENV{DESTDIR})

run("cmake --install" ${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${prefix} --config ${CONFIG})
foreach(file phantom/l3.json materials/vertebra.json)
  if(NOT EXISTS ${prefix}/${DATADIR}/spinaltap/${file})
    message(FATAL_ERROR "not installed: ${file}")
  endif()
endforeach()
file(GLOB_RECURSE private_headers ${prefix}/include/*/detail/*.h)
if(private_headers)
  message(FATAL_ERROR "private headers were installed: ${private_headers}")
endif()
file(GLOB_RECURSE headers ${prefix}/include/*.h)
foreach(header IN LISTS headers)
  file(STRINGS ${header} json REGEX "nlohmann")
  if(json)
    message(FATAL_ERROR "installed, though it needs a library that users need not have: ${header}")
  endif()
endforeach()

# The installed package may not lean on the source or build tree.
file(GLOB_RECURSE package_files ${prefix}/*.cmake)
foreach(file IN LISTS package_files)
  file(READ ${file} text)
  string(FIND "${text}" "${BUILD_DIR}" found)
  if(NOT found EQUAL -1 AND NOT prefix MATCHES "^${BUILD_DIR}")
    message(FATAL_ERROR "${file} names the build tree")
  endif()
endforeach()

run("configuring the consumer" ${CMAKE_COMMAND} -S ${CONSUMER_DIR} -B ${WORK_DIR}/build -G ${GENERATOR}
    -DCMAKE_BUILD_TYPE=${CONFIG} -DCMAKE_CXX_COMPILER=${CXX_COMPILER} -DCMAKE_CXX_FLAGS=${CXX_FLAGS}
    "-DCMAKE_PREFIX_PATH=${prefix};${PREFIX_PATH}" -DEXPECTED_VERSION=${VERSION})
run("building the consumer" ${CMAKE_COMMAND} --build ${WORK_DIR}/build --config ${CONFIG})
find_program(CONSUMER consumer PATHS ${WORK_DIR}/build ${WORK_DIR}/build/${CONFIG} NO_DEFAULT_PATH REQUIRED)
run("the consumer" ${CONSUMER})
expect_text("the consumer" "SpinalTap ${VERSION}")

run("spinaltap --version" ${prefix}/${BINDIR}/spinaltap --version)
expect_text("spinaltap --version" "${VERSION}")
