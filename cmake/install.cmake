# cmake --install and cpack: the program with its man page and completions, scenes and docs, and the engine for
# find_package(hourglass).
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/hourglass)
set(engine_dir ${CMAKE_INSTALL_LIBDIR}/hourglass)  # of its own: who links to it compiles against these very headers

set_target_properties(hourglass PROPERTIES INSTALL_RPATH
                      "$ORIGIN/../${engine_dir}")
install(TARGETS hourglass RUNTIME)
set_target_properties(hourglass_solver PROPERTIES EXPORT_NAME solver)
install(TARGETS hourglass_solver options EXPORT hourglass
        ARCHIVE DESTINATION ${engine_dir} LIBRARY DESTINATION ${engine_dir}
        INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/hourglass)
if(HOURGLASS_PORTABLE)
  install(DIRECTORY ${PROJECT_BINARY_DIR}/lib/glibc-hwcaps DESTINATION ${engine_dir})
endif()
install(DIRECTORY kernels solver DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/hourglass FILES_MATCHING PATTERN *.hpp)
install(EXPORT hourglass NAMESPACE hourglass:: FILE hourglass-targets.cmake DESTINATION ${package_dir})
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/hourglass-config.cmake.in hourglass-config.cmake
                              INSTALL_DESTINATION ${package_dir} NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(hourglass-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/hourglass-config.cmake ${PROJECT_BINARY_DIR}/hourglass-config-version.cmake
        DESTINATION ${package_dir})

# Written by the program from the table that reads its command line.
set(pages ${PROJECT_BINARY_DIR}/pages)
install(CODE "file(MAKE_DIRECTORY ${pages})
execute_process(COMMAND $<TARGET_FILE:hourglass> pages ${pages} COMMAND_ERROR_IS_FATAL ANY)")
install(FILES ${pages}/hourglass.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
install(FILES ${pages}/hourglass.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME hourglass)
install(FILES ${pages}/hourglass.zsh DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions RENAME _hourglass)
install(DIRECTORY configs DESTINATION ${CMAKE_INSTALL_DATADIR}/hourglass)
install(DIRECTORY docs/ DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES README.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME copyright)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "the hourglass developers <hourglass@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "granular silo flow: mu(I) rheology, free surface, multigrid")
set(CPACK_PACKAGE_DESCRIPTION "Solves the flow of grains out of silos: the incompressible mu(I) rheology with a geometric
free surface and material tracers on a staggered grid; nonlocal fluidity, dilatancy and wall friction where a
scene asks for them. Writes XDMF and HDF5 time series and pictures, and needs no display.")
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_DEPENDS "libgl1-mesa-dri, fonts-dejavu-core")  # what the program opens while it runs
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "g++, cmake, libeigen3-dev, libfmt-dev, paraview, python3-h5py")
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${PROJECT_BINARY_DIR}/lib)
set(CPACK_STRIP_FILES ON)
include(CPack)
