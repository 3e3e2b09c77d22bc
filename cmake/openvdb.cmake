# Decides whether `gigabake export --to vdb` is there: sets GIGABAKE_HAS_OPENVDB and makes gb::openvdb. Without, the
# command says so.
set(GIGABAKE_OPENVDB AUTO CACHE STRING "gigabake export --to vdb: AUTO (where OpenVDB is found), ON (fail without), OFF")
set_property(CACHE GIGABAKE_OPENVDB PROPERTY STRINGS AUTO ON OFF)
set(GIGABAKE_HAS_OPENVDB FALSE)
if(GIGABAKE_OPENVDB STREQUAL "OFF")
  return()
endif()

# Its own FindOpenVDB asks for packages that only its tools need.
find_path(GB_OPENVDB_INCLUDE openvdb/openvdb.h)
find_library(GB_OPENVDB_LIBRARY openvdb)
find_package(TBB QUIET CONFIG)
if(GB_OPENVDB_INCLUDE AND GB_OPENVDB_LIBRARY AND TARGET TBB::tbb)
  include(CheckCXXSourceCompiles)
  set(CMAKE_REQUIRED_INCLUDES ${GB_OPENVDB_INCLUDE})
  set(CMAKE_REQUIRED_LIBRARIES ${GB_OPENVDB_LIBRARY} TBB::tbb Imath::Imath)
  check_cxx_source_compiles("
    #include <openvdb/openvdb.h>
    int main() { openvdb::initialize(); }" GIGABAKE_OPENVDB_LINKS)
  unset(CMAKE_REQUIRED_INCLUDES)
  unset(CMAKE_REQUIRED_LIBRARIES)
endif()
if(GIGABAKE_OPENVDB_LINKS)
  set(GIGABAKE_HAS_OPENVDB TRUE)
  add_library(gb_openvdb INTERFACE)
  add_library(gb::openvdb ALIAS gb_openvdb)
  target_include_directories(gb_openvdb SYSTEM INTERFACE ${GB_OPENVDB_INCLUDE})
  target_link_libraries(gb_openvdb INTERFACE ${GB_OPENVDB_LIBRARY} TBB::tbb Imath::Imath)
elseif(NOT GIGABAKE_OPENVDB STREQUAL "AUTO")
  message(FATAL_ERROR "GIGABAKE_OPENVDB=${GIGABAKE_OPENVDB}: expected libopenvdb-dev to be installed")
endif()
