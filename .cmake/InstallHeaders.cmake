# Part of `cmake --install`: public headers go below include/spinaltap/ and say so: "core/ct/level.h" becomes
# "spinaltap/core/ct/level.h", so that no header of a program's own is taken for one of ours. Those of detail/, and those
# that name nlohmann's types, are not for programs. `source` and `include` are set.
foreach(folder core vdb mesh)
  file(GLOB_RECURSE headers RELATIVE ${source} ${source}/${folder}/*.h)
  list(FILTER headers EXCLUDE REGEX "/detail/|json[^/]*\\.h$")
  foreach(header IN LISTS headers)
    file(READ ${source}/${header} text)
    string(REGEX REPLACE "(#include \")((core|vdb|mesh)/)" "\\1spinaltap/\\2" text "${text}")
    if(header STREQUAL "mesh/spinaltap.h")
      set(header spinaltap.h)
    elseif(header STREQUAL "vdb/sim/spinaltap_c.h")
      set(header spinaltap_c.h)
    endif()
    set(installed ${CMAKE_INSTALL_PREFIX}/${include}/spinaltap/${header})
    file(WRITE $ENV{DESTDIR}${installed} "${text}")
    list(APPEND CMAKE_INSTALL_MANIFEST_FILES ${installed})
  endforeach()
endforeach()
