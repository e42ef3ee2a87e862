# Writes OUTPUT from INPUT with the version and the commit of SOURCE ("unknown" outside a repository).
find_package(Git QUIET)
set(COVTRACE_COMMIT unknown)
if(Git_FOUND)
    execute_process(COMMAND ${GIT_EXECUTABLE} -C ${SOURCE} rev-parse --short=12 HEAD
        OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE result)
    if(result EQUAL 0)
        set(COVTRACE_COMMIT ${commit})
    endif()
endif()
set(PROJECT_VERSION ${VERSION})
configure_file(${INPUT} ${OUTPUT} @ONLY)
