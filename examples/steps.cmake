# What the scripts of the examples share.

# Runs a command; the script ends where it fails.
function(step)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "exit status ${status}: ${ARGN}")
  endif()
endfunction()

# Sets `out` to the measured record: the file that the environment's `variable` names, else `default`. Where there is none `out` is empty and a message begins with SKIPPED;
# `hint` says what the variable is to be set to.
function(find_record out variable default hint)
  set(record "$ENV{${variable}}")
  if(NOT record)
    set(record "${default}")
  endif()
  if(NOT EXISTS "${record}")
    message("SKIPPED: the measured record ${record} is not there; set ${variable} to ${hint}")
    set(record "")
  endif()
  set(${out} "${record}" PARENT_SCOPE)
endfunction()
