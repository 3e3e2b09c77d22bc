# Decides whether `gigabake view` works: sets GIGABAKE_HAS_WINDOW and defines gb::window. If a library is missing, the
# command reports it.
gb_choice(WINDOW "gigabake view, with GLFW, Dear ImGui and OpenGL")
if(GIGABAKE_WINDOW STREQUAL "OFF")
  return()
endif()

find_package(glfw3 3.3 QUIET)
# Debian's library contains the backends for GLFW and OpenGL 2.
find_path(GB_IMGUI_INCLUDE backends/imgui_impl_opengl2.h PATH_SUFFIXES imgui)
find_library(GB_IMGUI_LIBRARY imgui)
find_library(GB_STB_LIBRARY stb)  # its fonts
find_library(GB_GL_LIBRARY GL)
if(glfw3_FOUND AND GB_IMGUI_INCLUDE AND GB_IMGUI_LIBRARY AND GB_STB_LIBRARY AND GB_GL_LIBRARY)
  gb_links(GIGABAKE_IMGUI_LINKS "
    #include <backends/imgui_impl_glfw.h>
    #include <backends/imgui_impl_opengl2.h>
    int main() { return ImGui_ImplGlfw_InitForOpenGL(nullptr, true) && ImGui_ImplOpenGL2_Init() ? 0 : 1; }"
    INCLUDES ${GB_IMGUI_INCLUDE} LIBS ${GB_IMGUI_LIBRARY} ${GB_STB_LIBRARY} glfw ${GB_GL_LIBRARY})
endif()
gb_chosen(WINDOW "${GIGABAKE_IMGUI_LINKS}" "libglfw3-dev, libimgui-dev and libgl-dev"
          INCLUDES ${GB_IMGUI_INCLUDE} LIBS ${GB_IMGUI_LIBRARY} ${GB_STB_LIBRARY} glfw ${GB_GL_LIBRARY})
if(NOT GIGABAKE_HAS_WINDOW)
  message(NOTICE "gigabake: `view` will be refused: libglfw3-dev, libimgui-dev or libgl-dev is not installed or does not link")
endif()
