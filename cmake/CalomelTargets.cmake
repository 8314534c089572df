# Headers of other libraries that most files include are parsed once, for the libraries and for the tests; every file still includes what it uses. A precompiled
# header serves only files that are compiled with its own options, so that sources with further options do without.
function(calomel_precompiled name)
  cmake_parse_arguments(ARG "" "" "OPTIONS;LINKS;HEADERS" ${ARGN})
  if(NOT EXISTS ${CMAKE_BINARY_DIR}/${name}.cpp)  # so that configuring again compiles nothing
    file(WRITE ${CMAKE_BINARY_DIR}/${name}.cpp "")
  endif()
  add_library(${name} OBJECT ${CMAKE_BINARY_DIR}/${name}.cpp)
  target_link_libraries(${name} PRIVATE fmt::fmt Eigen3::Eigen ${ARG_LINKS})
  target_compile_features(${name} PRIVATE cxx_std_20)
  target_compile_options(${name} PRIVATE -Wall -Wextra -Wno-psabi -Wno-missing-field-initializers ${ARG_OPTIONS})
  target_precompile_headers(${name} PRIVATE
    <algorithm> <array> <cmath> <filesystem> <fstream> <functional> <limits> <map> <memory> <mutex> <numeric> <optional> <set> <span> <sstream>
    <string> <vector> <fmt/format.h> <Eigen/Core> ${ARG_HEADERS})
endfunction()
calomel_precompiled(calomel_precompiled)

# Folders whose loops take most of a run (CALOMEL_HOT) are compiled with the options of the build type. The others are compiled as -O1 with the inlining of -O2,
# which takes a quarter less time than -O2 or -O3 (docs/benchmarks/compile_times.md). The arithmetic is the same: none of these options lets GCC change the result
# of a floating-point expression.
set(CALOMEL_LIGHT_OPTIONS $<$<AND:$<CXX_COMPILER_ID:GNU>,$<CONFIG:Release>>:-O1 -finline-functions -finline-small-functions -fpartial-inlining>)
calomel_precompiled(calomel_precompiled_light OPTIONS ${CALOMEL_LIGHT_OPTIONS})

# calomel_library(mesh SOURCES a.cpp b.cpp LINKS calomel::base Eigen3::Eigen) makes one static library of a folder.
# Everybody compiles the sources of a folder (of each subfolder, if there are any) as one file, because every file by itself compiles the same headers and inline
# functions again. So names of anonymous namespaces differ within a folder. A folder sets CALOMEL_AT_MOST to the number of sources that make one file.
function(calomel_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINKS;PRIVATE_LINKS" ${ARGN})
  add_library(calomel_${name} STATIC ${ARG_SOURCES})
  add_library(calomel::${name} ALIAS calomel_${name})
  set_target_properties(calomel_${name} PROPERTIES EXPORT_NAME ${name})
  target_include_directories(calomel_${name} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/calomel>)
  target_compile_features(calomel_${name} PUBLIC cxx_std_20)
  target_compile_options(calomel_${name} PRIVATE -Wall -Wextra -Wno-psabi -Wno-missing-field-initializers)
  target_link_libraries(calomel_${name} PUBLIC ${ARG_LINKS} PRIVATE ${ARG_PRIVATE_LINKS})
  if(CALOMEL_HOT)
    target_precompile_headers(calomel_${name} REUSE_FROM calomel_precompiled)
  else()
    target_compile_options(calomel_${name} PRIVATE ${CALOMEL_LIGHT_OPTIONS})
    target_precompile_headers(calomel_${name} REUSE_FROM calomel_precompiled_light)
  endif()
  set_target_properties(calomel_${name} PROPERTIES UNITY_BUILD ${CALOMEL_UNITY} UNITY_BUILD_MODE GROUP)
  calomel_unity_groups(${ARG_SOURCES})
  set_property(GLOBAL APPEND PROPERTY CALOMEL_LIBRARIES calomel_${name})
endfunction()

# Groups the sources that are compiled as one file: those of one subfolder, at most CALOMEL_AT_MOST of them.
function(calomel_unity_groups)
  if(NOT CALOMEL_AT_MOST)
    set(CALOMEL_AT_MOST 1000)
  endif()
  foreach(source ${ARGN})
    get_source_file_property(alone ${source} SKIP_UNITY_BUILD_INCLUSION)
    get_source_file_property(options ${source} COMPILE_OPTIONS)
    if(alone OR options)
      continue()
    endif()
    get_filename_component(folder ${source} DIRECTORY)
    string(MAKE_C_IDENTIFIER "of_${folder}" group)
    if(NOT DEFINED count_${group})
      set(count_${group} 0)
    endif()
    math(EXPR number "${count_${group}} / ${CALOMEL_AT_MOST}")
    math(EXPR count_${group} "${count_${group}} + 1")
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${group}_${number})
  endforeach()
