# What `cmake --install` puts on a system, and the Debian package made of it:
#   cmake --build --preset release --target package      build/release/skyquilt_<version>_<architecture>.deb
include(GNUInstallDirs)
set(CMAKE_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)

# The library paths of the build are for the build only; an installed program asks the system.
set_target_properties(skyquilt PROPERTIES INSTALL_RPATH "" INSTALL_RPATH_USE_LINK_PATH OFF)
configure_file(packaging/skyquilt.1.in packaging/skyquilt.1 @ONLY)

install(TARGETS skyquilt)
install(PROGRAMS scripts/skyquilt-mpirun DESTINATION ${CMAKE_INSTALL_BINDIR})
install(FILES ${PROJECT_BINARY_DIR}/packaging/skyquilt.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
# What NodeODM takes for OpenDroneMap's folder (docs/odm.md).
set(odm_folder share/skyquilt/odm)
configure_file(${odm_folder}/VERSION.in ${odm_folder}/VERSION @ONLY)
install(PROGRAMS ${odm_folder}/run.sh DESTINATION ${CMAKE_INSTALL_DATADIR}/skyquilt/odm)
install(FILES ${odm_folder}/ENGINE ${PROJECT_BINARY_DIR}/${odm_folder}/VERSION DESTINATION ${CMAKE_INSTALL_DATADIR}/skyquilt/odm)
install(FILES ${odm_folder}/opendm/config.py ${odm_folder}/opendm/options.json DESTINATION ${CMAKE_INSTALL_DATADIR}/skyquilt/odm/opendm)
install(FILES README.md LICENSE packaging/copyright DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY configs DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples)
install(PROGRAMS scripts/skyquilt.slurm DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples)

set(SKYQUILT_MAINTAINER "Skyquilt maintainers <maintainers@skyquilt.invalid>" CACHE STRING "Who answers for the package: name <address>")
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME skyquilt)
set(CPACK_PACKAGE_CONTACT ${SKYQUILT_MAINTAINER})
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "drone photos to a geo-referenced radiance field, on CPUs")
set(CPACK_PACKAGE_DESCRIPTION_FILE ${PROJECT_SOURCE_DIR}/packaging/description)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS ${CMAKE_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS})
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
# Libraries are found by dpkg-shlibdeps. mpirun starts ranks; apt installs the recommended programs too, but the program works without them.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_DEPENDS openmpi-bin)
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "colmap, ffmpeg")
include(CPack)
