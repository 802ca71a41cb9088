# One way to declare a target, so that every target gets the same warnings and include root.
find_program(CALIBRD_CCACHE ccache)
if(CALIBRD_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  # ccache takes precompiled headers only when told that no source asks for the time or for macros that change them; and it
  # need not read their 200 MB for every object (ccache 4.8 remembers what it has read by itself).
  set(CMAKE_CXX_COMPILER_LAUNCHER env CCACHE_SLOPPINESS=pch_defines,time_macros CCACHE_INODECACHE=1 ${CALIBRD_CCACHE})
endif()

function(calibrd_target_defaults target)
  target_include_directories(${target} PUBLIC ${PROJECT_SOURCE_DIR})
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wconversion)
  if(CALIBRD_SANITIZE)
    target_compile_options(${target} PUBLIC -fsanitize=${CALIBRD_SANITIZE} -fno-omit-frame-pointer)
    target_link_options(${target} PUBLIC -fsanitize=${CALIBRD_SANITIZE})
  endif()
endfunction()

# calibrd_library(name source...): a static library. CALIBRD_UNITY compiles several of its sources at a time, for what they
# instantiate of Eigen and Beast costs more than they do; so names in unnamed namespaces differ within a library.
function(calibrd_library target)
  add_library(${target} STATIC ${ARGN})
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${CALIBRD_UNITY} UNITY_BUILD_BATCH_SIZE 6)
  calibrd_target_defaults(${target})
  calibrd_use_pch(${target} ${CALIBRD_PCH_FAMILY})
endfunction()

# calibrd_executable(name source...): a program in build/<preset>/bin. It exports nothing of its libraries: weak symbols
# of our Boost would take the place of those in shared objects that were compiled against the system's.
function(calibrd_executable target)
  add_executable(${target} ${ARGN})
  calibrd_target_defaults(${target})
  target_link_options(${target} PRIVATE -Wl,--exclude-libs,ALL)
endfunction()

# Optimising tests themselves further takes longer to compile than it saves when they run; what they test is as released.
function(calibrd_test_options target)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O2>)
endfunction()

# calibrd_test(name LIBS lib... SOURCES source... [ALONE source...]): a GoogleTest program, each of its tests known to ctest.
# Several sources are compiled at a time: what they instantiate of Eigen and GoogleTest costs more than they do. ALONE are
# those which have a name in common with another source, or stand in for functions of the system.
function(calibrd_test target)
  cmake_parse_arguments(arg "" "" "LIBS;SOURCES;ALONE" ${ARGN})
  find_package(GTest REQUIRED)
  include(GoogleTest)
  calibrd_executable(${target} ${arg_SOURCES} ${arg_ALONE})
  calibrd_test_options(${target})
  if(CALIBRD_PCH_FAMILY STREQUAL "net")
    calibrd_use_pch(${target} test_net)
  else()
    calibrd_use_pch(${target} test)
  endif()
  set_target_properties(${target} PROPERTIES
    RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/tests UNITY_BUILD ${CALIBRD_UNITY} UNITY_BUILD_BATCH_SIZE 8)
  set_source_files_properties(${arg_ALONE} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  target_link_libraries(${target} PRIVATE ${arg_LIBS} GTest::gtest_main)
  gtest_discover_tests(${target} PROPERTIES TIMEOUT 300 PROCESSORS ${CALIBRD_ONE_PROCESSOR} DISCOVERY_TIMEOUT 60)
endfunction()
