# Libraries for other programs, one component each: find_package(gigabake COMPONENTS shard) defines gigabake::shard.
include(CMakePackageConfigHelpers)
include(cmake/public_headers.cmake)

# Each component follows the components that it links.
set(gb_installed_components core georeference system area edit shard scene source export kernels viewer query)
set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/gigabake)

# gb_install_component(component): installs the library of a component, its public headers, and gigabake-<component>.cmake, which
# defines its targets. These include libraries of cmake/dependencies.cmake that no earlier component exported. Appends
# the component's dependencies, read from its target, to gb_component_table for gigabakeConfig.cmake.
set(gb_component_table "")
set(gb_exported "")
function(gb_install_component component)
  set(components "")
  set(packages "")
  set(exported gigabake_${component})
  get_target_property(libraries gigabake_${component} LINK_LIBRARIES)
  foreach(library ${libraries})
    if(library MATCHES "^gigabake_(.+)$")
      list(APPEND components ${CMAKE_MATCH_1})
    elseif(library MATCHES "^gb::(.+)$")
      list(APPEND exported gb_${CMAKE_MATCH_1})
    elseif(library MATCHES "^([A-Za-z0-9]+)::")
      list(APPEND packages ${CMAKE_MATCH_1})
    endif()
  endforeach()
  if(gb_exported)
    list(REMOVE_ITEM exported ${gb_exported})
  endif()
  set_target_properties(gigabake_${component} PROPERTIES EXPORT_NAME ${component})
  install(TARGETS ${exported} EXPORT gigabake-${component} ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)
  install(EXPORT gigabake-${component} NAMESPACE gigabake:: DESTINATION ${package_folder} COMPONENT development)
  foreach(header ${gb_public_headers_${component}})
    if(NOT EXISTS ${CMAKE_SOURCE_DIR}/${header})
      message(FATAL_ERROR "cmake/public_headers.cmake: ${header} does not exist")
    endif()
    get_filename_component(folder ${header} DIRECTORY)
    install(FILES ${CMAKE_SOURCE_DIR}/${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/gigabake/${folder}
            COMPONENT development)
  endforeach()
  set(gb_exported ${gb_exported} ${exported} PARENT_SCOPE)
  set(gb_component_table "${gb_component_table}set(gigabake_${component}_components ${components})\nset(gigabake_${component}_packages ${packages})\n"
      PARENT_SCOPE)
endfunction()
foreach(component ${gb_installed_components})
  gb_install_component(${component})
endforeach()

configure_package_config_file(${CMAKE_SOURCE_DIR}/packaging/gigabakeConfig.cmake.in
                              ${CMAKE_BINARY_DIR}/gigabakeConfig.cmake INSTALL_DESTINATION ${package_folder}
                              PATH_VARS GIGABAKE_MODULE_FOLDER)
write_basic_package_version_file(${CMAKE_BINARY_DIR}/gigabakeConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/gigabakeConfig.cmake ${CMAKE_BINARY_DIR}/gigabakeConfigVersion.cmake
        DESTINATION ${package_folder} COMPONENT development)
