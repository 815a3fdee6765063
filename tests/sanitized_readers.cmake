# Compiles the readers of mesh files and of POV-Ray's language a second time, with the address and undefined-behaviour
# sanitizers, and runs their tests and fuzz targets again. This takes 3 minutes on two cores; the whole library, which
# scripts/test --asan compiles, takes 15.
set(sanitizers -O1 -g1 -fno-omit-frame-pointer -fsanitize=address,undefined -fno-sanitize-recover=all)

file(GLOB sources CONFIGURE_DEPENDS
  ${PROJECT_SOURCE_DIR}/core/*.cpp ${PROJECT_SOURCE_DIR}/io/text/*.cpp ${PROJECT_SOURCE_DIR}/io/mesh/*.cpp
  ${PROJECT_SOURCE_DIR}/io/mesh/load/*.cpp ${PROJECT_SOURCE_DIR}/io/obj/*.cpp ${PROJECT_SOURCE_DIR}/io/ply/*.cpp
  ${PROJECT_SOURCE_DIR}/io/stl/*.cpp ${PROJECT_SOURCE_DIR}/io/off/*.cpp ${PROJECT_SOURCE_DIR}/io/threemf/*.cpp
  ${PROJECT_SOURCE_DIR}/io/gltf/*.cpp ${PROJECT_SOURCE_DIR}/io/pov/*.cpp)
list(FILTER sources EXCLUDE REGEX "/(write|glb)_[a-z_]*\\.cpp$")
# Code of instruction sets is not among them.
list(FILTER sources EXCLUDE REGEX "/core/isa_tables\\.cpp$")
add_library(sanitized_readers STATIC ${sources} ${PROJECT_SOURCE_DIR}/render/material.cpp ${PROJECT_SOURCE_DIR}/render/pattern_kinds.cpp
  ${PROJECT_SOURCE_DIR}/io/image/color.cpp
  ${PROJECT_SOURCE_DIR}/kernels/functions/expression.cpp
  support/temp_dir.cpp fuzz/no_images.cpp)
target_compile_features(sanitized_readers PUBLIC cxx_std_20)
target_compile_options(sanitized_readers PUBLIC ${sanitizers})
target_compile_definitions(sanitized_readers PUBLIC OKTETT_SOURCE_DIR="${PROJECT_SOURCE_DIR}" ${OKTETT_GLTF_DEFINITIONS})
target_include_directories(sanitized_readers SYSTEM PUBLIC ${OKTETT_GLTF_INCLUDES})
target_link_options(sanitized_readers PUBLIC ${sanitizers})
target_link_libraries(sanitized_readers PUBLIC oktett_internal fmt::fmt ZLIB::ZLIB ${OKTETT_GLTF_LIBRARIES} GTest::gtest rapidcheck)
oktett_unity(sanitized_readers)
# This file adds the implementation of tinygltf by a macro, which has no effect after another file has included tinygltf.
# The parser of expressions names its parts as readers do.
set_source_files_properties(${PROJECT_SOURCE_DIR}/io/gltf/tiny.cpp ${PROJECT_SOURCE_DIR}/kernels/functions/expression.cpp PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)

add_executable(test_readers)
foreach(name gltf gltf_error gltf_packed gzip mesh_polygon mtl obj obj_error obj_material obj_parallel ply ply_error
    pov_language similar_file stl text_number)
  target_sources(test_readers PRIVATE io/${name}_test.cpp)
endforeach()
target_sources(test_readers PRIVATE core/bytes_test.cpp core/pages_test.cpp core/soa_test.cpp core/virtual_array_test.cpp)
target_link_libraries(test_readers PRIVATE sanitized_readers GTest::gtest_main)
oktett_unity(test_readers)
set_target_properties(test_readers PROPERTIES UNITY_BUILD_BATCH_SIZE 5)  # sanitized code takes long
add_dependencies(oktett_tests test_readers)
# A sanitizer takes a quarter of a second to start, so several tests share a process.
set(shards 8)
math(EXPR last_shard "${shards} - 1")
foreach(shard RANGE ${last_shard})
  add_test(NAME sanitized.readers.${shard} COMMAND test_readers)
  set_tests_properties(sanitized.readers.${shard} PROPERTIES TIMEOUT 600
    ENVIRONMENT "GTEST_TOTAL_SHARDS=${shards};GTEST_SHARD_INDEX=${shard}")
endforeach()

add_library(sanitized_replay OBJECT fuzz/replay.cpp)
target_link_libraries(sanitized_replay PRIVATE sanitized_readers)
foreach(name gltf gzip mtl number obj off ply pov stl)
  add_executable(sanitized_${name}_fuzz fuzz/${name}_fuzz.cpp)
  target_link_libraries(sanitized_${name}_fuzz PRIVATE sanitized_readers sanitized_replay)
  add_dependencies(oktett_tests sanitized_${name}_fuzz)
  add_test(NAME sanitized.fuzz.${name} COMMAND sanitized_${name}_fuzz --changes 8000 ${CMAKE_CURRENT_SOURCE_DIR}/fuzz/seeds/${name})
endforeach()
