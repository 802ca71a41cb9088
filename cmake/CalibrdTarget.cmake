# One way to declare a target, so that every target gets the same warnings and include root.
find_program(CALIBRD_CCACHE ccache)
if(CALIBRD_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CALIBRD_CCACHE})
endif()

function(calibrd_target_defaults target)
  target_include_directories(${target} PUBLIC ${PROJECT_SOURCE_DIR})
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wconversion)
  if(CALIBRD_SANITIZE)
    target_compile_options(${target} PUBLIC -fsanitize=${CALIBRD_SANITIZE} -fno-omit-frame-pointer)
    target_link_options(${target} PUBLIC -fsanitize=${CALIBRD_SANITIZE})
  endif()
endfunction()

# calibrd_library(name source...): a static library.
function(calibrd_library target)
  add_library(${target} STATIC ${ARGN})
  calibrd_target_defaults(${target})
endfunction()

# calibrd_executable(name source...): a program in build/<preset>/bin. It exports nothing of its libraries: weak symbols
# of our Boost would take the place of those in shared objects that were compiled against the system's.
function(calibrd_executable target)
  add_executable(${target} ${ARGN})
  calibrd_target_defaults(${target})
  target_link_options(${target} PRIVATE -Wl,--exclude-libs,ALL)
endfunction()

# calibrd_test(name LIBS lib... SOURCES source...): a GoogleTest program, each of its tests known to ctest.
function(calibrd_test target)
  cmake_parse_arguments(arg "" "" "LIBS;SOURCES" ${ARGN})
  find_package(GTest REQUIRED)
  include(GoogleTest)
  calibrd_executable(${target} ${arg_SOURCES})
  set_target_properties(${target} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/tests)
  target_link_libraries(${target} PRIVATE ${arg_LIBS} GTest::gtest_main)
  gtest_discover_tests(${target} PROPERTIES TIMEOUT 300 DISCOVERY_TIMEOUT 60)
endfunction()
