# Installed tree: include/sopt/<folder>/*.h, one static library per folder, a CMake package that
# gives sopt::sopt, and a pkg-config file.
include(CMakePackageConfigHelpers)

add_library(sopt_all INTERFACE)
add_library(sopt::sopt ALIAS sopt_all)
set_target_properties(sopt_all PROPERTIES EXPORT_NAME sopt)
target_link_libraries(sopt_all INTERFACE sopt_planner)

get_property(libraries GLOBAL PROPERTY SOPT_LIBRARIES)
install(TARGETS ${libraries} sopt_all EXPORT sopt-targets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
  FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/sopt)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/sopt)
install(EXPORT sopt-targets NAMESPACE sopt:: DESTINATION ${package_dir})
configure_package_config_file(cmake/sopt-config.cmake.in ${PROJECT_BINARY_DIR}/sopt-config.cmake
  INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/sopt-config-version.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES
  ${PROJECT_BINARY_DIR}/sopt-config.cmake ${PROJECT_BINARY_DIR}/sopt-config-version.cmake
  DESTINATION ${package_dir})

# Libraries were added bottom up; a linker wants users before what they use.
list(REVERSE libraries)
list(TRANSFORM libraries PREPEND "-l" OUTPUT_VARIABLE pc_libraries)
list(JOIN pc_libraries " " pc_libraries)
get_target_property(pc_definitions sopt_models INTERFACE_COMPILE_DEFINITIONS)
list(TRANSFORM pc_definitions PREPEND "-D")
get_target_property(pc_options sopt_models INTERFACE_COMPILE_OPTIONS)
list(JOIN pc_definitions " " pc_definitions)
list(JOIN pc_options " " pc_options)
file(RELATIVE_PATH pc_prefix /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
string(REGEX REPLACE "/$" "" pc_prefix "${pc_prefix}")
configure_file(cmake/sopt.pc.in ${PROJECT_BINARY_DIR}/sopt.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/sopt.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
