# What `cmake --install` puts on a system, and the Debian packages made of it:
#   cmake --build --preset release --target package      build/release/skyquilt_<version>_<architecture>.deb, and python3-skyquilt_... with the module
include(GNUInstallDirs)
# Of the program; the module's files name their own component, python (python/CMakeLists.txt).
set(CMAKE_INSTALL_DEFAULT_COMPONENT_NAME program)
set(CMAKE_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)

# The library paths of the build are for the build only; an installed program asks the system.
set_target_properties(skyquilt skyquilt_bench PROPERTIES INSTALL_RPATH "" INSTALL_RPATH_USE_LINK_PATH OFF)
configure_file(packaging/skyquilt.1.in packaging/skyquilt.1 @ONLY)

install(TARGETS skyquilt skyquilt_bench)
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
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING IGNORE)  # a package for each component
set(CPACK_COMPONENTS_ALL program)
set(CPACK_PACKAGE_CONTACT ${SKYQUILT_MAINTAINER})
# Their first lines are the summaries; CPACK_PACKAGE_DESCRIPTION_SUMMARY would be put before all of them.
file(READ packaging/description CPACK_DEBIAN_PROGRAM_DESCRIPTION)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS ${CMAKE_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS})
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
# Libraries are found by dpkg-shlibdeps. mpirun starts ranks; apt installs the recommended programs too, but the program works without them.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME skyquilt)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS openmpi-bin)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS "colmap, ffmpeg")
if(SKYQUILT_HAS_PYTHON)
  set_target_properties(skyquilt_python PROPERTIES INSTALL_RPATH "" INSTALL_RPATH_USE_LINK_PATH OFF)
  list(APPEND CPACK_COMPONENTS_ALL python)
  install(FILES LICENSE packaging/copyright DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/python3-skyquilt COMPONENT python)
  math(EXPR next_minor "${Python_VERSION_MINOR} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-skyquilt)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
  # The module fits one version of Python only.
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
    "python3 (>= ${Python_VERSION_MAJOR}.${Python_VERSION_MINOR}), python3 (<< ${Python_VERSION_MAJOR}.${next_minor}), python3-numpy")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS "colmap, ffmpeg")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "skyquilt, python3-matplotlib")
  file(READ packaging/description-python CPACK_DEBIAN_PYTHON_DESCRIPTION)
endif()
include(CPack)
