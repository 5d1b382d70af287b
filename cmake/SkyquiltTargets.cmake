# Functions that define one library per folder, skyquilt_library(core_geo SOURCES a.cpp PUBLIC deps PRIVATE deps),
# and one test program per folder, skyquilt_test(core_geo SOURCES a_test.cpp LIBRARIES core_geo).

add_library(skyquilt_warnings INTERFACE)
target_compile_options(skyquilt_warnings INTERFACE -Wall -Wextra -Wshadow -Wconversion -Wdouble-promotion -Wnon-virtual-dtor -Wold-style-cast
  # g++ 12 warns wrongly about overlaps in "literal" + std::string (GCC bug 105329).
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>
  # Part of clang's -Wconversion, not of g++'s.
  $<$<CXX_COMPILER_ID:Clang>:-Wno-sign-conversion>)
if(SKYQUILT_UNITY)
  # In a unity build a file with an anonymous namespace is included like a header, which gcc warns about.
  target_compile_options(skyquilt_warnings INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
endif()
if(SKYQUILT_WERROR)
  target_compile_options(skyquilt_warnings INTERFACE -Werror)
endif()
if(SKYQUILT_SANITIZE)
  target_compile_options(skyquilt_warnings INTERFACE -fsanitize=${SKYQUILT_SANITIZE} -fno-omit-frame-pointer)
  target_link_options(skyquilt_warnings INTERFACE -fsanitize=${SKYQUILT_SANITIZE})
endif()

# Headers that most files read, parsed once instead of in every batch: one set for the program, a larger one for tests, and that once more for
# optimised tests. All targets share these, so they are compiled with the same macros. Each header here costs every batch time, too, which pays for
# those that most of them use.
if(SKYQUILT_PCH)
  set(header_macros $<TARGET_PROPERTY:fmt::fmt,INTERFACE_COMPILE_DEFINITIONS>)
  set(program_headers <algorithm> <array> <cmath> <cstdint> <filesystem> <functional> <limits> <map> <memory> <numbers> <optional> <set> <span> <stdexcept>
    <string> <string_view> <unordered_map> <utility> <vector> <Eigen/Core> <Eigen/Geometry> <fmt/core.h>)
endif()

# Tests run once, on small scenes, with libraries that are optimised: without optimisation they take half the time to compile.
set(test_level -O0)

# Settings of all our targets: skyquilt_target(name), skyquilt_target(name -O0) for another optimisation of release builds than -O2.
function(skyquilt_target name)
  set(level -O2)
  if(ARGC GREATER 1)
    set(level ${ARGV1})
  endif()
  target_compile_features(${name} PUBLIC cxx_std_20)
  set_target_properties(${name} PROPERTIES CXX_EXTENSIONS OFF)
  # After CMake's -O3 of release builds, so that this one takes effect.
  target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:${level}>
    # g++ in ISO mode rounds between a multiplication and an addition; clang must be told, so that results do not depend on what a processor can fuse.
    $<$<CXX_COMPILER_ID:Clang>:-ffp-contract=off>
    # Else every new parse of the headers looks like a change to ccache.
    $<$<CXX_COMPILER_ID:Clang>:SHELL:-Xclang -fno-pch-timestamp>)
  target_include_directories(${name} PUBLIC ${PROJECT_SOURCE_DIR})
  target_link_libraries(${name} PRIVATE skyquilt_warnings)
endfunction()

# Lets a target use the parsed headers of `kind`: program, tests or optimised_tests; the first one of a kind parses them.
function(skyquilt_use_parsed_headers name kind)
  if(NOT SKYQUILT_PCH)
    return()
  endif()
  set(owner skyquilt_${kind}_headers)
  if(NOT TARGET ${owner})
    file(GENERATE OUTPUT ${PROJECT_BINARY_DIR}/${owner}.cpp CONTENT "")
    add_library(${owner} OBJECT ${PROJECT_BINARY_DIR}/${owner}.cpp)
    # Parsed headers serve only files with the same optimisation.
    set(level)
    if(kind STREQUAL tests)
      set(level ${test_level})
    endif()
    skyquilt_target(${owner} ${level})
    target_compile_definitions(${owner} PRIVATE ${header_macros})
    target_link_libraries(${owner} PRIVATE Eigen3::Eigen fmt::fmt Threads::Threads)
    target_precompile_headers(${owner} PRIVATE ${program_headers})
    if(NOT kind STREQUAL program)
      target_link_libraries(${owner} PRIVATE GTest::gtest rapidcheck rapidcheck_gtest)
      target_precompile_headers(${owner} PRIVATE <gtest/gtest.h> <rapidcheck/gtest.h>)
    endif()
  endif()
  target_compile_definitions(${name} PRIVATE ${header_macros})
  target_precompile_headers(${name} REUSE_FROM ${owner})
