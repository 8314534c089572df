# Installs the build, then configures, builds and runs a program that uses find_package(calomel) and nothing else.
function(step)
  execute_process(COMMAND ${ARGV} RESULT_VARIABLE status OUTPUT_VARIABLE said ERROR_VARIABLE said)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "exit status ${status}: ${ARGV}\n${said}")
  endif()
  set(said "${said}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${WORK})
step(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix)
step(${CMAKE_COMMAND} -S ${CONSUMER} -B ${WORK}/build -DCMAKE_PREFIX_PATH=${WORK}/prefix -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_COMPILER=${COMPILER})
step(${CMAKE_COMMAND} --build ${WORK}/build)
step(${WORK}/build/consumer ${CASE})
message("${said}")
step(${WORK}/prefix/bin/calomel --version)
# The reference generator is installed where the installed program looks for it.
step(${WORK}/prefix/bin/calomel challenge make --seed 1 --out ${WORK}/suite --none 1 --single 0 --outside 0 --sensor 0 --pair 0 --grid 0.5e-3)
