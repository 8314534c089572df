# Runs a reduced form of an example from beginning to end and checks its results:
#   calomel_example(02_box_slice CASE box_slice.toml TRUTH ../recorder/box_slice.truth.toml
#     SET campaign.runs=40 ... EXPECT --within impedance=3 ...)
# These are three tests, one after another: empty the output folder, `calomel study`, check_calibration.
function(calomel_example name)
  cmake_parse_arguments(ARG "" "CASE;TRUTH" "SET;EXPECT" ${ARGN})
  if(NOT CALOMEL_TESTS)
    return()
  endif()
  set(out ${CMAKE_CURRENT_BINARY_DIR}/${name}.out)
  set(overrides)
  foreach(override ${ARG_SET})
    list(APPEND overrides --set ${override})
  endforeach()
  add_test(NAME example_${name}_clean COMMAND ${CMAKE_COMMAND} -E rm -rf ${out})
  add_test(NAME example_${name}_study
    COMMAND calomel study ${CMAKE_CURRENT_SOURCE_DIR}/${ARG_CASE} --out ${out} --threads 2 ${overrides})
  add_test(NAME example_${name}_result
    COMMAND check_calibration ${out} ${CMAKE_CURRENT_SOURCE_DIR}/${ARG_TRUTH} ${ARG_EXPECT})
  set_tests_properties(example_${name}_clean PROPERTIES FIXTURES_SETUP ${name}_clean LABELS example)
  set_tests_properties(example_${name}_study PROPERTIES FIXTURES_REQUIRED ${name}_clean FIXTURES_SETUP ${name}_study
    LABELS example PROCESSORS 2 TIMEOUT 900)
  set_tests_properties(example_${name}_result PROPERTIES FIXTURES_REQUIRED ${name}_study LABELS example)
endfunction()
