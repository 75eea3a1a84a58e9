# sopt_add_library(<name> SOURCES <file>... HEADERS <file>... [LINK <target>...])
#
# Static library sopt_<name>, exported as sopt::<name>: real-time flags, warnings, public headers
# included by their path from the project's root ("opt/planner.h"). Folders list their files by
# GLOB CONFIGURE_DEPENDS: every .cc and .h of a folder belongs to its library, and the build looks
# for new ones.
function(sopt_add_library name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;HEADERS;LINK")
  set(target sopt_${name})
  add_library(${target} STATIC ${arg_SOURCES})
  add_library(sopt::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES
    EXPORT_NAME ${name}
    VERIFY_INTERFACE_HEADER_SETS ON)
  target_sources(${target} PUBLIC FILE_SET HEADERS
    BASE_DIRS ${PROJECT_SOURCE_DIR} FILES ${arg_HEADERS})
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_compile_options(${target} PRIVATE -fno-exceptions -fno-rtti)
  target_link_libraries(${target} PUBLIC ${arg_LINK} PRIVATE $<BUILD_INTERFACE:sopt_warnings>)
  set_property(GLOBAL APPEND PROPERTY SOPT_LIBRARIES ${target})
endfunction()
