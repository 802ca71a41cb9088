# boost_net: Asio, Beast and JSON from Boost >= 1.81, compiled once. On Debian 12 the system's Boost is 1.74, without
# JSON; scripts/setup.sh unpacks the headers of 1.81 into .deps/boost. No translation unit may see both.
find_path(CALIBRD_BOOST_INCLUDE boost/json.hpp
  HINTS ${PROJECT_SOURCE_DIR}/.deps/boost/usr/include NO_DEFAULT_PATH)
find_path(CALIBRD_BOOST_INCLUDE boost/json.hpp)
if(NOT CALIBRD_BOOST_INCLUDE)
  message(FATAL_ERROR "No Boost with Boost.JSON found. Run scripts/setup.sh first.")
endif()
find_package(OpenSSL REQUIRED)
find_package(Threads REQUIRED)

add_library(boost_net STATIC ${PROJECT_SOURCE_DIR}/cmake/boost_net.cpp)
if(CALIBRD_BOOST_INCLUDE STREQUAL "/usr/include")
  set(calibrd_boost_dirs) # the compiler looks there anyway
else()
  set(calibrd_boost_dirs ${CALIBRD_BOOST_INCLUDE})
endif()
target_include_directories(boost_net SYSTEM PUBLIC ${calibrd_boost_dirs})
target_compile_definitions(boost_net PUBLIC
  BOOST_ASIO_SEPARATE_COMPILATION BOOST_BEAST_SEPARATE_COMPILATION BOOST_ASIO_NO_DEPRECATED
  BOOST_ALL_NO_LIB)
target_link_libraries(boost_net PUBLIC OpenSSL::SSL OpenSSL::Crypto Threads::Threads)
if(CALIBRD_SANITIZE)
  target_compile_options(boost_net PRIVATE -fsanitize=${CALIBRD_SANITIZE} -fno-omit-frame-pointer)
endif()
