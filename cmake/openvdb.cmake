# Decides whether `gigabake export --to vdb` is there: sets GIGABAKE_HAS_OPENVDB and makes gb::openvdb. Without, the
# command says so.
gb_choice(OPENVDB "gigabake export --to vdb, with OpenVDB")
if(GIGABAKE_OPENVDB STREQUAL "OFF")
  return()
endif()

# Its own FindOpenVDB asks for packages that only its tools need.
find_path(GB_OPENVDB_INCLUDE openvdb/openvdb.h)
find_library(GB_OPENVDB_LIBRARY openvdb)
find_package(TBB QUIET CONFIG)
if(GB_OPENVDB_INCLUDE AND GB_OPENVDB_LIBRARY AND TARGET TBB::tbb)
  gb_links(GIGABAKE_OPENVDB_LINKS "
    #include <openvdb/openvdb.h>
    int main() { openvdb::initialize(); }"
    INCLUDES ${GB_OPENVDB_INCLUDE} LIBS ${GB_OPENVDB_LIBRARY} TBB::tbb Imath::Imath)
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
