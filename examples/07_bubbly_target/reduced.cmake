# Runs the example on the first 0.2 ms of its records and compares the numbers with the expected ones. The diagnosis fits only the candidate that leads the screening,
# in 1100 runs or one round more.
include("${CMAKE_CURRENT_LIST_DIR}/../steps.cmake")
file(REMOVE_RECURSE "${WORK}")
file(MAKE_DIRECTORY "${WORK}")
file(COPY "${CMAKE_CURRENT_LIST_DIR}/bubbly_target.toml" "${CMAKE_CURRENT_LIST_DIR}/recordings.nc" DESTINATION "${WORK}")
set(case "${WORK}/bubbly_target.toml" --set time.end=0.0002)
execute_process(COMMAND "${CALOMEL}" diagnose ${case} --set diagnosis.leaders=1 --set diagnosis.pairs=false --set diagnosis.max_runs=1100 RESULT_VARIABLE status)
if(NOT status EQUAL 0 AND NOT status EQUAL 4)  # 4: the runs are used up before the fit of the named mechanism has converged
  message(FATAL_ERROR "exit status ${status} of diagnose")
endif()
execute_process(COMMAND "${PROGRAM}" numbers "${WORK}/bubbly_target.out/diagnosis.json" OUTPUT_VARIABLE named OUTPUT_STRIP_TRAILING_WHITESPACE)
string(REPLACE "\n" ";" named "${named}")
# ENC alone on fewer runs, fewest with bubbles, whose runs are expensive. The README has SPE and all runs, too.
step("${CALOMEL}" calibrate ${case} --method enc --set campaign.runs=100 --set emulator.rounds=2)
step("${CALOMEL}" calibrate ${case} --method enc --out "${WORK}/with" --set campaign.runs=60 --set emulator.rounds=2 ${named})
step("${PROGRAM}" table "${WORK}/bubbly_target.out" "${WORK}/with" "${CMAKE_CURRENT_LIST_DIR}/expected_reduced.csv")
