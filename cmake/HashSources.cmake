# cmake -DFILES="a;b" -DNAME=id -DOUTPUT=header.h -P HashSources.cmake: one hash over the content of all files.
set(hashes "")
foreach(file IN LISTS FILES)
  file(SHA256 ${file} hash)
  string(APPEND hashes ${hash})
endforeach()
string(SHA256 id "${hashes}")
file(WRITE ${OUTPUT} "#pragma once\n\nnamespace occlod {\n\ninline constexpr char ${NAME}[] = \"${id}\";\n\n}  // namespace occlod\n")
