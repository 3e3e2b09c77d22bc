# Formats inside sources that need a library of their own. Each is read where its library is found; elsewhere content
# that needs it is refused by a line that names the package.
#
# gb_codec(NAME header library package): the option GIGABAKE_<NAME>, AUTO, ON (fail without) or OFF; sets
# GIGABAKE_HAS_<NAME> and makes gb::<name>. Extra folders of headers and libraries after SUFFIXES.
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
  # libdraco brings a tinygltf of its own, of another version: whatever is linked finds the real one first.
  target_link_libraries(gb_tinygltf INTERFACE gb::draco)
endif()
gb_codec(MESHOPT meshoptimizer.h meshoptimizer libmeshoptimizer-dev)
gb_codec(WEBP webp/decode.h webp libwebp-dev)
gb_codec(GDAL gdal_priv.h gdal libgdal-dev SUFFIXES gdal)
if(GIGABAKE_HAS_GDAL)
  # What GDAL itself stands on: its development package brings this one's.
  find_library(GB_PROJ_LIBRARY proj REQUIRED)
  add_library(gb_proj INTERFACE)
  add_library(gb::proj ALIAS gb_proj)
  target_link_libraries(gb_proj INTERFACE ${GB_PROJ_LIBRARY})
endif()
