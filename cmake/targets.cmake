# One static library per module. The include root is the source root: #include "format/shard/shard.h" names the module.

include(GNUInstallDirs)
# Folder of loadable modules once installed. In a build, programs find them in the build folder.
set(GIGABAKE_MODULE_FOLDER ${CMAKE_INSTALL_LIBDIR}/gigabake)
set(CMAKE_BUILD_RPATH ${CMAKE_BINARY_DIR})
# Folder of programs that only gigabake starts, once installed.
set(GIGABAKE_PROGRAM_FOLDER ${CMAKE_INSTALL_LIBEXECDIR}/gigabake)

# No contraction and no fast-math: with either, CPU and GPU could differ in the last bit.
set(gb_cxx_options -Wall -Wextra -Wshadow -ffp-contract=off)
# Uses AVX2 if the building machine has it: bakes take a quarter of the time, with the same bits (no contraction).
if(NOT DEFINED GIGABAKE_MARCH)
  set(march "")
  if(CMAKE_SYSTEM_PROCESSOR STREQUAL "x86_64" AND EXISTS /proc/cpuinfo)
    file(STRINGS /proc/cpuinfo flags REGEX "^flags.* avx2 .*bmi2 " LIMIT_COUNT 1)
    if(flags)
      set(march x86-64-v3)
    endif()
  endif()
  set(GIGABAKE_MARCH "${march}" CACHE STRING "-march of all C++ code; empty: the compiler's default, for older processors")
endif()
if(GIGABAKE_MARCH)
  list(APPEND gb_cxx_options -march=${GIGABAKE_MARCH})
endif()
set(gb_cuda_options -fmad=false --expt-relaxed-constexpr -lineinfo -Xcompiler=-Wall,-ffp-contract=off)
# GCC 12 warns of overlapping copies inside std::string where there are none (GCC bug 105651).
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  list(APPEND gb_cxx_options -Wno-restrict)
endif()
# In a unity build, GCC takes a source file for a header with types in an anonymous namespace. A local name may also shadow
# a constant of another file.
if(CMAKE_UNITY_BUILD AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  list(APPEND gb_cxx_options -Wno-subobject-linkage -Wno-shadow -Wshadow=local)
endif()
# GCC 13 at -O3 warns of accesses beyond the end of std::string and std::vector where there are none; GCC 12 checks these.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_GREATER_EQUAL 13)
  list(APPEND gb_cxx_options -Wno-array-bounds -Wno-stringop-overflow -Wno-stringop-overread)
endif()
# GCC 13 warns of references to a temporary argument that the reference does not refer to; GCC 14 does not by default.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_GREATER_EQUAL 13)
  list(APPEND gb_cxx_options -Wno-dangling-reference)
endif()
if(GIGABAKE_WARNINGS_AS_ERRORS)
  list(APPEND gb_cxx_options -Werror)
  list(APPEND gb_cuda_options -Werror=all-warnings)
endif()

set(gb_sanitizers -fsanitize=address,undefined)
if(GIGABAKE_SANITIZE STREQUAL "thread")
  set(gb_sanitizers -fsanitize=thread)
endif()

function(gb_options target)
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_compile_options(${target} PRIVATE "$<$<COMPILE_LANGUAGE:CXX>:${gb_cxx_options}>"
                                           "$<$<COMPILE_LANGUAGE:CUDA>:${gb_cuda_options}>")
  if(GIGABAKE_SANITIZE)
    target_compile_options(${target} PUBLIC "$<$<COMPILE_LANGUAGE:CXX>:${gb_sanitizers};-fno-sanitize-recover=all;-fno-omit-frame-pointer>")
    target_link_options(${target} PUBLIC ${gb_sanitizers})
  endif()
  if(GIGABAKE_FUZZERS)
    target_compile_options(${target} PUBLIC -fsanitize=fuzzer-no-link)
  endif()
endfunction()

# gb_unity_by_folder(target): compiles the files of one folder as one file in a unity build. Headers are half of what a
# file compiles, so larger groups save time. A file with a UNITY_GROUP keeps it.
function(gb_unity_by_folder target)
  if(NOT CMAKE_UNITY_BUILD)
    return()
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD_MODE GROUP)
  get_target_property(sources ${target} SOURCES)
  foreach(source ${sources})
    get_source_file_property(group ${source} UNITY_GROUP)
    if(source MATCHES "\\.cpp$" AND NOT group)
      get_filename_component(folder ${source} DIRECTORY)
      string(MAKE_C_IDENTIFIER "folder_${folder}" group)
      set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${group})
    endif()
  endforeach()
endfunction()

