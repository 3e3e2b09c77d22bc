# Formats inside sources that need a separate library. If the library is missing, the build does not read the format: it
# refuses such content with a message that names the package.
#
# gb_codec(NAME header library package): defines the option GIGABAKE_<NAME>: AUTO, ON (required) or OFF. If the library
# is found, sets GIGABAKE_HAS_<NAME> and defines gb::<name>. SUFFIXES lists more folders of headers and libraries.
function(gb_codec name header library package)
  cmake_parse_arguments(ARG "" "" "SUFFIXES" ${ARGN})
  gb_choice(${name} ${package})
  set(GIGABAKE_HAS_${name} FALSE PARENT_SCOPE)
  if(GIGABAKE_${name} STREQUAL "OFF")
    return()
  endif()
  find_path(GB_${name}_INCLUDE ${header} PATH_SUFFIXES ${ARG_SUFFIXES})
  find_library(GB_${name}_LIBRARY ${library})
  set(found FALSE)
  if(GB_${name}_INCLUDE AND GB_${name}_LIBRARY)
    set(found TRUE)
  endif()
  gb_chosen(${name} ${found} ${package} INCLUDES ${GB_${name}_INCLUDE} LIBS ${GB_${name}_LIBRARY})
  if(NOT found)
    message(NOTICE "gigabake: sources that need ${package} will be refused: it is not installed")
  endif()
  set(GIGABAKE_HAS_${name} ${GIGABAKE_HAS_${name}} PARENT_SCOPE)
endfunction()

gb_codec(ZIP zip.h zip libzip-dev)
gb_codec(DRACO draco/compression/decode.h draco libdraco-dev)
if(TARGET gb_draco)
  # libdraco contains another version of tinygltf. This order of libraries makes the linker find the packaged one first.
  target_link_libraries(gb_tinygltf INTERFACE gb::draco)
endif()
gb_codec(MESHOPT meshoptimizer.h meshoptimizer libmeshoptimizer-dev)
gb_codec(WEBP webp/decode.h webp libwebp-dev)
gb_codec(GDAL gdal_priv.h gdal libgdal-dev SUFFIXES gdal)
if(GIGABAKE_HAS_GDAL)
  # PROJ is a dependency of GDAL: libgdal-dev depends on the development package of PROJ.
  find_library(GB_PROJ_LIBRARY proj REQUIRED)
  add_library(gb_proj INTERFACE)
  add_library(gb::proj ALIAS gb_proj)
  target_link_libraries(gb_proj INTERFACE ${GB_PROJ_LIBRARY})
endif()
