# The Debian package: cpack --config build/release/CPackConfig.cmake, or `cpack` in the build folder.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME covtrace)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_CONTACT "covtrace maintainers <maintainers@covtrace.invalid>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "path tracer that predicts the samples and the filter of every pixel")
# What a processor has to have, which a package's architecture does not say.
set(processor "any x86-64 processor")
if(COVTRACE_MARCH STREQUAL x86-64-v3)
    set(processor "a processor with AVX2, FMA and BMI2 (x86-64-v3, most since 2013)\nand refuses to start on others")
elseif(COVTRACE_MARCH AND NOT COVTRACE_MARCH STREQUAL x86-64)
    set(processor "a processor like the one that it was built for (-march=${COVTRACE_MARCH})")
endif()
set(CPACK_PACKAGE_DESCRIPTION
"covtrace renders scenes of the formats pbrt-v4 and glTF. From the covariance
of the local light field's spectrum it predicts how many samples every pixel
needs and how wide and in which direction it may be smoothed.
The package also holds the module covtrace for Debian's python3, and the
covariance operators as a header-only library for other renderers.
It needs ${processor}.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# Two packages: the module for mpirun needs OpenMPI, and nothing else does.
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_MAIN_PACKAGE_NAME covtrace)
set(CPACK_DEBIAN_MAIN_DESCRIPTION "${CPACK_PACKAGE_DESCRIPTION}")
set(CPACK_DEBIAN_MAIN_PACKAGE_RECOMMENDS "python3-numpy")
set(CPACK_DEBIAN_MAIN_PACKAGE_SUGGESTS "covtrace-mpi")
if(TARGET covtrace_python)
    configure_file(${CMAKE_CURRENT_SOURCE_DIR}/packaging/prerm.in ${CMAKE_CURRENT_BINARY_DIR}/packaging/prerm @ONLY
        FILE_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
    set(CPACK_DEBIAN_MAIN_PACKAGE_CONTROL_EXTRA ${CMAKE_CURRENT_BINARY_DIR}/packaging/prerm)
endif()
set(CPACK_DEBIAN_MPI_PACKAGE_NAME covtrace-mpi)
set(CPACK_DEBIAN_MPI_PACKAGE_DEPENDS "covtrace (= ${PROJECT_VERSION}), openmpi-bin")
set(CPACK_VERBATIM_VARIABLES ON)
include(CPack)
foreach(component program covariance python)
    cpack_add_component(${component} GROUP main)
endforeach()
cpack_add_component_group(main)
if(TARGET covtrace_mpi)
    cpack_add_component(mpi DESCRIPTION "the module with which covtrace renders under mpirun")
endif()

# What the packages hold, for scripts/release: cpack builds nothing itself.
add_custom_target(covtrace_packaged)
foreach(target covtrace_program covtrace_python_package covtrace_mpi)
    if(TARGET ${target})
        add_dependencies(covtrace_packaged ${target})
    endif()
endforeach()
