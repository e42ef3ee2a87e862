# The renderer's folders as libraries and its tests, with the flags that all of them share.

find_package(TBB REQUIRED)

add_library(covtrace_flags INTERFACE)
target_compile_features(covtrace_flags INTERFACE cxx_std_20)
# No contraction: the same expression must round the same way wherever it is inlined.
# No errno from mathematics and no traps, which nobody reads: square roots become single instructions, and what only
# some lanes need may be computed for all of them, so that loops become vector instructions. Values stay the same.
target_compile_options(covtrace_flags INTERFACE -Wall -Wextra -Wpedantic -Wshadow -ffp-contract=off -fno-math-errno
                       -fno-trapping-math)
# g++ 12 reports string concatenation as overlapping copies (GCC bug 105651).
# It also tells of vectors that lambdas return without a place in the source, out of reach of the pragma in core/simd.h.
# Initialisers by name leave all others to their defaults, which g++ alone takes for forgotten ones.
target_compile_options(covtrace_flags INTERFACE
                       "$<$<CXX_COMPILER_ID:GNU>:-Wno-restrict;-Wno-psabi;-Wno-missing-field-initializers>")
target_include_directories(covtrace_flags INTERFACE "${PROJECT_SOURCE_DIR}/src")
set(COVTRACE_MARCH "" CACHE STRING "Value of -march; empty leaves the compiler's default")
if(COVTRACE_MARCH)
    target_compile_options(covtrace_flags INTERFACE "-march=${COVTRACE_MARCH}")
endif()
option(COVTRACE_THIN_LTO "Optimise across files at link time (clang and lld)" OFF)
if(COVTRACE_THIN_LTO)
    # Programs that link the same libraries share what was generated for them.
    target_compile_options(covtrace_flags INTERFACE -flto=thin)
    target_link_options(covtrace_flags INTERFACE -flto=thin -fuse-ld=lld
                        "-Wl,--thinlto-cache-dir=${PROJECT_BINARY_DIR}/thin-lto")
    # GNU's ar does not know what is in them.
    set(CMAKE_AR "${CMAKE_CXX_COMPILER_AR}")
    set(CMAKE_RANLIB "${CMAKE_CXX_COMPILER_RANLIB}")
endif()
option(COVTRACE_SANITIZE "Address and undefined-behaviour sanitizers" OFF)
if(COVTRACE_SANITIZE)
    target_compile_options(covtrace_flags INTERFACE -fsanitize=address,undefined -fno-omit-frame-pointer)
    target_link_options(covtrace_flags INTERFACE -fsanitize=address,undefined)
endif()
option(COVTRACE_SANITIZE_THREADS "Thread sanitizer" OFF)
if(COVTRACE_SANITIZE_THREADS)
    target_compile_options(covtrace_flags INTERFACE -fsanitize=thread -fno-omit-frame-pointer)
    target_link_options(covtrace_flags INTERFACE -fsanitize=thread)
endif()
# Seconds that a test of a minute may take on a loaded machine; sanitizers make programs ten times as slow.
set(COVTRACE_TEST_SECONDS 600)
if(COVTRACE_SANITIZE OR COVTRACE_SANITIZE_THREADS)
    set(COVTRACE_TEST_SECONDS 3600)
endif()
option(COVTRACE_FUZZ "Build the targets of fuzz/ with libFuzzer (clang)" OFF)
if(COVTRACE_FUZZ)
    # Float-cast overflow too: a coordinate that is not a number must not become an index.
    set(sanitizers -fsanitize=address,undefined,float-cast-overflow -fno-sanitize-recover=all)
    target_compile_options(covtrace_flags INTERFACE -fsanitize=fuzzer-no-link ${sanitizers} -fno-omit-frame-pointer)
    target_link_options(covtrace_flags INTERFACE ${sanitizers})
    target_compile_definitions(covtrace_flags INTERFACE FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION)
endif()
option(COVTRACE_WARNINGS_AS_ERRORS "Treat warnings as errors" ${PROJECT_IS_TOP_LEVEL})
if(COVTRACE_WARNINGS_AS_ERRORS)
    target_compile_options(covtrace_flags INTERFACE -Werror)
endif()

option(COVTRACE_PRECOMPILED_HEADERS "Read the headers of other libraries once per program, where many files include them" OFF)
# covtrace_precompile(TARGET <header> …): besides the usual headers of the standard library those that are named. The
# preset `dev` goes without, so that a file that forgets an include is found.
function(covtrace_precompile target)
    if(COVTRACE_PRECOMPILED_HEADERS)
        target_precompile_headers(${target} PRIVATE <algorithm> <array> <cmath> <filesystem> <fstream> <functional> <map>
                                  <memory> <optional> <random> <set> <sstream> <string> <variant> <vector> ${ARGN})
        # Without the time in it, the same header makes the same file, which compiler caches ask for.
        target_compile_options(${target} PRIVATE "$<$<CXX_COMPILER_ID:Clang>:SHELL:-Xclang -fno-pch-timestamp>")
    endif()
endfunction()

# covtrace_library(NAME SOURCES a.cpp … [DEPENDS covtrace_core …] [PRIVATE_DEPENDS embree …])
# One library per folder; DEPENDS are the arrows of docs/internals/architecture.md and nothing else.
function(covtrace_library name)
    cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS;PRIVATE_DEPENDS" ${ARGN})
    add_library(${name} STATIC ${ARG_SOURCES})
    target_link_libraries(${name} PUBLIC covtrace_flags ${ARG_DEPENDS} PRIVATE ${ARG_PRIVATE_DEPENDS})
    set_target_properties(${name} PROPERTIES POSITION_INDEPENDENT_CODE ON)
    # Nobody replaces the libraries' functions at run time: those of one file may be inlined into each other.
    target_compile_options(${name} PRIVATE -fno-semantic-interposition)
endfunction()

# covtrace_tests(NAME LABEL label SOURCES a.cpp … [DEPENDS …] [UNOPTIMISED]): a GoogleTest program, one ctest per test case.
function(covtrace_tests name)
    cmake_parse_arguments(ARG "UNOPTIMISED" "LABEL" "SOURCES;DEPENDS" ${ARGN})
    find_package(GTest REQUIRED)
    include(GoogleTest)
    add_executable(${name} ${ARG_SOURCES})
    target_link_libraries(${name} PRIVATE covtrace_flags ${ARG_DEPENDS} GTest::gtest_main)
    # GoogleTest's macros end in an else, which g++ asks for braces around.
    target_compile_options(${name} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-dangling-else>)
    set(headers covtrace_test_headers)
    if(ARG_UNOPTIMISED)
        target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-O0>)
        set(headers covtrace_unoptimised_test_headers)
    endif()
    if(COVTRACE_PRECOMPILED_HEADERS)
        target_precompile_headers(${name} REUSE_FROM ${headers})
    endif()
    # A fixed seed for rapidcheck: a failure is found again by running the test again.
    gtest_discover_tests(${name} DISCOVERY_MODE PRE_TEST PROPERTIES LABELS ${ARG_LABEL} TIMEOUT ${COVTRACE_TEST_SECONDS}
                         ENVIRONMENT RC_PARAMS=seed=20130531)
endfunction()
