# Installs libraries with exported targets (find_package(Intaglio)), pkg-config files, public headers, the command, scenes; and the
# packages that CPack makes of them (cpack -G DEB).
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(INTAGLIO_ABI 1) # raised when a program that links the shared libraries must be built anew

# Called for each library. With shared libraries, symbols that are not ours are hidden (cmake/exported.map).
function(intaglio_installed name description deps modules packages libs)
  set_property(GLOBAL APPEND PROPERTY INTAGLIO_LIBRARIES ${name})
  set_target_properties(intaglio_${name} PROPERTIES OUTPUT_NAME intaglio-${name} EXPORT_NAME ${name} VERSION ${INTAGLIO_ABI}.${PROJECT_VERSION}
                                                    SOVERSION ${INTAGLIO_ABI} DEFINE_SYMBOL "")
  target_include_directories(intaglio_${name} INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_compile_features(intaglio_${name} PUBLIC cxx_std_20)
  if(BUILD_SHARED_LIBS)
    target_link_options(intaglio_${name} PRIVATE -Wl,--version-script=${PROJECT_SOURCE_DIR}/cmake/exported.map -Wl,--no-undefined)
    set_target_properties(intaglio_${name} PROPERTIES LINK_DEPENDS ${PROJECT_SOURCE_DIR}/cmake/exported.map)
  endif()
  install(TARGETS intaglio_${name} EXPORT IntaglioTargets
          LIBRARY COMPONENT runtime NAMELINK_COMPONENT development ARCHIVE COMPONENT development)

  # For IntaglioConfig.cmake: what it links, itself and by others, and what these need of the system.
  set(links "")
  foreach(dep IN LISTS deps)
    get_property(more GLOBAL PROPERTY INTAGLIO_LINKS_${dep})
    list(APPEND links ${dep} ${more})
  endforeach()
  list(REMOVE_DUPLICATES links)
  set_property(GLOBAL PROPERTY INTAGLIO_LINKS_${name} ${links})
  set(named ${INTAGLIO_MODULES})
  set(found "")
  set(private "")
  foreach(module IN LISTS modules)
    set(entry ${INTAGLIO_MODULES})
    list(FILTER entry INCLUDE REGEX "^${module}=")
    list(APPEND found ${entry})
    string(REGEX REPLACE ".*=" "" entry ${entry})
    string(REPLACE "," " " entry ${entry})
    list(APPEND private ${entry})
  endforeach()
  string(JOIN "\n" text "set(intaglio_links_${name} ${links})" "set(intaglio_modules_${name} ${found})"
         "set(intaglio_packages_${name} ${packages})" "")
  set_property(GLOBAL APPEND_STRING PROPERTY INTAGLIO_COMPONENT_DEPS "${text}")

  # For pkg-config.
  list(TRANSFORM deps PREPEND intaglio- OUTPUT_VARIABLE requires)
  if(name STREQUAL core)
    list(APPEND requires eigen3)
    list(APPEND private fmt)
  endif()
  list(JOIN requires ", " requires)
  list(JOIN private " " requires_private)
  set(libs_private "")
  foreach(library IN LISTS packages libs)
    if(library STREQUAL embree)
      string(APPEND libs_private " -lembree3")
    elseif(library STREQUAL Threads::Threads)
      string(APPEND libs_private " -pthread")
    elseif(NOT library MATCHES "::")
      string(APPEND libs_private " -l${library}")
    endif()
  endforeach()
  if(BUILD_SHARED_LIBS) # which have found their own libraries; our headers include none of them
    set(requires_private "")
    set(libs_private "")
  endif()
  file(RELATIVE_PATH to_prefix /${CMAKE_INSTALL_LIBDIR}/pkgconfig /) # so that what is installed can be moved
  configure_file(${PROJECT_SOURCE_DIR}/cmake/intaglio.pc.in ${PROJECT_BINARY_DIR}/pkgconfig/intaglio-${name}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/pkgconfig/intaglio-${name}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)
endfunction()

# Called once, after the last library.
function(intaglio_install_package)
  get_property(INTAGLIO_LIBRARIES GLOBAL PROPERTY INTAGLIO_LIBRARIES)
  get_property(INTAGLIO_COMPONENT_DEPS GLOBAL PROPERTY INTAGLIO_COMPONENT_DEPS)
  list(JOIN INTAGLIO_LIBRARIES " " INTAGLIO_LIBRARIES)
  set(folder ${CMAKE_INSTALL_LIBDIR}/cmake/Intaglio)
  configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/IntaglioConfig.cmake.in ${PROJECT_BINARY_DIR}/IntaglioConfig.cmake
                                INSTALL_DESTINATION ${folder})
  write_basic_package_version_file(${PROJECT_BINARY_DIR}/IntaglioConfigVersion.cmake COMPATIBILITY SameMinorVersion)
  install(FILES ${PROJECT_BINARY_DIR}/IntaglioConfig.cmake ${PROJECT_BINARY_DIR}/IntaglioConfigVersion.cmake DESTINATION ${folder}
          COMPONENT development)
  install(EXPORT IntaglioTargets NAMESPACE intaglio:: DESTINATION ${folder} COMPONENT development)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/intaglio DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development
          FILES_MATCHING PATTERN "*.h")
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/scenes ${PROJECT_SOURCE_DIR}/studies ${PROJECT_SOURCE_DIR}/materials DESTINATION ${CMAKE_INSTALL_DATADIR}/intaglio COMPONENT data)
endfunction()

# Packages: the command (intaglio), the libraries (libintaglio1), what is built against them (libintaglio-dev), scenes (intaglio-data).
# dpkg-shlibdeps finds the dependencies of the first two.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME intaglio)
set(CPACK_PACKAGE_CONTACT "The Intaglio developers <intaglio@example.org>")
set(CPACK_PACKAGE_HOMEPAGE_URL "https://example.org/intaglio")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "One texture that is seen, felt, heard and moved on")
set(CPACK_VERBATIM_VARIABLES ON)
set(CPACK_STRIP_FILES ON)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_COMPONENTS_ALL tools runtime development data)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${PROJECT_BINARY_DIR})
set(version "(= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_TOOLS_PACKAGE_NAME intaglio)
set(CPACK_DEBIAN_TOOLS_PACKAGE_SECTION science)
set(CPACK_DEBIAN_TOOLS_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_TOOLS_PACKAGE_DEPENDS "libintaglio${INTAGLIO_ABI} ${version}")
set(CPACK_DEBIAN_TOOLS_PACKAGE_RECOMMENDS "intaglio-data ${version}, ffmpeg")
set(CPACK_COMPONENT_TOOLS_DESCRIPTION "The intaglio command: runs, renders, imports, bakes and measures.")
set(CPACK_DEBIAN_RUNTIME_PACKAGE_NAME libintaglio${INTAGLIO_ABI})
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_RECOMMENDS "libegl1, libgl1, libgl1-mesa-dri, libopenblas0-pthread") # opened by name
set(CPACK_COMPONENT_RUNTIME_DESCRIPTION "Shared libraries of Intaglio.")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libintaglio-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "libintaglio${INTAGLIO_ABI} ${version}, libeigen3-dev, libexpected-dev")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SUGGESTS "libbullet-dev, pkg-config, cmake")
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "Headers, CMake and pkg-config files to build programs with Intaglio.")
set(CPACK_DEBIAN_DATA_PACKAGE_NAME intaglio-data)
set(CPACK_DEBIAN_DATA_PACKAGE_ARCHITECTURE all)
set(CPACK_COMPONENT_DATA_DESCRIPTION "Scenes with their modal models, and materials, of Intaglio.")
include(CPack)
