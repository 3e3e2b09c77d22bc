# Files that `cmake --install` and cpack include. Components: runtime (the program, its manual and completion),
# development (libraries and headers for find_package), bench (gigabake-bench).
install(TARGETS gigabake DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT runtime)
set(packages runtime=gigabake development=gigabake-dev)
set(documented_programs gigabake)
if(GIGABAKE_BENCH)
  install(TARGETS gigabake-bench DESTINATION ${GIGABAKE_PROGRAM_FOLDER} COMPONENT bench)
  list(APPEND packages bench=gigabake-bench)
  list(APPEND documented_programs gigabake-bench)
endif()

# The program generates its manual; gigabake-bench lists its options for it. Pages are compressed as distributions require.
set(manual ${CMAKE_BINARY_DIR}/manual)
file(MAKE_DIRECTORY ${manual}/man1 ${manual}/bash ${manual}/zsh ${manual}/fish)
add_custom_command(
  OUTPUT ${manual}/written
  COMMAND gigabake man --all ${manual}/man1
  COMMAND sh -c "gzip -9nf ${manual}/man1/*.1"
  COMMAND gigabake completion bash > ${manual}/bash/gigabake
  COMMAND gigabake completion zsh > ${manual}/zsh/_gigabake
  COMMAND gigabake completion fish > ${manual}/fish/gigabake.fish
  COMMAND ${CMAKE_COMMAND} -E touch ${manual}/written
  DEPENDS ${documented_programs} VERBATIM COMMENT "Manual and completion")
add_custom_target(manual ALL DEPENDS ${manual}/written)
install(DIRECTORY ${manual}/man1 DESTINATION ${CMAKE_INSTALL_MANDIR} COMPONENT runtime)
install(DIRECTORY ${manual}/bash/ DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT runtime)
install(DIRECTORY ${manual}/zsh/ DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions COMPONENT runtime)
install(DIRECTORY ${manual}/fish/ DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d COMPONENT runtime)

include(cmake/install_components.cmake)

# cpack -G DEB makes gigabake, gigabake-dev and gigabake-bench, each with its licence and changelog in Debian's folders.
set(CPACK_PROJECT_CONFIG_FILE ${CMAKE_SOURCE_DIR}/cmake/packager.cmake)
set(changelog ${CMAKE_BINARY_DIR}/packaging/changelog)
foreach(package ${packages})
  string(REPLACE "=" ";" package ${package})
  list(GET package 0 component)
  list(GET package 1 name)
  install(CODE "include(\"${CPACK_PROJECT_CONFIG_FILE}\")
    configure_file(\"${CMAKE_SOURCE_DIR}/packaging/changelog\" \"${changelog}\" @ONLY)
    execute_process(COMMAND gzip -9nkf \"${changelog}\" COMMAND_ERROR_IS_FATAL ANY)" COMPONENT ${component})
  install(FILES ${CMAKE_SOURCE_DIR}/packaging/copyright ${changelog}.gz
          DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${name} COMPONENT ${component})
endforeach()

set(CPACK_PACKAGE_NAME gigabake)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "bakes textured terrain into sparse voxel oct-trees")
set(CPACK_PACKAGE_DESCRIPTION "gigabake turns a textured polygonal terrain into a paged scene of sparse
voxel oct-trees, on a laptop or on many ranks, and shows the result in a
window or a browser.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
string(REGEX REPLACE "=[^;]+" "" CPACK_COMPONENTS_ALL "${packages}")
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_NAME gigabake)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_RECOMMENDS "openmpi-bin, hdf5-filter-plugin")
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SUGGESTS gigabake-bench)
set(CPACK_DEBIAN_BENCH_PACKAGE_NAME gigabake-bench)
set(CPACK_DEBIAN_BENCH_PACKAGE_DEPENDS "gigabake (= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME gigabake-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
# The libraries that read shards need these packages. The other libraries need the recommended ones too.
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS
    "libfmt-dev, libhdf5-dev, liblz4-dev, libdeflate-dev, gigabake (= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_RECOMMENDS "libpugixml-dev, libgeographiclib-dev, libtinygltf-dev, libpng-dev, \
zlib1g-dev, libjpeg-dev, libzip-dev, libdraco-dev, libmeshoptimizer-dev, libwebp-dev, libmicrohttpd-dev, libopenexr-dev")
set(CPACK_COMPONENT_RUNTIME_DESCRIPTION "${CPACK_PACKAGE_DESCRIPTION}")
set(CPACK_COMPONENT_BENCH_DESCRIPTION "Benchmarks of gigabake: the program that `gigabake bench` starts. It
measures times, and the errors of voxels and images against references.")
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "Libraries and headers for CMake, one a component: gigabake::shard and ::scene read
and write its files, ::source reads meshes and tilesets, ::export writes other
formats, ::kernels voxelizes, ::viewer renders images,
::query finds first hits.")
include(CPack)
