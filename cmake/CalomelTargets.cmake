# Headers from outside that most files see are parsed once, for the libraries and for the tests, whatever is installed; every file still includes what it uses.
# Sources with options of their own do without: they could not read them.
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

# One static library a folder: calomel_library(mesh SOURCES a.cpp b.cpp LINKS calomel::base Eigen3::Eigen)
# More than half of the time of compiling is headers: half a dozen files are compiled as one, by everybody, for a name that two of them have shows only there.
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
  target_precompile_headers(calomel_${name} REUSE_FROM calomel_precompiled)
  set_target_properties(calomel_${name} PROPERTIES UNITY_BUILD ${CALOMEL_UNITY} UNITY_BUILD_BATCH_SIZE 6)
  set_property(GLOBAL APPEND PROPERTY CALOMEL_LIBRARIES calomel_${name})
endfunction()

# An inner loop compiled once for each instruction set, NAME_baseline.cpp and for x86-64 NAME_avx2.cpp and NAME_avx512.cpp, with these flags; the processor chooses
# at run time: calomel_kernels(kernels kernel -O3 ...) puts the sources into `kernels`.
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

# Test programs are compiled at -O1: what they compute is in the libraries, which are not.
set(CALOMEL_TEST_OPTIONS -Wall -Wextra -Wno-psabi -Wno-missing-field-initializers $<$<NOT:$<CONFIG:Debug>>:-O1>)

macro(calomel_precompiled_tests)
  find_package(GTest REQUIRED)
  calomel_precompiled(calomel_precompiled_tests OPTIONS -fPIE $<$<NOT:$<CONFIG:Debug>>:-O1> LINKS GTest::gtest GTest::gmock HEADERS <gmock/gmock.h> <gtest/gtest.h>)
  set_target_properties(calomel_precompiled_tests PROPERTIES POSITION_INDEPENDENT_CODE OFF)
endmacro()

# One test program a folder: calomel_test(unit_mesh SOURCES mesh_test.cpp LINKS calomel::mesh LABELS unit)
# SETS_UP names a fixture that another test requires: that one runs after all of these. ALONE lists files whose helpers have names that others have, too: each is compiled by itself.
function(calomel_test name)
  cmake_parse_arguments(ARG "" "SETS_UP" "SOURCES;ALONE;LINKS;LABELS" ${ARGN})
  list(APPEND ARG_SOURCES ${ARG_ALONE})
  add_executable(test_${name} ${ARG_SOURCES})
  target_compile_options(test_${name} PRIVATE ${CALOMEL_TEST_OPTIONS})
  foreach(source ${ARG_SOURCES})  # only where it is used: a path in the command makes a compiler cache useless for another copy of the tree
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

# The folders of the house that stand.
macro(calomel_folders)
  foreach(folder ${ARGN})
    if(EXISTS ${CMAKE_CURRENT_SOURCE_DIR}/${folder}/CMakeLists.txt)
      add_subdirectory(${folder})
    endif()
  endforeach()
endmacro()
