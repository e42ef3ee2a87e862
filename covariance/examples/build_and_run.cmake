# cmake -D COMPILER=… -D SOURCE=… -D INCLUDE=… -D FOLDER=… -P build_and_run.cmake: builds the example
# as the README says and runs it in FOLDER, where its pictures must appear.
file(REMOVE_RECURSE ${FOLDER})
file(MAKE_DIRECTORY ${FOLDER})
execute_process(COMMAND ${COMPILER} -std=c++20 -O2 -Wall -Wextra -Werror -I ${INCLUDE} ${SOURCE} -o path_tracer
                WORKING_DIRECTORY ${FOLDER} COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ./path_tracer WORKING_DIRECTORY ${FOLDER} COMMAND_ERROR_IS_FATAL ANY)
foreach(picture plain filtered reference density filters)
    file(SIZE ${FOLDER}/${picture}.png bytes)
    if(bytes LESS 1000)
        message(FATAL_ERROR "${picture}.png is too small")
    endif()
endforeach()
