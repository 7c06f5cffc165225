# intaglio_join(OUT NAME SOURCE...): sets OUT to what a target compiles for its sources: the sources themselves or, with INTAGLIO_JOIN,
# files that include eight of them each. A whole build takes half the time then; a change of one source takes longer. Sources are
# included by their path from the project's folder, so that all clones share a compiler cache (CMAKE_UNITY_BUILD writes whole paths).
option(INTAGLIO_JOIN "Compile eight source files as one: for whole builds" OFF)

# Sources that fuzzing guides by their coverage. Without it mutations are blind; the rest of the library goes without, so that the tests
# that share this build stay fast.
set(INTAGLIO_FUZZED "src/core/(toml|file)\\.cpp|src/surface/image/.*|src/surface/(import|maps|fuse)\\.cpp|src/surface/recipes/recipe_reader\\.cpp|src/mesh/(mesh_file|gltf_.*|triangle_mesh)\\.cpp|src/haptics/haptic_log\\.cpp|src/haptics/vrpn/.*|src/sound/model_file\\.cpp|src/scene/scene.*|src/study/design/(design.*|overrides)\\.cpp|src/evaluate/thresholds\\.cpp|src/sound/bake/fem/netgen_files\\.cpp|apps/window/(script|settings)\\.cpp")

# Highway includes its file once for each kind of processor; Qhull's headers define many macros; in the others users' names stand beside
# the library's own.
set(INTAGLIO_NOT_JOINED "src/sound/resonator_kernel\\.cpp|src/contact/polyhedron\\.cpp|src/.*/api[^/]*\\.cpp|tests/sound/test_public_sound\\.cpp")

function(intaglio_join out name)
  set(compiled "")
  set(fuzzed_sources "")
  set(plain_sources "")
  foreach(source IN LISTS ARGN)
    file(RELATIVE_PATH path ${PROJECT_SOURCE_DIR} ${source})
    set(kind plain)
    if(INTAGLIO_FUZZ AND path MATCHES "^(${INTAGLIO_FUZZED})$")
      set(kind fuzzed)
    endif()
    if(INTAGLIO_JOIN AND NOT path MATCHES "^(${INTAGLIO_NOT_JOINED})$")
      list(APPEND ${kind}_sources ${path})
    else()
      list(APPEND compiled ${source})
      if(kind STREQUAL fuzzed)
        set_source_files_properties(${source} PROPERTIES COMPILE_OPTIONS -fsanitize=fuzzer-no-link)
      endif()
    endif()
  endforeach()
  foreach(kind plain fuzzed)
    list(LENGTH ${kind}_sources count)
    set(first 0)
    while(first LESS count)
      list(SUBLIST ${kind}_sources ${first} 8 eight)
      set(file ${PROJECT_BINARY_DIR}/joined/${name}_${kind}_${first}.cpp)
      list(TRANSFORM eight REPLACE "(.+)" "#include \"\\1\"\n")
      string(JOIN "" includes ${eight})
      file(CONFIGURE OUTPUT ${file} CONTENT "${includes}" @ONLY)
      if(kind STREQUAL fuzzed)
        set_source_files_properties(${file} PROPERTIES COMPILE_OPTIONS -fsanitize=fuzzer-no-link)
      endif()
      list(APPEND compiled ${file})
      math(EXPR first "${first} + 8")
    endwhile()
  endforeach()
  set(${out} ${compiled} PARENT_SCOPE)
endfunction()
