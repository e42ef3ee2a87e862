# Writes OUTPUT from INPUT with the version and the commit of SOURCE: "unknown" outside a repository, with "-dirty" where
# files differ from it.
find_package(Git QUIET)
set(COVTRACE_COMMIT unknown)
if(Git_FOUND)
    execute_process(COMMAND ${GIT_EXECUTABLE} -C ${SOURCE} rev-parse --short=12 HEAD
        OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE result)
    if(result EQUAL 0)
        set(COVTRACE_COMMIT ${commit})
        execute_process(COMMAND ${GIT_EXECUTABLE} -C ${SOURCE} diff --quiet HEAD -- RESULT_VARIABLE differs ERROR_QUIET)
        if(NOT differs EQUAL 0)
            string(APPEND COVTRACE_COMMIT -dirty)
        endif()
    endif()
endif()
set(PROJECT_VERSION ${VERSION})
configure_file(${INPUT} ${OUTPUT} @ONLY)
