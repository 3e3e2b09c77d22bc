# Decides whether CUDA files are compiled: sets GIGABAKE_HAS_CUDA. If it is true, each gb_library and gb_test compiles
# the *.cu files of its folder.
set(GIGABAKE_HAS_CUDA FALSE)
if(GIGABAKE_CUDA STREQUAL "OFF")
  return()
endif()

# nvcc is often installed in a folder that is not in the PATH.
find_program(GB_NVCC nvcc HINTS ENV CUDACXX PATHS /usr/local/cuda/bin)
if(GB_NVCC AND NOT CMAKE_CUDA_COMPILER AND NOT DEFINED ENV{CUDACXX})
  set(CMAKE_CUDA_COMPILER ${GB_NVCC})
endif()
# Machine code for Ampere and Hopper, and PTX that drivers of newer devices compile.
if(NOT CMAKE_CUDA_ARCHITECTURES)
  set(CMAKE_CUDA_ARCHITECTURES 80-real 90)
endif()

include(CheckLanguage)
check_language(CUDA)
if(CMAKE_CUDA_COMPILER)
  enable_language(CUDA)
  if(CMAKE_CUDA_COMPILER_VERSION VERSION_GREATER_EQUAL 12.0)
    set(GIGABAKE_HAS_CUDA TRUE)
    if(NOT CMAKE_CUDA20_STANDARD_COMPILE_OPTION)  # CMake before 3.26 does not know nvcc's C++20
      set(CMAKE_CUDA20_STANDARD_COMPILE_OPTION -std=c++20)
      set(CMAKE_CUDA20_EXTENSION_COMPILE_OPTION -std=c++20)
    endif()
    set(CMAKE_CUDA_STANDARD 20)
    message(STATUS "CUDA kernels: ${CMAKE_CUDA_COMPILER} ${CMAKE_CUDA_COMPILER_VERSION} for ${CMAKE_CUDA_ARCHITECTURES}")
  else()
    message(STATUS "CUDA kernels: off, nvcc ${CMAKE_CUDA_COMPILER_VERSION} has no C++20 (12.0 has)")
  endif()
endif()
if(NOT GIGABAKE_HAS_CUDA AND NOT GIGABAKE_CUDA STREQUAL "AUTO")
  message(FATAL_ERROR "GIGABAKE_CUDA=${GIGABAKE_CUDA}: no nvcc 12.0 or newer; put it on the PATH or name it in CUDACXX")
endif()
