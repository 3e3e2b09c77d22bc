# Target docs: API pages of the installed headers, in the folder api of the build, if Doxygen is found at configure
# time. Each warning of Doxygen fails the target.
find_package(Doxygen QUIET)
if(NOT DOXYGEN_FOUND)
  return()
endif()

# A function scope keeps Doxygen's many variables out of other files.
function(gb_api_pages)
  set(DOXYGEN_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/api)
  set(DOXYGEN_QUIET YES)
  set(DOXYGEN_WARN_AS_ERROR FAIL_ON_WARNINGS)
  set(DOXYGEN_WARN_IF_UNDOCUMENTED NO)
  set(DOXYGEN_PROJECT_BRIEF "Textured terrain as paged sparse voxel octrees")
  set(DOXYGEN_USE_MDFILE_AS_MAINPAGE docs/library.md)
  set(DOXYGEN_STRIP_FROM_PATH ${CMAKE_SOURCE_DIR})
  set(DOXYGEN_STRIP_FROM_INC_PATH ${CMAKE_SOURCE_DIR})
  set(DOXYGEN_EXTENSION_MAPPING cuh=C++)
  # The first sentence of a comment is its summary.
  set(DOXYGEN_JAVADOC_AUTOBRIEF YES)
  set(DOXYGEN_EXTRACT_ALL YES)
  set(DOXYGEN_SORT_MEMBER_DOCS NO)
  # The same pages on each machine, with and without Graphviz.
  set(DOXYGEN_HAVE_DOT NO)
  set(DOXYGEN_MACRO_EXPANSION YES)
  set(DOXYGEN_EXPAND_ONLY_PREDEF YES)
  set(DOXYGEN_PREDEFINED GB_HD= GB_HD_NOINLINE=)
  set(DOXYGEN_INPUT_FILTER "sed -E -f cmake/doxygen/header.sed")
  set(DOXYGEN_FILTER_PATTERNS "*.md=sed -E -f cmake/doxygen/page.sed")
  set(DOXYGEN_ALIASES "header=@file^^")
  foreach(tag Space Exact Range Cost Errors Source)
    list(APPEND DOXYGEN_ALIASES "${tag}=@par ${tag}^^")
  endforeach()

  set(headers "")
  foreach(room IN LISTS gb_installed_rooms)
    list(APPEND headers ${gb_public_headers_${room}})
  endforeach()
  doxygen_add_docs(docs docs/library.md docs/architecture.md docs/glossary.md ${headers}
                   WORKING_DIRECTORY ${CMAKE_SOURCE_DIR} COMMENT "API pages")
endfunction()
gb_api_pages()