endfunction()

# The sources with those that use JSON last: its templates cost a batch three seconds, so files that need them share their batches.
function(skyquilt_json_last out)
  set(json)
  set(others)
  foreach(source ${ARGN})
    cmake_path(ABSOLUTE_PATH source OUTPUT_VARIABLE path)
    file(STRINGS ${path} uses LIMIT_COUNT 1 REGEX "nlohmann/json.hpp")
    if(uses)
      list(APPEND json ${source})
    else()
      list(APPEND others ${source})
    endif()
  endforeach()
  set(${out} ${others} ${json} PARENT_SCOPE)
endfunction()

# Rooms that organise and describe what others compute. Clang spends two thirds of its time on optimising, a quarter of that on copies of functions that
# it inlines: with fewer of them these compile in 17 % less time. Rooms that compute would run up to 9 % longer.
set(rooms_that_organise app bench coordinator core/base core/config core/page core/survey evaluate/control evaluate/metrics evaluate/page masks odm partition
  prepare/control prepare/georeference prepare/input prepare/models prepare/rigs prepare/tables prepare/video tour viewer)

# NO_PARSED_HEADERS: for sources with compiler options of their own.
function(skyquilt_library name)
  cmake_parse_arguments(ARG "NO_PARSED_HEADERS" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  skyquilt_json_last(sources ${ARG_SOURCES})
  add_library(${name} STATIC ${sources})
  skyquilt_target(${name})
  set_target_properties(${name} PROPERTIES UNITY_BUILD ${SKYQUILT_UNITY} UNITY_BUILD_BATCH_SIZE 12)
  # Warnings apply to our code only, not to third-party headers.
  target_link_libraries(${name} PUBLIC ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE})
  cmake_path(RELATIVE_PATH CMAKE_CURRENT_SOURCE_DIR BASE_DIRECTORY ${PROJECT_SOURCE_DIR} OUTPUT_VARIABLE folder)
  foreach(room IN LISTS rooms_that_organise)
    if("${folder}/" MATCHES "^${room}/")
      target_compile_options(${name} PRIVATE $<$<AND:$<CONFIG:Release>,$<CXX_COMPILER_ID:Clang>>:SHELL:-mllvm -inline-threshold=50 -mllvm -inlinehint-threshold=50>)
    endif()
  endforeach()
  if(NOT ARG_NO_PARSED_HEADERS)
    skyquilt_use_parsed_headers(${name} program)
  endif()
endfunction()

# skyquilt_timeout(600 test...): seconds after which a test is stopped as hung; six times as long with sanitizers, which are slow.
function(skyquilt_timeout seconds)
  if(SKYQUILT_SANITIZE)
    math(EXPR seconds "${seconds} * 6")
  endif()
  set_tests_properties(${ARGN} PROPERTIES TIMEOUT ${seconds})
endfunction()

# OPTIMISED: for tests whose own code computes for longer than optimising it takes.
function(skyquilt_test name)
  cmake_parse_arguments(ARG "OPTIMISED" "TIMEOUT" "SOURCES;LIBRARIES" ${ARGN})
  skyquilt_json_last(sources ${ARG_SOURCES})
  add_executable(test_${name} ${sources})
  set(level ${test_level})
  set(kind tests)
  if(ARG_OPTIMISED)
    set(level)
    set(kind optimised_tests)
  endif()
  skyquilt_target(test_${name} ${level})
  set_target_properties(test_${name} PROPERTIES UNITY_BUILD ${SKYQUILT_UNITY} UNITY_BUILD_BATCH_SIZE 6)
  target_link_libraries(test_${name} PRIVATE ${ARG_LIBRARIES} core_base nlohmann_json::nlohmann_json rapidcheck rapidcheck_gtest GTest::gtest
    GTest::gtest_main)
  skyquilt_use_parsed_headers(test_${name} ${kind})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 600)
  endif()
  add_test(NAME ${name} COMMAND test_${name} WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
  skyquilt_timeout(${ARG_TIMEOUT} ${name})
  set_tests_properties(${name} PROPERTIES
    ENVIRONMENT "OMPI_ALLOW_RUN_AS_ROOT=1;OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1;${thread_options}")
endfunction()
