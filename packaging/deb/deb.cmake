# cpack: one .deb, for the very distribution it is built on, whose libraries it is linked to.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME calibrd)
set(CPACK_PACKAGE_VENDOR "The calibrd authors")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "keeps the poses of the 3D sensors of a robot cell true")
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION "A headless daemon that reads a robot controller over TCP and depth frames through OpenNI2,
calibrates each fixed sensor to the robot without markers, watches the poses and serves them over HTTP/JSON.")
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR}/package)
set(CPACK_STRIP_FILES ON)

# With DESTDIR, not another prefix: the unit names /usr, and the configuration goes to /etc.
set(CPACK_SET_DESTDIR ON)
set(CPACK_INSTALL_PREFIX /usr)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)

# 0.1.0-1~debian12: of two for different releases apt takes the newer release's.
file(STRINGS /etc/os-release calibrd_os REGEX "^(ID|VERSION_ID)=")
string(REGEX MATCH "(^|;)ID=\"?([a-z]+)" _ "${calibrd_os}")
set(calibrd_os_name ${CMAKE_MATCH_2})
string(REGEX MATCH "VERSION_ID=\"?([0-9.]+)" _ "${calibrd_os}")
set(CPACK_DEBIAN_PACKAGE_RELEASE "1~${calibrd_os_name}${CMAKE_MATCH_1}")
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_MAINTAINER "The calibrd authors <root@localhost>")
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)

# The libraries, OpenNI2, Embree and PCL's parts among them, are found in the programs. systemd makes the user, procps has the
# kill that reloads, passwd removes the user.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_DEPENDS "systemd | systemd-standalone-sysusers, procps, passwd")
# The authorities of a broker's certificate, where mqtt.tls.ca names none.
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "ca-certificates")
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA
  ${CMAKE_CURRENT_LIST_DIR}/conffiles ${CMAKE_CURRENT_LIST_DIR}/postinst ${CMAKE_CURRENT_LIST_DIR}/prerm
  ${CMAKE_CURRENT_LIST_DIR}/postrm)
include(CPack)
