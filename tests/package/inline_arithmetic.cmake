# cmake -P: compiles all public headers of SOURCE_DIR as a program for a CPU with fused multiply-add would, and fails where
# one of their inline functions then has such an instruction and lies in LIBRARIES too: the linker keeps one of both, and
# the library's bits would hang on its user's flags.
cmake_minimum_required(VERSION 3.25)
file(REMOVE_RECURSE ${WORK_DIR})
file(MAKE_DIRECTORY ${WORK_DIR})
set(text "")
foreach(folder core vdb/sim mesh)  # vdb's grids are templates of OpenVDB's, and take minutes
  file(GLOB_RECURSE headers RELATIVE ${SOURCE_DIR} ${SOURCE_DIR}/${folder}/*.h)
  list(FILTER headers EXCLUDE REGEX "/detail/|json[^/]*\\.h$")
  foreach(header IN LISTS headers)
    string(APPEND text "#include \"${header}\"\n")
  endforeach()
endforeach()
file(WRITE ${WORK_DIR}/all.cpp "${text}${MORE}")
list(REMOVE_ITEM INCLUDES /usr/include)  # the compiler knows it, and in what order
list(TRANSFORM INCLUDES PREPEND "-isystem")
execute_process(COMMAND ${CXX} -std=c++20 -O3 -mavx2 -mfma -fkeep-inline-functions -DEIGEN_MAX_ALIGN_BYTES=16 -w
                        -I${SOURCE_DIR} ${INCLUDES} -c ${WORK_DIR}/all.cpp -o ${WORK_DIR}/all.o
                RESULT_VARIABLE result ERROR_VARIABLE errors)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "the public headers do not compile:\n${errors}")
endif()
execute_process(COMMAND ${OBJDUMP} -d --no-show-raw-insn ${WORK_DIR}/all.o
                COMMAND awk "/^[0-9a-f]+ </ {gsub(/[<>:]/, \"\", $2); name = $2} /\\tvfn?m/ {fused[name] = 1} END {for (name in fused) print name}"
                OUTPUT_VARIABLE fused COMMAND_ERROR_IS_FATAL ANY)
# W, V, u: what a linker takes from wherever it finds it first.
execute_process(COMMAND ${NM} --defined-only ${LIBRARIES}
                COMMAND awk "NF == 3 && $2 ~ /^[WVu]$/ {print $3}" OUTPUT_VARIABLE shared COMMAND_ERROR_IS_FATAL ANY)
string(REPLACE "\n" ";" fused "${fused}")
string(REPLACE "\n" ";" shared "${shared}")
list(REMOVE_DUPLICATES shared)
list(LENGTH fused count)
if(count LESS 5)
  message(FATAL_ERROR "expected fused instructions in some inline function, of Eigen at least: is this the right compiler?")
endif()
set(both "")
foreach(name IN LISTS fused)
  if(name AND name IN_LIST shared)
    list(APPEND both ${name})
  endif()
endforeach()
if(both)
  string(REPLACE ";" "\n" both "${both}")
  message(FATAL_ERROR "arithmetic that a user's compiler would bring in place of the library's; move it to a .cpp or mark it "
                      "[[gnu::always_inline]] (c++filt has the names):\n${both}")
endif()
message(STATUS "${count} inline functions with fused arithmetic, none of them in the libraries")
