# Finds every package that the project needs, and defines imported or interface targets named gb::<package>.
find_package(Threads REQUIRED)
find_package(MPI REQUIRED COMPONENTS CXX)
find_package(fmt REQUIRED)
find_package(PNG REQUIRED)
find_package(ZLIB REQUIRED)
find_package(JPEG REQUIRED)
find_package(OpenEXR CONFIG REQUIRED)

# gb_find(NAME header library… [SUFFIXES folders]): defines an interface target for a package without a usable CMake
# config.
function(gb_find name header)
  cmake_parse_arguments(ARG "" "" "LIBS;SUFFIXES" ${ARGN})
  string(TOUPPER ${name} upper)
  find_path(GB_${upper}_INCLUDE ${header} PATH_SUFFIXES ${ARG_SUFFIXES} REQUIRED)
  add_library(gb_${name} INTERFACE)
  add_library(gb::${name} ALIAS gb_${name})
  target_include_directories(gb_${name} SYSTEM INTERFACE ${GB_${upper}_INCLUDE})
  if(ARG_LIBS)
    find_library(GB_${upper}_LIBRARY NAMES ${ARG_LIBS} PATH_SUFFIXES ${ARG_SUFFIXES} REQUIRED)
    target_link_libraries(gb_${name} INTERFACE ${GB_${upper}_LIBRARY})
  endif()
endfunction()

# gb_choice(NAME text): defines the option GIGABAKE_<NAME>: AUTO, ON or OFF. Sets GIGABAKE_HAS_<NAME> to false.
macro(gb_choice name text)
  set(GIGABAKE_${name} AUTO CACHE STRING "${text}: AUTO (where it is found), ON (fail without), OFF")
  set_property(CACHE GIGABAKE_${name} PROPERTY STRINGS AUTO ON OFF)
  set(GIGABAKE_HAS_${name} FALSE)
endmacro()

# gb_chosen(NAME found packages INCLUDES folders… LIBS libraries…): call it after gb_choice. If the library was found,
# sets GIGABAKE_HAS_<NAME> and defines gb::<name>. Otherwise fails if the option is ON, with a message that names the
# packages.
function(gb_chosen name found packages)
  cmake_parse_arguments(ARG "" "" "INCLUDES;LIBS" ${ARGN})
  if(found)
    string(TOLOWER ${name} lower)
    add_library(gb_${lower} INTERFACE)
    add_library(gb::${lower} ALIAS gb_${lower})
    target_include_directories(gb_${lower} SYSTEM INTERFACE ${ARG_INCLUDES})
    target_link_libraries(gb_${lower} INTERFACE ${ARG_LIBS})
    set(GIGABAKE_HAS_${name} TRUE PARENT_SCOPE)
  elseif(NOT GIGABAKE_${name} STREQUAL "AUTO")
    message(FATAL_ERROR "GIGABAKE_${name}=${GIGABAKE_${name}}: expected ${packages} to be installed")
  endif()
endfunction()

# gb_links(variable program INCLUDES folders… LIBS libraries…): sets the variable to true if the program text links.
include(CheckCXXSourceCompiles)
function(gb_links variable program)
  cmake_parse_arguments(ARG "" "" "INCLUDES;LIBS" ${ARGN})
  set(CMAKE_REQUIRED_INCLUDES ${ARG_INCLUDES})
  set(CMAKE_REQUIRED_LIBRARIES ${ARG_LIBS})
  check_cxx_source_compiles("${program}" ${variable})
endfunction()

gb_find(hdf5 hdf5.h LIBS hdf5_serial hdf5 SUFFIXES hdf5/serial)
gb_find(lz4 lz4.h LIBS lz4)
gb_find(deflate libdeflate.h LIBS deflate)
gb_find(tinygltf tiny_gltf.h LIBS tinygltf)
gb_find(geographiclib GeographicLib/LocalCartesian.hpp LIBS GeographicLib Geographic)
gb_find(pugixml pugixml.hpp LIBS pugixml)
gb_find(xxhash xxhash.h)
gb_find(json nlohmann/json.hpp)
gb_find(cli11 CLI/CLI.hpp)
gb_find(microhttpd microhttpd.h LIBS microhttpd)
