# With CALOMEL_PRECOMPILED_HEADERS the heavy headers from outside are parsed once for all libraries; every file still includes what it uses. Sources
# with options of their own do without: they could not read them.
if(CALOMEL_PRECOMPILED_HEADERS)
  file(WRITE ${CMAKE_BINARY_DIR}/precompiled.cpp "")
  add_library(calomel_precompiled OBJECT ${CMAKE_BINARY_DIR}/precompiled.cpp)
  target_link_libraries(calomel_precompiled PRIVATE fmt::fmt nlohmann_json::nlohmann_json Eigen3::Eigen)
  target_compile_features(calomel_precompiled PRIVATE cxx_std_20)
  target_compile_options(calomel_precompiled PRIVATE -Wall -Wextra -Wno-psabi -Wno-missing-field-initializers)
  target_precompile_headers(calomel_precompiled PRIVATE
    <algorithm> <array> <cmath> <filesystem> <fstream> <functional> <limits> <map> <memory> <mutex> <numeric> <optional> <set> <span> <sstream>
    <string> <vector> <fmt/format.h> <nlohmann/json.hpp> <Eigen/Dense>)
endif()

# One static library a folder: calomel_library(mesh SOURCES a.cpp b.cpp LINKS calomel::base Eigen3::Eigen)
function(calomel_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINKS" ${ARGN})
  add_library(calomel_${name} STATIC ${ARG_SOURCES})
  add_library(calomel::${name} ALIAS calomel_${name})
  set_target_properties(calomel_${name} PROPERTIES EXPORT_NAME ${name})
  target_include_directories(calomel_${name} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/calomel>)
  target_compile_features(calomel_${name} PUBLIC cxx_std_20)
  target_compile_options(calomel_${name} PRIVATE -Wall -Wextra -Wno-psabi -Wno-missing-field-initializers)
  target_link_libraries(calomel_${name} PUBLIC ${ARG_LINKS})
  if(CALOMEL_PRECOMPILED_HEADERS)
    target_precompile_headers(calomel_${name} REUSE_FROM calomel_precompiled)
  endif()
  if(CALOMEL_UNITY)
    set_target_properties(calomel_${name} PROPERTIES UNITY_BUILD ON)
    # GCC collects its garbage at 128 MiB unless told: with these sources a tenth of the time.
    target_compile_options(calomel_${name} PRIVATE $<$<CXX_COMPILER_ID:GNU>:--param=ggc-min-heapsize=524288>)
  endif()
  set_property(GLOBAL APPEND PROPERTY CALOMEL_LIBRARIES calomel_${name})
endfunction()

# One test program a folder: calomel_test(unit_mesh SOURCES mesh_test.cpp LINKS calomel::mesh LABELS unit)
# SETS_UP names a fixture that another test requires: that one runs after all of these.
function(calomel_test name)
  cmake_parse_arguments(ARG "" "SETS_UP" "SOURCES;LINKS;LABELS" ${ARGN})
  add_executable(test_${name} ${ARG_SOURCES})
  target_compile_options(test_${name} PRIVATE -Wall -Wextra -Wno-psabi -Wno-missing-field-initializers)
  target_compile_definitions(test_${name} PRIVATE CALOMEL_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  target_link_libraries(test_${name} PRIVATE ${ARG_LINKS} GTest::gtest GTest::gmock GTest::gtest_main)
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
