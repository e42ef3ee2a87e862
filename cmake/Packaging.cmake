# The Debian package: cpack --config build/release/CPackConfig.cmake, or `cpack` in the build folder.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME covtrace)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_CONTACT "covtrace maintainers <maintainers@covtrace.invalid>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "path tracer that predicts the samples and the filter of every pixel")
set(CPACK_PACKAGE_DESCRIPTION
"covtrace renders scenes of the format pbrt-v4. From the covariance of the local light field's spectrum it predicts
how many samples every pixel needs and how wide and in which direction it may be smoothed. The package also holds
the covariance operators as a header-only library for other renderers.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "python3-numpy")
set(CPACK_VERBATIM_VARIABLES ON)
include(CPack)
