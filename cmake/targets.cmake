# One static library per folder; the include root is the source root, so that #include "format/shard.h" says the folder.
function(gb_options target)
  target_compile_features(${target} PUBLIC cxx_std_20)
  # Contraction and fast-math would let CPU and GPU differ in the last bit.
  target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:-Wall -Wextra -Wshadow -ffp-contract=off>)
  if(GIGABAKE_WARNINGS_AS_ERRORS)
    target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:-Werror>)
  endif()
  if(GIGABAKE_SANITIZE)
    target_compile_options(${target} PUBLIC $<$<COMPILE_LANGUAGE:CXX>:-fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer>)
    target_link_options(${target} PUBLIC -fsanitize=address,undefined)
  endif()
endfunction()

function(gb_library name)
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp)
  add_library(gigabake_${name} STATIC ${sources})
  target_include_directories(gigabake_${name} PUBLIC ${CMAKE_SOURCE_DIR})
  target_link_libraries(gigabake_${name} PUBLIC ${ARGN})
  gb_options(gigabake_${name})
endfunction()

# Every tests/<folder>/*.cpp is one GoogleTest executable gigabake_test_<folder>.
function(gb_test folder)
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/tests/${folder}/*.cpp)
  if(NOT sources)
    return()
  endif()
  add_executable(gigabake_test_${folder} ${sources})
  target_link_libraries(gigabake_test_${folder} PRIVATE ${ARGN} GTest::gtest GTest::gmock GTest::gtest_main)
  gb_options(gigabake_test_${folder})
  gtest_discover_tests(gigabake_test_${folder} TEST_PREFIX ${folder}. PROPERTIES LABELS ${folder} TIMEOUT 600 DISCOVERY_TIMEOUT 60
                       DISCOVERY_MODE PRE_TEST)
endfunction()
