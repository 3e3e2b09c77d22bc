# One static library per room; the include root is the source root, so that #include "format/shard/shard.h" says the room.

include(GNUInstallDirs)
# Where modules are installed, and where programs look for them: beside themselves in a build.
set(GIGABAKE_MODULE_FOLDER ${CMAKE_INSTALL_LIBDIR}/gigabake)
set(CMAKE_BUILD_RPATH ${CMAKE_BINARY_DIR})

# Contraction and fast-math would let CPU and GPU differ in the last bit.
set(gb_cxx_options -Wall -Wextra -Wshadow -ffp-contract=off)
# AVX2 where the machine that builds has it: a quarter of the time, the same bits (nothing is contracted).
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
# Compiled together, a source file looks like a header whose types differ from file to file.
if(CMAKE_UNITY_BUILD AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  list(APPEND gb_cxx_options -Wno-subobject-linkage)
endif()
# GCC 13 at -O3 warns of accesses beyond the end of std::string and std::vector where there are none; GCC 12 checks these.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_GREATER_EQUAL 13)
  list(APPEND gb_cxx_options -Wno-array-bounds -Wno-stringop-overflow -Wno-stringop-overread)
endif()
# GCC 13 takes the name of a member, a temporary, for what the reference refers to; 14 no longer warns of it unasked.
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

# gb_library(name [RECURSE] [WITHOUT files…] LIBRARIES libraries… [HEADERS libraries…]): every *.cpp of this folder (and
# *.cu where nvcc is found), with RECURSE those of its subfolders too, is the static library gigabake_<name>. HEADERS are
# libraries without a binary that only the *.cpp include: who links gigabake_<name> once it is installed needs none of them.
function(gb_library name)
  cmake_parse_arguments(ARG "RECURSE" "" "WITHOUT;LIBRARIES;HEADERS" ${ARGN})
  if(ARG_RECURSE)
    set(glob GLOB_RECURSE)
  else()
    set(glob GLOB)
  endif()
  file(${glob} sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp)
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
endfunction()

# gb_module(name sources… LIBRARIES libraries…): a part that is loaded when it is needed (format/system/module.h).
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

# gb_test(folder label libraries…): every *.cpp below tests/<folder> (and *.cu where nvcc is found) is one GoogleTest executable, gigabake_test_<folder>.
function(gb_test folder label)
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/tests/${folder}/*.cpp)
  # Of tests/fuzz the readers are libraries.
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
  # Together they compile a third faster; a local name may be that of another file's constant then.
  set_target_properties(gigabake_test_${folder} PROPERTIES UNITY_BUILD_BATCH_SIZE 6)
  if(CMAKE_UNITY_BUILD)
    target_compile_options(gigabake_test_${folder} PRIVATE "$<$<COMPILE_LANGUAGE:CXX>:-Wno-shadow;-Wshadow=local>")
  endif()
  # What is tested is optimized; the tests themselves compile a third faster without.
  target_compile_options(gigabake_test_${folder} PRIVATE "$<$<AND:$<COMPILE_LANGUAGE:CXX>,$<CONFIG:Release>>:-O1>")
  # GoogleTest is half of what a test compiles: all programs of tests share it, read once.
  if(folder STREQUAL lattice)
    target_precompile_headers(gigabake_test_lattice PRIVATE
      "$<$<COMPILE_LANGUAGE:CXX>:${CMAKE_SOURCE_DIR}/tests/common_headers.h>")
  else()
    target_precompile_headers(gigabake_test_${folder} REUSE_FROM gigabake_test_lattice)
  endif()
  gtest_discover_tests(gigabake_test_${folder} TEST_PREFIX ${folder}. PROPERTIES LABELS ${label} TIMEOUT 600
                       DISCOVERY_TIMEOUT 60 DISCOVERY_MODE PRE_TEST)
endfunction()

# gb_script_test(name label script arguments…): a Python test; exit code 77 means skipped, and the script says why.
# The system's Python, because that is where the distribution's h5py and numpy live.
function(gb_script_test name label script)
  add_test(NAME ${name} COMMAND /usr/bin/python3 ${script} ${ARGN})
  set_tests_properties(${name} PROPERTIES LABELS ${label} SKIP_RETURN_CODE 77 TIMEOUT 1200)
endfunction()
