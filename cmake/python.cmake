# Finds what the Python package is built with: pybind11 and a Python that has numpy. OKTETT_PYTHON_DIR is the folder below
# the prefix that the package is installed to.
set(OKTETT_PYTHON_FOUND OFF)
if(NOT Python3_EXECUTABLE)
  # The first Python on the path may be one without numpy, such as that of a version manager.
  find_program(OKTETT_PATH_PYTHON NAMES python3)
  mark_as_advanced(OKTETT_PATH_PYTHON)
  foreach(candidate IN ITEMS ${OKTETT_PATH_PYTHON} /usr/bin/python3)
    execute_process(COMMAND ${candidate} -c "import numpy" RESULT_VARIABLE failed OUTPUT_QUIET ERROR_QUIET)
    if(NOT failed AND NOT Python3_EXECUTABLE)
      set(Python3_EXECUTABLE ${candidate})
    endif()
  endforeach()
endif()
if(Python3_EXECUTABLE)
  set(Python3_FIND_STRATEGY LOCATION)
  find_package(Python3 QUIET COMPONENTS Interpreter Development.Module)
endif()
if(Python3_FOUND)
  # pybind11 uses what was found here.
  set(PYBIND11_FINDPYTHON ON)
  set(Python_EXECUTABLE ${Python3_EXECUTABLE})
  if(CMAKE_CROSSCOMPILING AND NOT DEFINED PYTHON_MODULE_EXTENSION)
    # The interpreter that runs tells its own ending.
    set(PYTHON_MODULE_EXTENSION
      .cpython-${Python3_VERSION_MAJOR}${Python3_VERSION_MINOR}-${CMAKE_SYSTEM_PROCESSOR}-linux-gnu.so)
  endif()
  find_package(pybind11 2.10 CONFIG QUIET)
  set(OKTETT_PYTHON_FOUND ${pybind11_FOUND})
endif()
# The thread sanitizer cannot be loaded into an interpreter that was built without it.
if(CMAKE_CXX_FLAGS MATCHES "-fsanitize=(thread|fuzzer)")
  set(OKTETT_PYTHON_FOUND OFF)
endif()
option(OKTETT_BUILD_PYTHON "Build the Python package (pybind11)" ${OKTETT_PYTHON_FOUND})
if(OKTETT_BUILD_PYTHON AND NOT OKTETT_PYTHON_FOUND)
  message(FATAL_ERROR "The Python package needs pybind11 2.10 (pybind11-dev) and a Python with numpy (python3-dev, "
    "python3-numpy). OKTETT_BUILD_PYTHON=OFF does without.")
endif()
# Debian's Python looks for packages of the distribution in dist-packages, whatever its version.
if(OKTETT_BUILD_PYTHON AND NOT DEFINED CACHE{OKTETT_PYTHON_DIR})
  set(folder lib/python${Python3_VERSION_MAJOR}.${Python3_VERSION_MINOR}/site-packages)
  if(Python3_EXECUTABLE STREQUAL "/usr/bin/python3" AND IS_DIRECTORY /usr/lib/python3/dist-packages)
    set(folder lib/python3/dist-packages)
  endif()
  set(OKTETT_PYTHON_DIR ${folder} CACHE STRING "Folder below the prefix for the Python package")
endif()
