# What reads fonts, see io/font/font.h: a shared library that is loaded with the first `text` of a scene.
option(OKTETT_FONTS "Read the letters of fonts, if FreeType is found" ON)
if(OKTETT_FONTS)
  find_package(Freetype QUIET)
  if(TARGET Freetype::Freetype)
    oktett_io_library(oktett_fonts io/font/font.cpp OKTETT_FONT_LIBRARY
      io/font/freetype/read_font.cpp core/error.cpp core/math.cpp core/pages.cpp core/transform.cpp)
    target_link_libraries(oktett_fonts PRIVATE Freetype::Freetype)
  endif()
endif()