# gb_library(name [RECURSE] [FOLDERS subfolders…] [WITHOUT files…] LIBRARIES libraries… [HEADERS libraries…]): compiles the
# *.cpp of this folder into the static library gigabake_<name>, and the *.cu if nvcc is found. RECURSE includes all
# subfolders, FOLDERS some. HEADERS are header-only libraries that only *.cpp files include: programs that link the
# installed library do not need them.
function(gb_library name)
  cmake_parse_arguments(ARG "RECURSE" "" "FOLDERS;WITHOUT;LIBRARIES;HEADERS" ${ARGN})
  if(ARG_RECURSE)
    set(glob GLOB_RECURSE)
  else()
    set(glob GLOB)
  endif()
  file(${glob} sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp)
  foreach(folder ${ARG_FOLDERS})
    file(GLOB more CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${folder}/*.cpp)
    list(APPEND sources ${more})
  endforeach()
  list(TRANSFORM ARG_WITHOUT PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/)
  list(REMOVE_ITEM sources ${ARG_WITHOUT})
  if(GIGABAKE_HAS_CUDA)
    file(${glob} cuda_sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cu)
    set_source_files_properties(${cuda_sources} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  endif()
  if(NOT sources)
    return()
  endif()
  add_library(gigabake_${name} STATIC ${sources} ${cuda_sources})
  target_include_directories(gigabake_${name} PUBLIC $<BUILD_INTERFACE:${CMAKE_SOURCE_DIR}>
                                                     $<INSTALL_INTERFACE:include/gigabake>)
  list(TRANSFORM ARG_HEADERS REPLACE "(.+)" "$<BUILD_INTERFACE:\\1>")
  target_link_libraries(gigabake_${name} PUBLIC ${ARG_LIBRARIES} PRIVATE ${ARG_HEADERS})
  gb_options(gigabake_${name})
  # Deferred: a folder adds further files after this call. EVAL, since a deferred call expands its arguments late.
  cmake_language(EVAL CODE "cmake_language(DEFER CALL gb_unity_by_folder gigabake_${name})")
endfunction()

# gb_module(name sources… LIBRARIES libraries…): a shared object that is loaded on demand (format/system/module.h).
function(gb_module name)
  cmake_parse_arguments(ARG "" "" "LIBRARIES" ${ARGN})
  set(module gigabake_${name}_module)
  add_library(${module} MODULE ${ARG_UNPARSED_ARGUMENTS})
  target_include_directories(${module} PRIVATE ${CMAKE_SOURCE_DIR})
  target_link_libraries(${module} PRIVATE ${ARG_LIBRARIES})
  gb_options(${module})
  set_target_properties(${module} PROPERTIES PREFIX "" OUTPUT_NAME gigabake-${name}-${PROJECT_VERSION}
                                             LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR})
  install(TARGETS ${module} DESTINATION ${GIGABAKE_MODULE_FOLDER} COMPONENT runtime)
endfunction()

# gb_module_path(program folder): makes the program, once installed in the folder, find the modules.
function(gb_module_path program folder)
  file(RELATIVE_PATH modules /prefix/${folder} /prefix/${GIGABAKE_MODULE_FOLDER})
  set_target_properties(${program} PROPERTIES INSTALL_RPATH "$ORIGIN/${modules}")
endfunction()

# gb_test(folder label libraries…): compiles the *.cpp below tests/<folder> into the GoogleTest program
# gigabake_test_<folder>, and the *.cu if nvcc is found.
function(gb_test folder label)
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/tests/${folder}/*.cpp)
  # The readers of tests/fuzz are libraries.
  list(FILTER sources EXCLUDE REGEX "/fuzz/(libfuzzer/|judge|read_)")
  if(GIGABAKE_HAS_CUDA)
    file(GLOB_RECURSE cuda_sources CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/tests/${folder}/*.cu)
    set_source_files_properties(${cuda_sources} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
    list(APPEND sources ${cuda_sources})
  endif()
  if(NOT sources)
    return()
  endif()
  add_executable(gigabake_test_${folder} ${sources})
  target_link_libraries(gigabake_test_${folder} PRIVATE ${ARGN} gb::json gb::xxhash GTest::gtest GTest::gmock GTest::gtest_main)
  target_compile_definitions(gigabake_test_${folder} PRIVATE GIGABAKE_SOURCE_DIR="${CMAKE_SOURCE_DIR}")
  gb_options(gigabake_test_${folder})
  # The libraries are optimized. The tests are compiled with -O1, which is a third faster.
  target_compile_options(gigabake_test_${folder} PRIVATE "$<$<AND:$<COMPILE_LANGUAGE:CXX>,$<CONFIG:Release>>:-O1>")
  # GoogleTest takes half of a test's compile time: all test programs share one precompiled header.
  if(folder STREQUAL core)
    target_precompile_headers(gigabake_test_core PRIVATE
      "$<$<COMPILE_LANGUAGE:CXX>:${CMAKE_SOURCE_DIR}/tests/common_headers.h>")
  else()
    target_precompile_headers(gigabake_test_${folder} REUSE_FROM gigabake_test_core)
  endif()
  cmake_language(EVAL CODE "cmake_language(DEFER CALL gb_unity_by_folder gigabake_test_${folder})")
  gtest_discover_tests(gigabake_test_${folder} TEST_PREFIX ${folder}. PROPERTIES LABELS ${label} TIMEOUT 600
                       DISCOVERY_TIMEOUT 60 DISCOVERY_MODE PRE_TEST)
endfunction()

# gb_script_test(name label script arguments…): a Python test; exit code 77 means skipped, and the script prints the
# reason. It runs with the system's Python, which has the distribution's h5py and numpy.
function(gb_script_test name label script)
  add_test(NAME ${name} COMMAND /usr/bin/python3 ${script} ${ARGN})
  set_tests_properties(${name} PROPERTIES LABELS ${label} SKIP_RETURN_CODE 77 TIMEOUT 1200)
endfunction()
