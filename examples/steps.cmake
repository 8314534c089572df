# Functions that the scripts of the examples share.

# Runs a command and ends the script with an error if the command fails.
function(step)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "exit status ${status}: ${ARGN}")
  endif()
endfunction()

# Sets `out` to the measured record: the file that the environment's `variable` names, else `default` in ../shared. Where there is none, `out` is empty and a
# message begins with SKIPPED, by which ctest reports the test as skipped; `hint` is what the variable should name.
function(find_record out variable default hint)
  set(record "$ENV{${variable}}")
  if(NOT record)
    set(record "${default}")
  endif()
  if(NOT EXISTS "${record}")
    message("SKIPPED, absent from ../shared: ${record}; set ${variable} to ${hint}")
    set(record "")
  endif()
  set(${out} "${record}" PARENT_SCOPE)
endfunction()
