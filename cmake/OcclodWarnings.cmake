# Our own code compiles without a warning. Never passed on to consumers.
add_library(occlod_warnings INTERFACE)
target_compile_options(occlod_warnings INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion -Wold-style-cast -Wnon-virtual-dtor -Woverloaded-virtual
  # GCC 12 warns falsely about "a" + std::string (bug 105651).
  $<$<AND:$<CXX_COMPILER_ID:GNU>,$<VERSION_LESS:$<CXX_COMPILER_VERSION>,13>>:-Wno-restrict>
  $<$<BOOL:${OCCLOD_WARNINGS_AS_ERRORS}>:-Werror>)
