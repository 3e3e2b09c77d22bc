# Libraries of gigabake-bench (GIGABAKE_BENCH).
# GMP is the exact reference of `bench accuracy --hard` and of the tests.
find_path(GB_GMP_INCLUDE gmpxx.h)
find_library(GB_GMP_C_LIBRARY gmp)
if(GIGABAKE_TESTS OR (GB_GMP_INCLUDE AND GB_GMP_C_LIBRARY))
  gb_find(gmp gmpxx.h LIBS gmpxx)
  find_library(GB_GMP_C_LIBRARY gmp REQUIRED)
  target_link_libraries(gb_gmp INTERFACE ${GB_GMP_C_LIBRARY})
endif()

# Decides whether `gigabake bench accuracy` has a reference: sets GIGABAKE_EMBREE to Embree's version and defines
# gb::embree. If Embree is missing, GIGABAKE_EMBREE is 0 and the command reports it.
set(GIGABAKE_EMBREE 0)
foreach(version 4 3)
  find_path(GB_EMBREE${version}_INCLUDE embree${version}/rtcore.h)
  find_library(GB_EMBREE${version}_LIBRARY embree${version})
  if(GB_EMBREE${version}_INCLUDE AND GB_EMBREE${version}_LIBRARY)
    set(GIGABAKE_EMBREE ${version})
    add_library(gb_embree INTERFACE)
    add_library(gb::embree ALIAS gb_embree)
    target_include_directories(gb_embree SYSTEM INTERFACE ${GB_EMBREE${version}_INCLUDE})
    target_link_libraries(gb_embree INTERFACE ${GB_EMBREE${version}_LIBRARY})
    message(STATUS "Reference for bench accuracy: Embree ${version}")
    return()
  endif()
endforeach()
message(NOTICE "gigabake: bench accuracy will have no reference: libembree-dev is not installed")
