# Writes OUTPUT, a C++ source with a fingerprint of the code that each stage's results follow from: of the names and
# content of its modules' sources. cmake -D SOURCE_DIR=. -D OUTPUT=code_fingerprint.cpp -P CodeFingerprint.cmake
cmake_minimum_required(VERSION 3.25)

set(modules_mask core/base core/ct core/segment core/files)
set(modules_fit core/base core/ct core/surface core/rbf core/files)
set(modules_drilling core vdb)

set(cases "")
foreach(stage mask fit drilling)
  set(text "")
  foreach(module IN LISTS modules_${stage})
    file(GLOB_RECURSE sources RELATIVE ${SOURCE_DIR}
         ${SOURCE_DIR}/${module}/*.cpp ${SOURCE_DIR}/${module}/*.h ${SOURCE_DIR}/${module}/*.inl)
    list(SORT sources)
    foreach(source IN LISTS sources)
      file(SHA256 ${SOURCE_DIR}/${source} hash)
      string(APPEND text "${source} ${hash}\n")
    endforeach()
  endforeach()
  string(SHA256 hash "${text}")
  string(SUBSTRING ${hash} 0 16 hash)
  string(APPEND cases "    case CodeStage::${stage}:\n      return \"${hash}\";\n")
endforeach()

file(WRITE ${OUTPUT} "#include \"core/base/code_fingerprint.h\"

namespace spinaltap {

const char* code_fingerprint(CodeStage stage) {
  switch (stage) {
${cases}  }
  return \"\";
}

}  // namespace spinaltap
")
