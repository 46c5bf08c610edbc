# What we ask of the compiler. Each flag is given to those that know it.
include(CheckCXXCompilerFlag)
function(occlod_known_flags variable)
  set(known "")
  foreach(flag IN LISTS ARGN)
    string(MAKE_C_IDENTIFIER "OCCLOD_KNOWS${flag}" knows)
    check_cxx_compiler_flag(${flag} ${knows})
    if(${knows})
      list(APPEND known ${flag})
    endif()
  endforeach()
  set(${variable} ${known} PARENT_SCOPE)
endfunction()

# No fused multiply-add that the source does not ask for: results are the same on every machine with IEEE arithmetic.
# Nobody looks at errno or at floating-point traps, so roots and conditions on floats may be compiled to instructions.
occlod_known_flags(OCCLOD_ARITHMETIC_FLAGS -ffp-contract=off -fno-math-errno -fno-trapping-math)

# Nobody replaces a function of the library by one of the same name, so GCC may inline them in code for shared libraries
# too, as Clang does anyway.
if(NOT EMSCRIPTEN)  # which has no shared ones, and warns
  occlod_known_flags(OCCLOD_LIBRARY_FLAGS -fno-semantic-interposition)
endif()

# Our own code compiles without a warning. Never passed on to consumers.
occlod_known_flags(occlod_warning_flags
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion -Wold-style-cast -Wnon-virtual-dtor -Woverloaded-virtual)
# GCC 12 warns falsely about "a" + std::string (bug 105651).
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  list(APPEND occlod_warning_flags -Wno-restrict)
endif()
# Where sizes have 32 bits, every file is refused whose size has more, and with it all counts in it.
if(CMAKE_SIZEOF_VOID_P EQUAL 4)
  list(APPEND occlod_warning_flags -Wno-shorten-64-to-32 -Wno-sign-conversion)
endif()
if(OCCLOD_WARNINGS_AS_ERRORS)
  list(APPEND occlod_warning_flags -Werror)
endif()
add_library(occlod_warnings INTERFACE)
target_compile_options(occlod_warnings INTERFACE ${occlod_warning_flags})
