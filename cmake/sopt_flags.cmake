# Flags of everything that is compiled here.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)

# A plan is the same bytes for every compiler that rounds as IEEE 754 asks: no fused multiply-add
# behind the source's back (GCC contracts by default), and never -ffast-math.
add_compile_options(-ffp-contract=off)
if(SOPT_ARCH)
  add_compile_options(-march=${SOPT_ARCH})
endif()

# Resolve every symbol at start: a first call of a library function must not enter the linker.
add_link_options(LINKER:-z,now)

if(SOPT_SANITIZE)
  # The vptr check needs RTTI, which the libraries do not have.
  set(sanitize_flags -fsanitize=${SOPT_SANITIZE} -fno-sanitize=vptr -fno-sanitize-recover=all
    -fno-omit-frame-pointer)
  # With -fsanitize GCC takes parts of std::regex for uninitialised (GCC bug 105562).
  list(APPEND sanitize_flags $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
  add_compile_options(${sanitize_flags})
  add_link_options(${sanitize_flags})
endif()

add_library(sopt_warnings INTERFACE)
target_compile_options(sopt_warnings INTERFACE
  -Wall -Wextra -Wconversion -Wdouble-promotion -Wshadow $<$<BOOL:${SOPT_WERROR}>:-Werror>
  # GCC 12 warns of string concatenation in its own headers (GCC bug 105651).
  $<$<AND:$<CXX_COMPILER_ID:GNU>,$<VERSION_LESS:$<CXX_COMPILER_VERSION>,13>>:-Wno-restrict>)
