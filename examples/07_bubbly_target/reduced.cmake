# The example on the first 0.2 ms of its records, with the explanation fitted that leads to first order, in 1100 runs or a round more, from the records to the expected numbers.
include("${CMAKE_CURRENT_LIST_DIR}/../steps.cmake")
file(REMOVE_RECURSE "${WORK}")
file(MAKE_DIRECTORY "${WORK}")
file(COPY "${CMAKE_CURRENT_LIST_DIR}/bubbly_target.toml" "${CMAKE_CURRENT_LIST_DIR}/recordings.nc" DESTINATION "${WORK}")
set(case "${WORK}/bubbly_target.toml" --set time.end=0.0002)
execute_process(COMMAND "${CALOMEL}" diagnose ${case} --set diagnosis.leaders=1 --set diagnosis.pairs=false --set diagnosis.max_runs=1100 RESULT_VARIABLE status)
if(NOT status EQUAL 0 AND NOT status EQUAL 4)  # 4: the runs are spent before the fit of what is named stands
  message(FATAL_ERROR "exit status ${status} of diagnose")
endif()
execute_process(COMMAND "${PROGRAM}" numbers "${WORK}/bubbly_target.out/diagnosis.json" OUTPUT_VARIABLE named OUTPUT_STRIP_TRAILING_WHITESPACE)
string(REPLACE "\n" ";" named "${named}")
# ENC alone, on fewer runs, the fewest with bubbles, whose runs are dear: the README has SPE and all runs, too.
step("${CALOMEL}" calibrate ${case} --method enc --set campaign.runs=100 --set emulator.rounds=2)
step("${CALOMEL}" calibrate ${case} --method enc --out "${WORK}/with" --set campaign.runs=60 --set emulator.rounds=2 ${named})
step("${PROGRAM}" table "${WORK}/bubbly_target.out" "${WORK}/with" "${CMAKE_CURRENT_LIST_DIR}/expected_reduced.csv")
