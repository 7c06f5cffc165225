# intaglio_embed_text(target file): the text of src/.../NAME.toml becomes the string constant intaglio::embedded::NAME of the generated
# header "intaglio_NAME.h", so that the program needs no data folder.
# Run as a script (cmake -P) this file writes that header, OUT, from the file IN.
if(CMAKE_SCRIPT_MODE_FILE)
  get_filename_component(name ${IN} NAME_WE)
  file(READ ${IN} source)
  string(CONCAT text "#pragma once\n// Generated from ${name}.toml. Do not edit.\nnamespace intaglio::embedded {\n"
         "inline constexpr const char* ${name} = R\"toml(${source})toml\";\n}  // namespace intaglio::embedded\n")
  file(WRITE ${OUT} "${text}")
  return()
endif()

set(INTAGLIO_EMBED_TEXT ${CMAKE_CURRENT_LIST_FILE})

function(intaglio_embed_text target file)
  get_filename_component(name ${file} NAME_WE)
  set(header ${PROJECT_BINARY_DIR}/generated/text/intaglio_${name}.h)
  add_custom_command(
    OUTPUT ${header}
    COMMAND ${CMAKE_COMMAND} -DOUT=${header} -DIN=${PROJECT_SOURCE_DIR}/${file} -P ${INTAGLIO_EMBED_TEXT}
    DEPENDS ${PROJECT_SOURCE_DIR}/${file} ${INTAGLIO_EMBED_TEXT}
    COMMENT "Embedding ${name}" VERBATIM)
  target_sources(${target} PRIVATE ${header})
  target_include_directories(${target} PRIVATE ${PROJECT_BINARY_DIR}/generated/text)
endfunction()
