# intaglio_embed_materials(target): every recipe materials/NAME.toml becomes a string constant of the generated header
# "intaglio_materials.h" (a list of names and texts), so that the program needs no data folder.
# Run as a script (cmake -P) this file writes that header, OUT, from the files of the folder MATERIALS.
if(CMAKE_SCRIPT_MODE_FILE)
  file(GLOB recipes ${MATERIALS}/*.toml)
  set(text "#pragma once\n// Generated from materials. Do not edit.\n")
  string(APPEND text "namespace intaglio::surface::materials {\nstruct Embedded {\n  const char* name;\n  const char* text;\n};\n")
  string(APPEND text "inline constexpr Embedded all[] = {\n")
  foreach(recipe IN LISTS recipes)
    get_filename_component(name ${recipe} NAME_WE)
    file(READ ${recipe} source)
    string(APPEND text "{\"${name}\", R\"toml(${source})toml\"},\n")
  endforeach()
  string(APPEND text "};\n}  // namespace intaglio::surface::materials\n")
  file(WRITE ${OUT} "${text}")
  return()
endif()

set(INTAGLIO_EMBED_MATERIALS ${CMAKE_CURRENT_LIST_FILE})

function(intaglio_embed_materials target)
  set(folder ${PROJECT_SOURCE_DIR}/materials)
  file(GLOB recipes CONFIGURE_DEPENDS ${folder}/*.toml)
  set(header ${PROJECT_BINARY_DIR}/generated/materials/intaglio_materials.h)
  add_custom_command(
    OUTPUT ${header}
    COMMAND ${CMAKE_COMMAND} -DOUT=${header} -DMATERIALS=${folder} -P ${INTAGLIO_EMBED_MATERIALS}
    DEPENDS ${recipes} ${INTAGLIO_EMBED_MATERIALS}
    COMMENT "Embedding materials" VERBATIM)
  target_sources(${target} PRIVATE ${header})
  target_include_directories(${target} PRIVATE ${PROJECT_BINARY_DIR}/generated/materials)
endfunction()
