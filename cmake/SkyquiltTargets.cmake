# Helpers for one target per room: skyquilt_library(core_geo SOURCES a.cpp PUBLIC deps PRIVATE deps)
# and one test program per room: skyquilt_test(core_geo SOURCES a_test.cpp LIBRARIES core_geo).

add_library(skyquilt_warnings INTERFACE)
target_compile_options(skyquilt_warnings INTERFACE -Wall -Wextra -Wshadow -Wconversion -Wdouble-promotion -Wnon-virtual-dtor -Wold-style-cast
  # g++ 12 reports overlaps that cannot be in "literal" + std::string (GCC bug 105329).
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>)
if(SKYQUILT_UNITY)
  # A joined file looks like a header full of anonymous namespaces.
  target_compile_options(skyquilt_warnings INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
endif()
if(SKYQUILT_WERROR)
  target_compile_options(skyquilt_warnings INTERFACE -Werror)
endif()
if(SKYQUILT_SANITIZE)
  target_compile_options(skyquilt_warnings INTERFACE -fsanitize=${SKYQUILT_SANITIZE} -fno-omit-frame-pointer)
  target_link_options(skyquilt_warnings INTERFACE -fsanitize=${SKYQUILT_SANITIZE})
endif()

# What every target of ours is compiled with.
function(skyquilt_target name)
  target_compile_features(${name} PUBLIC cxx_std_20)
  set_target_properties(${name} PROPERTIES CXX_EXTENSIONS OFF)
  # Behind CMake's own -O3 of release builds, so that this one counts.
  target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-O2>)
  target_include_directories(${name} PUBLIC ${PROJECT_SOURCE_DIR})
  target_link_libraries(${name} PRIVATE skyquilt_warnings)
endfunction()

function(skyquilt_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES})
  skyquilt_target(${name})
  set_target_properties(${name} PROPERTIES UNITY_BUILD ${SKYQUILT_UNITY} UNITY_BUILD_BATCH_SIZE 6)
  # Third-party headers are not held to our warnings.
  target_link_libraries(${name} PUBLIC ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE})
endfunction()

# skyquilt_timeout(600 test...): seconds before a test counts as hung; sanitizers slow everything down.
function(skyquilt_timeout seconds)
  if(SKYQUILT_SANITIZE)
    math(EXPR seconds "${seconds} * 6")
  endif()
  set_tests_properties(${ARGN} PROPERTIES TIMEOUT ${seconds})
endfunction()

function(skyquilt_test name)
  cmake_parse_arguments(ARG "" "TIMEOUT" "SOURCES;LIBRARIES" ${ARGN})
  add_executable(test_${name} ${ARG_SOURCES})
  skyquilt_target(test_${name})
  target_link_libraries(test_${name} PRIVATE ${ARG_LIBRARIES} GTest::gtest GTest::gtest_main)
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 600)
  endif()
  add_test(NAME ${name} COMMAND test_${name} WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
  skyquilt_timeout(${ARG_TIMEOUT} ${name})
  set_tests_properties(${name} PROPERTIES
    ENVIRONMENT "OMPI_ALLOW_RUN_AS_ROOT=1;OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1;${thread_options}")
endfunction()
