# pcl_parts: PCL's common, kdtree, search and filters, and its headers (registration is all templates). The rest of PCL
# pulls in VTK, Qt and Boost's shared objects, and so does libpcl-dev: scripts/setup.sh unpacks its headers into
# .deps/pcl and installs the few libraries themselves. An installed libpcl-dev serves as well.
file(GLOB calibrd_pcl_prefixes ${PROJECT_SOURCE_DIR}/.deps/pcl/usr/include/pcl-* /usr/include/pcl-*)
find_path(CALIBRD_PCL_INCLUDE pcl/registration/icp.h HINTS ${calibrd_pcl_prefixes})
find_path(CALIBRD_FLANN_INCLUDE flann/util/params.h HINTS ${PROJECT_SOURCE_DIR}/.deps/pcl/usr/include)
if(NOT CALIBRD_PCL_INCLUDE OR NOT CALIBRD_FLANN_INCLUDE)
  message(FATAL_ERROR "PCL not found. Run scripts/setup.sh first.")
endif()
find_package(Eigen3 REQUIRED NO_MODULE)

add_library(pcl_parts INTERFACE)
string(REGEX REPLACE ".*/pcl-" "" calibrd_pcl_version ${CALIBRD_PCL_INCLUDE})
foreach(part common kdtree search filters)
  # By its full name: the links without a version are libpcl-dev's.
  find_library(CALIBRD_PCL_${part} NAMES libpcl_${part}.so.${calibrd_pcl_version} pcl_${part} REQUIRED)
  target_link_libraries(pcl_parts INTERFACE ${CALIBRD_PCL_${part}})
endforeach()
target_include_directories(pcl_parts SYSTEM INTERFACE ${CALIBRD_PCL_INCLUDE})
if(NOT CALIBRD_FLANN_INCLUDE STREQUAL "/usr/include")
  target_include_directories(pcl_parts SYSTEM INTERFACE ${CALIBRD_FLANN_INCLUDE})
endif()
target_link_libraries(pcl_parts INTERFACE Eigen3::Eigen)
