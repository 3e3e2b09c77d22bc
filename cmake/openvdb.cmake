# Decides whether `gigabake export --to vdb` works: sets GIGABAKE_HAS_OPENVDB and defines gb::openvdb. If OpenVDB is
# missing, the command reports it.
gb_choice(OPENVDB "gigabake export --to vdb, with OpenVDB")
if(GIGABAKE_OPENVDB STREQUAL "OFF")
  return()
endif()

# OpenVDB's FindOpenVDB is not used: it requires packages that only OpenVDB's tools need.
find_path(GB_OPENVDB_INCLUDE openvdb/openvdb.h)
find_library(GB_OPENVDB_LIBRARY openvdb)
find_package(TBB QUIET CONFIG)
find_package(Imath QUIET CONFIG)
if(GB_OPENVDB_INCLUDE AND GB_OPENVDB_LIBRARY AND TARGET TBB::tbb AND TARGET Imath::Imath)
  gb_links(GIGABAKE_OPENVDB_LINKS "
    #include <openvdb/openvdb.h>
    int main() { openvdb::initialize(); }"
    INCLUDES ${GB_OPENVDB_INCLUDE} LIBS ${GB_OPENVDB_LIBRARY} TBB::tbb Imath::Imath)
endif()
gb_chosen(OPENVDB "${GIGABAKE_OPENVDB_LINKS}" libopenvdb-dev
          INCLUDES ${GB_OPENVDB_INCLUDE} LIBS ${GB_OPENVDB_LIBRARY} TBB::tbb Imath::Imath)
if(NOT GIGABAKE_HAS_OPENVDB)
  message(NOTICE "gigabake: export --to vdb will be refused: libopenvdb-dev is not installed or does not link")
endif()