endfunction()

# calomel_kernels(kernels kernel -O3 ...) sets `kernels` to the sources of an inner loop that is compiled once for each instruction set with these flags:
# NAME_baseline.cpp and, for x86-64, NAME_avx2.cpp and NAME_avx512.cpp. The program chooses by the processor at run time.
function(calomel_kernels sources name)
  if(CMAKE_CXX_FLAGS MATCHES "-fsanitize")  # checked kernels at -O3 take a quarter of an hour each
    list(REMOVE_ITEM ARGN -O3)
  endif()
  set(all ${name}_baseline.cpp)
  set_source_files_properties(${name}_baseline.cpp PROPERTIES SKIP_PRECOMPILE_HEADERS ON COMPILE_OPTIONS "${ARGN}")
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
    list(APPEND all ${name}_avx2.cpp ${name}_avx512.cpp)
    set_source_files_properties(${name}_avx2.cpp PROPERTIES SKIP_PRECOMPILE_HEADERS ON COMPILE_OPTIONS "${ARGN};-mavx2;-mfma")
    set_source_files_properties(${name}_avx512.cpp PROPERTIES SKIP_PRECOMPILE_HEADERS ON COMPILE_OPTIONS
      "${ARGN};-mavx2;-mfma;-mavx512f;-mavx512vl;-mavx512dq;-mprefer-vector-width=512")
  endif()
  set(${sources} ${all} PARENT_SCOPE)
endfunction()

# Test programs are compiled at -O1, because the libraries do their computations.
set(CALOMEL_TEST_OPTIONS -Wall -Wextra -Wno-psabi -Wno-missing-field-initializers $<$<NOT:$<CONFIG:Debug>>:-O1>)

macro(calomel_precompiled_tests)
  find_package(GTest REQUIRED)
  calomel_precompiled(calomel_precompiled_tests OPTIONS -fPIE $<$<NOT:$<CONFIG:Debug>>:-O1> LINKS GTest::gtest GTest::gmock HEADERS <gmock/gmock.h> <gtest/gtest.h>)
  set_target_properties(calomel_precompiled_tests PROPERTIES POSITION_INDEPENDENT_CODE OFF)
endmacro()

# calomel_test(unit_mesh SOURCES mesh_test.cpp LINKS calomel::mesh LABELS unit) makes one test program of a folder.
# SETS_UP names a fixture that another test requires, which then runs after all of these. ALONE lists files that have names of helpers in common with other files;
# each of them is compiled by itself. Half a dozen of the others are compiled as one. A test that calls GTEST_SKIP is reported by ctest as skipped.
function(calomel_test name)
  cmake_parse_arguments(ARG "" "SETS_UP" "SOURCES;ALONE;LINKS;LABELS" ${ARGN})
  list(APPEND ARG_SOURCES ${ARG_ALONE})
  add_executable(test_${name} ${ARG_SOURCES})
  target_compile_options(test_${name} PRIVATE ${CALOMEL_TEST_OPTIONS})
  foreach(source ${ARG_SOURCES})  # only in files that use it, because a compiler cache cannot serve commands with a path for another copy of the tree
    file(STRINGS ${source} uses REGEX CALOMEL_SOURCE_DIR)
    if(uses)
      set_property(SOURCE ${source} APPEND PROPERTY COMPILE_DEFINITIONS CALOMEL_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
      set_source_files_properties(${source} PROPERTIES SKIP_PRECOMPILE_HEADERS ON)
    endif()
  endforeach()
  target_link_libraries(test_${name} PRIVATE ${ARG_LINKS} GTest::gtest GTest::gmock GTest::gtest_main)
  target_precompile_headers(test_${name} REUSE_FROM calomel_precompiled_tests)
  set_target_properties(test_${name} PROPERTIES UNITY_BUILD ${CALOMEL_UNITY} UNITY_BUILD_BATCH_SIZE 6)
  set_source_files_properties(${ARG_ALONE} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  include(GoogleTest)
  set(properties LABELS "${ARG_LABELS}")
  if(ARG_SETS_UP)
    list(APPEND properties FIXTURES_SETUP ${ARG_SETS_UP})
  endif()
  gtest_discover_tests(test_${name} PROPERTIES ${properties} DISCOVERY_TIMEOUT 60)
endfunction()

# Adds the folders that exist.
macro(calomel_folders)
  foreach(folder ${ARGN})
    if(EXISTS ${CMAKE_CURRENT_SOURCE_DIR}/${folder}/CMakeLists.txt)
      add_subdirectory(${folder})
    endif()
  endforeach()
endmacro()
