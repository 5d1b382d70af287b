# Functions that define one library per folder, skyquilt_library(core_geo SOURCES a.cpp PUBLIC deps PRIVATE deps),
# and one test program per folder, skyquilt_test(core_geo SOURCES a_test.cpp LIBRARIES core_geo).

add_library(skyquilt_warnings INTERFACE)
target_compile_options(skyquilt_warnings INTERFACE -Wall -Wextra -Wshadow -Wconversion -Wdouble-promotion -Wnon-virtual-dtor -Wold-style-cast
  # g++ 12 warns wrongly about overlaps in "literal" + std::string (GCC bug 105329).
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>)
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

# Settings of all our targets.
function(skyquilt_target name)
  target_compile_features(${name} PUBLIC cxx_std_20)
  set_target_properties(${name} PROPERTIES CXX_EXTENSIONS OFF)
  # After CMake's -O3 of release builds, so that -O2 takes effect.
  target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-O2>)
  target_include_directories(${name} PUBLIC ${PROJECT_SOURCE_DIR})
  target_link_libraries(${name} PRIVATE skyquilt_warnings)
endfunction()

function(skyquilt_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES})
  skyquilt_target(${name})
  set_target_properties(${name} PROPERTIES UNITY_BUILD ${SKYQUILT_UNITY} UNITY_BUILD_BATCH_SIZE 12)
  # Warnings apply to our code only, not to third-party headers.
  target_link_libraries(${name} PUBLIC ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE})
endfunction()

# For libraries that are long to compile and short to run, because others do their heavy work: g++ takes a third less time in release builds.
function(skyquilt_quick_to_compile)
  foreach(name ${ARGN})
    target_compile_options(${name} PRIVATE
      "$<$<AND:$<CONFIG:Release>,$<CXX_COMPILER_ID:GNU>>:-O1;-fno-tree-dominator-opts;-fno-tree-pta>")
  endforeach()
endfunction()

# skyquilt_timeout(600 test...): seconds after which a test is stopped as hung; six times as long with sanitizers, which are slow.
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
  set_target_properties(test_${name} PROPERTIES UNITY_BUILD ${SKYQUILT_UNITY} UNITY_BUILD_BATCH_SIZE 6)
  target_link_libraries(test_${name} PRIVATE ${ARG_LIBRARIES} GTest::gtest GTest::gtest_main)
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 600)
  endif()
  add_test(NAME ${name} COMMAND test_${name} WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
  skyquilt_timeout(${ARG_TIMEOUT} ${name})
  set_tests_properties(${name} PROPERTIES
    ENVIRONMENT "OMPI_ALLOW_RUN_AS_ROOT=1;OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1;${thread_options}")
endfunction()
