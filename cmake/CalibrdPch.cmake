# Precompiled headers: most of a source's compile time goes into the same few headers. There is one for each kind of code,
# made once and shared (GCC takes one only with the flags it was made with):
#   plain  the standard library and Eigen           for libraries; what calibrd_library takes by itself
#   net    these, Boost.JSON and Asio               where a folder says set(CALIBRD_PCH_FAMILY net); needs boost_net
#   test   plain's and GoogleTest                   for calibrd_test
#   test_net                                        the same, with net's
# They must not hide a missing #include: `cmake --preset release -D CALIBRD_PCH=OFF` builds without, and so does clang.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  set(calibrd_pch_default ON)
else()
  set(calibrd_pch_default OFF)
endif()
option(CALIBRD_PCH "Precompile headers (GCC); without them every source must include what it uses" ${calibrd_pch_default})
set(CALIBRD_PCH_FAMILY plain)

set(calibrd_pch_std
  <algorithm> <array> <atomic> <bit> <charconv> <chrono> <cmath> <condition_variable> <cstdint> <cstdio> <cstdlib>
  <cstring> <deque> <filesystem> <fstream> <functional> <limits> <map> <memory> <mutex> <numbers> <optional> <random>
  <set> <span> <sstream> <stdexcept> <string> <string_view> <system_error> <thread> <utility> <variant> <vector>
  <Eigen/Cholesky> <Eigen/Core> <Eigen/Eigenvalues> <Eigen/Geometry> <Eigen/LU>)
set(calibrd_pch_boost
  <boost/asio/io_context.hpp> <boost/asio/ip/tcp.hpp> <boost/asio/post.hpp> <boost/asio/steady_timer.hpp>
  <boost/asio/write.hpp> <boost/json.hpp>)

# calibrd_add_pch(family HEADERS header... LIBS lib...): the target that makes it.
function(calibrd_add_pch family)
  cmake_parse_arguments(arg "" "" "HEADERS;LIBS" ${ARGN})
  set(target calibrd_pch_${family})
  add_library(${target} OBJECT ${PROJECT_SOURCE_DIR}/cmake/pch.cpp)
  calibrd_target_defaults(${target})
  target_link_libraries(${target} PRIVATE ${arg_LIBS})
  target_precompile_headers(${target} PRIVATE ${arg_HEADERS})
  if(family MATCHES "^test")
    set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE OFF)
    target_compile_options(${target} PRIVATE -fPIE) # as CMake does for programs
    calibrd_test_options(${target})
  endif()
endfunction()

# calibrd_use_pch(target family)
function(calibrd_use_pch target family)
  if(NOT CALIBRD_PCH)
    return()
  endif()
  target_precompile_headers(${target} REUSE_FROM calibrd_pch_${family})
  # Lets ccache see which one was used. GCC 12 warns of its own <string> (PR 105651), the more often where it is precompiled.
  target_compile_options(${target} PRIVATE -fpch-preprocess
    $<$<VERSION_LESS:$<CXX_COMPILER_VERSION>,13>:-Wno-array-bounds -Wno-restrict -Wno-stringop-overflow>)
endfunction()

if(CALIBRD_PCH)
  find_package(Eigen3 REQUIRED NO_MODULE)
  calibrd_add_pch(plain HEADERS ${calibrd_pch_std} LIBS Eigen3::Eigen)
  calibrd_add_pch(net HEADERS ${calibrd_pch_std} ${calibrd_pch_boost} LIBS Eigen3::Eigen boost_net)
  if(BUILD_TESTING)
    find_package(GTest REQUIRED)
    calibrd_add_pch(test HEADERS ${calibrd_pch_std} <gtest/gtest.h> LIBS Eigen3::Eigen GTest::gtest)
    calibrd_add_pch(test_net HEADERS ${calibrd_pch_std} <gtest/gtest.h> ${calibrd_pch_boost}
      LIBS Eigen3::Eigen GTest::gtest boost_net)
  endif()
endif()
