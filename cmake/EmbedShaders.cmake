# intaglio_embed_shaders(target): the files of src/render/shaders become the generated header "intaglio_shaders.h", so that
# the program needs no data folder.
function(intaglio_embed_shaders target)
  file(GLOB shaders CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/render/shaders/*.vert
       ${PROJECT_SOURCE_DIR}/src/render/shaders/*.frag ${PROJECT_SOURCE_DIR}/src/render/shaders/*.glsl)
  set(header ${PROJECT_BINARY_DIR}/generated/intaglio_shaders.h)
  add_custom_command(
    OUTPUT ${header}
    COMMAND ${CMAKE_COMMAND} -DOUT=${header} "-DSHADERS=${shaders}" -P ${PROJECT_SOURCE_DIR}/cmake/write_shader_header.cmake
    DEPENDS ${shaders} ${PROJECT_SOURCE_DIR}/cmake/write_shader_header.cmake
    COMMENT "Embedding shaders" VERBATIM)
  target_sources(${target} PRIVATE ${header})
  target_include_directories(${target} PRIVATE ${PROJECT_BINARY_DIR}/generated)
endfunction()
