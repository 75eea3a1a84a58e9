# Embeds page.html, the scripts and three.min.js as constants of viewer_resources.h. Included by
# tools/CMakeLists.txt, which gets the source added to sopt_tools; run by itself (cmake -P) with
# OUTPUT it writes that source.
if(NOT CMAKE_SCRIPT_MODE_FILE)
  set(viewer_source ${CMAKE_CURRENT_BINARY_DIR}/viewer_resources.cc)
  set(viewer_files page.html data.js scene.js plots.js viewer.js three.min.js viewer.cmake)
  list(TRANSFORM viewer_files PREPEND ${CMAKE_CURRENT_LIST_DIR}/)
  add_custom_command(OUTPUT ${viewer_source}
    COMMAND ${CMAKE_COMMAND} -DOUTPUT=${viewer_source} -P ${CMAKE_CURRENT_LIST_FILE}
    DEPENDS ${viewer_files} VERBATIM)
  target_sources(sopt_tools PRIVATE ${viewer_source})
  return()
endif()

set(text "#include \"tools/io/viewer/viewer_resources.h\"\n\nnamespace sopt {\n\n")
foreach(entry kViewerPage=page.html kThreeScript=three.min.js
        "kViewerScript=data.js;scene.js;plots.js;viewer.js")
  string(REGEX REPLACE "=.*" "" name "${entry}")
  string(REGEX REPLACE ".*=" "" files "${entry}")
  string(APPEND text "const std::string_view ${name} =\n")
  foreach(file ${files})
    file(READ ${CMAKE_CURRENT_LIST_DIR}/${file} content)
    string(APPEND text "    R\"sopt(${content})sopt\"\n")
  endforeach()
  string(APPEND text "    ;\n\n")
endforeach()
file(WRITE ${OUTPUT} "${text}}  // namespace sopt\n")
