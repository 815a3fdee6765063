# What `oktett render --show` prints pictures with: chafa and GLib beneath it, in a shared library that only this option loads.
# Without them the option says that this build shows none.
find_package(PkgConfig QUIET)
if(PKG_CONFIG_FOUND)
  pkg_check_modules(CHAFA QUIET IMPORTED_TARGET chafa>=1.12)
endif()
if(TARGET PkgConfig::CHAFA)
  add_library(oktett_terminal SHARED ${PROJECT_SOURCE_DIR}/app/terminal/chafa/encoder.cpp)
  target_link_libraries(oktett_terminal PRIVATE PkgConfig::CHAFA)
  oktett_loaded_library(oktett_terminal own_library.cpp OKTETT_TERMINAL_LIBRARY)
endif()
