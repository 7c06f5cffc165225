# intaglio_compile_schema(target schema): NAME.fbs becomes the header "NAME_generated.h" by Debian's flatbuffers-compiler.
find_program(FLATC flatc REQUIRED)
find_path(FLATBUFFERS_INCLUDE_DIR flatbuffers/flatbuffers.h REQUIRED)

function(intaglio_compile_schema target schema)
  get_filename_component(name ${schema} NAME_WE)
  set(folder ${PROJECT_BINARY_DIR}/generated/schemas)
  set(header ${folder}/${name}_generated.h)
  add_custom_command(
    OUTPUT ${header}
    COMMAND ${FLATC} --cpp -o ${folder} ${schema}
    DEPENDS ${schema} COMMENT "Compiling ${name}.fbs" VERBATIM)
  target_sources(${target} PRIVATE ${header})
  target_include_directories(${target} SYSTEM PRIVATE ${folder} ${FLATBUFFERS_INCLUDE_DIR})
endfunction()
