# Part of `cmake --install`: the headers of the promise go below include/spinaltap/ and say so: "core/ct/level.h" becomes
# "spinaltap/core/ct/level.h", so that no header of a program's own is taken for one of ours. `source` and `include` are
# set.
cmake_policy(VERSION 3.25)

# The promise (docs/versions.md): what these reach, and no more. A header that a program of others needs is named here.
set(promised
  vdb/sim/spinaltap.h                       # CT, bone, plan, grade, session, record, study
  vdb/sim/spinaltap_c.h                     # the same in C
  mesh/mesh_io.h                            # meshes in files
  core/session/device/device_plugin.h       # a haptic device of one's own
  core/session/device/open_device.h         # a device by its name
  core/session/device/coupled_operator.h    # a hand at it
  core/sound/session_sound.h)               # how a session sounds

set(todo ${promised})
set(headers "")
while(todo)
  list(POP_FRONT todo header)
  if(header IN_LIST headers)
    continue()
  endif()
  list(APPEND headers ${header})
  file(STRINGS ${source}/${header} lines REGEX "^#include \"")
  foreach(line IN LISTS lines)
    string(REGEX REPLACE "^#include \"([^\"]+)\".*" "\\1" reached "${line}")
    list(APPEND todo ${reached})
  endforeach()
endwhile()

foreach(header IN LISTS headers)
  file(READ ${source}/${header} text)
  string(REGEX REPLACE "(#include \")((core|vdb|mesh)/)" "\\1spinaltap/\\2" text "${text}")
  if(header MATCHES "^vdb/sim/(spinaltap(_c)?\\.h)$")
    set(header ${CMAKE_MATCH_1})
  endif()
  set(installed ${CMAKE_INSTALL_PREFIX}/${include}/spinaltap/${header})
  file(WRITE $ENV{DESTDIR}${installed} "${text}")
  list(APPEND CMAKE_INSTALL_MANIFEST_FILES ${installed})
endforeach()
