# Functions shared by the packages. Functions only: a variable set here would be lost to sibling
# packages in one catkin_make run.
#
# A package is built by catkin when CATKIN_DEVEL_PREFIX is defined, else by plain CMake from the
# project's root. ROS code is built by catkin only.
#
# POLYFLY_BUILT, the folder of a plain build, POLYFLY_BUILT_LIBRARIES, the names of its libraries, and POLYFLY_BIN_DIR,
# the folder of its tools, let catkin use what is built there; without them it builds all itself.

# polyfly_library(NAME [UNITY] SOURCES file... [LINK target...] [PRIVATE target...] [INCLUDE folder...]
#     [PRIVATE_INCLUDE folder...] [INSTALL header...])
#   A library with the package's include/ folder, and others of the package. UNITY: see polyfly_unity. INSTALL: `cmake --install`
#   of the plain build offers it, with these public headers or folders of headers (install.cmake); without any, other
#   libraries need it, but no user includes it.
function(polyfly_library name)
  cmake_parse_arguments(ARG "UNITY" "" "SOURCES;LINK;PRIVATE;INCLUDE;PRIVATE_INCLUDE;INSTALL" ${ARGN})
  list(TRANSFORM ARG_INCLUDE PREPEND "${CMAKE_CURRENT_SOURCE_DIR}/")
  list(TRANSFORM ARG_PRIVATE_INCLUDE PREPEND "${CMAKE_CURRENT_SOURCE_DIR}/")
  set(headers "${CMAKE_CURRENT_SOURCE_DIR}/include" ${ARG_INCLUDE})
  if(name IN_LIST POLYFLY_BUILT_LIBRARIES)
    add_library(${name} STATIC IMPORTED GLOBAL)
    set_target_properties(${name} PROPERTIES IMPORTED_LOCATION "${POLYFLY_BUILT}/lib/lib${name}.a")
    target_compile_features(${name} INTERFACE cxx_std_17)
    target_include_directories(${name} INTERFACE ${headers})
    target_link_libraries(${name} INTERFACE ${ARG_LINK})
    foreach(library ${ARG_PRIVATE})
      target_link_libraries(${name} INTERFACE $<LINK_ONLY:${library}>)
    endforeach()
    return()
  endif()
  add_library(${name} ${ARG_SOURCES})
  target_compile_features(${name} PUBLIC cxx_std_17)
  set_target_properties(${name} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  target_include_directories(${name}
    PUBLIC "$<BUILD_INTERFACE:${headers}>" $<INSTALL_INTERFACE:include/polyfly>
    PRIVATE "$<BUILD_INTERFACE:${ARG_PRIVATE_INCLUDE}>")
  target_link_libraries(${name} PUBLIC ${ARG_LINK} PRIVATE ${ARG_PRIVATE})
  polyfly_warnings(${name})
  polyfly_precompiled(${name} library)
  if(ARG_UNITY)
    polyfly_unity(${name})
  endif()
  if(DEFINED CATKIN_DEVEL_PREFIX)
    install(TARGETS ${name} ARCHIVE DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION} LIBRARY DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION})
    if(IS_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR}/include)
      install(DIRECTORY include/ DESTINATION include)
    endif()
  else()
    set_target_properties(${name} PROPERTIES ARCHIVE_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/lib")
    if(TARGET tools)
      add_dependencies(tools ${name})
    endif()
    if(ARG_INSTALL OR "INSTALL" IN_LIST ARG_KEYWORDS_MISSING_VALUES)
      polyfly_install_library(${name} HEADERS ${ARG_INSTALL} FOLDERS ${headers} LINK ${ARG_LINK} ${ARG_PRIVATE})
    endif()
  endif()
endfunction()

# polyfly_tool(NAME [UNITY] [INSTALL] SOURCES file... [LINK target...] [PRIVATE_INCLUDE folder...])
#   A command-line tool; plain CMake leaves it in the preset's bin folder, catkin where rosrun looks. INSTALL: so does
#   `cmake --install` of the plain build.
function(polyfly_tool name)
  cmake_parse_arguments(ARG "UNITY;INSTALL" "" "SOURCES;LINK;PRIVATE_INCLUDE" ${ARGN})
  if(DEFINED POLYFLY_BUILT AND DEFINED POLYFLY_BIN_DIR AND EXISTS "${POLYFLY_BIN_DIR}/${name}")
    set(folder "${CATKIN_DEVEL_PREFIX}/lib/${PROJECT_NAME}")
    file(MAKE_DIRECTORY "${folder}")
    file(CREATE_LINK "${POLYFLY_BIN_DIR}/${name}" "${folder}/${name}" SYMBOLIC)
    return()
  endif()
  add_executable(${name}_tool ${ARG_SOURCES})
  target_compile_features(${name}_tool PRIVATE cxx_std_17)
  target_include_directories(${name}_tool PRIVATE ${ARG_PRIVATE_INCLUDE})
  target_link_libraries(${name}_tool PRIVATE ${ARG_LINK})
  set_target_properties(${name}_tool PROPERTIES OUTPUT_NAME ${name})
  if(DEFINED POLYFLY_BIN_DIR)
    set_target_properties(${name}_tool PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${POLYFLY_BIN_DIR})
  endif()
  if(TARGET tools)
    add_dependencies(tools ${name}_tool)
  endif()
  if(DEFINED CATKIN_DEVEL_PREFIX)
    install(TARGETS ${name}_tool RUNTIME DESTINATION lib/${PROJECT_NAME})
  elseif(ARG_INSTALL)
    polyfly_install_tool(${name}_tool)
  endif()
  polyfly_warnings(${name}_tool)
  polyfly_precompiled(${name}_tool tool)
  if(ARG_UNITY)
    polyfly_unity(${name}_tool)
  endif()
endfunction()

# polyfly_test(NAME [THREADS] [ALLOCATIONS] SOURCES file... [LINK target...])
#   A GoogleTest program, run by ctest, with the headers of test/shared and those that the package keeps in src/. Under catkin the same tests are left to the
#   plain build. With THREADS it starts threads, and is also run under the thread sanitizer; with ALLOCATIONS the heap
#   counts what it is asked for (allocations.hpp).
function(polyfly_test name)
  if(DEFINED CATKIN_DEVEL_PREFIX OR NOT BUILD_TESTING)
    return()
  endif()
  cmake_parse_arguments(ARG "THREADS;ALLOCATIONS" "" "SOURCES;LINK" ${ARGN})
  find_package(GTest REQUIRED)
  set(shared "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/../test/shared")
  if(ARG_ALLOCATIONS)
    list(APPEND ARG_SOURCES "${shared}/allocations.cpp")
  endif()
  add_executable(${name} ${ARG_SOURCES})
  target_compile_features(${name} PRIVATE cxx_std_17)
  target_include_directories(${name} PRIVATE "${shared}")
  if(IS_DIRECTORY "${CMAKE_CURRENT_SOURCE_DIR}/src")
    target_include_directories(${name} PRIVATE src)
  endif()
  target_link_libraries(${name} PRIVATE ${ARG_LINK} GTest::gtest GTest::gtest_main)
  polyfly_warnings(${name})
  polyfly_test_options(${name})
  polyfly_precompiled(${name} test)
  add_test(NAME ${name} COMMAND ${name})
  set_tests_properties(${name} PROPERTIES ENVIRONMENT "POLYFLY_ROOT=${CMAKE_SOURCE_DIR}")
  if(ARG_THREADS)
    set_tests_properties(${name} PROPERTIES LABELS threads)
    if(TARGET threaded_tests)
      add_dependencies(threaded_tests ${name})
    endif()
  endif()
endfunction()

# polyfly_test_library(NAME SOURCES file... [LINK target...])
#   What several tests share, compiled once, with the headers beside its sources.
function(polyfly_test_library name)
  if(DEFINED CATKIN_DEVEL_PREFIX OR NOT BUILD_TESTING)
    return()
  endif()
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  find_package(GTest REQUIRED)
  add_library(${name} STATIC ${ARG_SOURCES})
  target_compile_features(${name} PUBLIC cxx_std_17)
  target_include_directories(${name} PRIVATE "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/../test/shared")
  foreach(source ${ARG_SOURCES})
    get_filename_component(folder "${source}" DIRECTORY)
    target_include_directories(${name} PUBLIC "${CMAKE_CURRENT_SOURCE_DIR}/${folder}")
  endforeach()
  target_link_libraries(${name} PUBLIC ${ARG_LINK} GTest::gtest)
  polyfly_warnings(${name})
  polyfly_test_options(${name})
  polyfly_precompiled(${name} test)
endfunction()

# polyfly_find_cli11(), polyfly_find_json()
#   CLI11::CLI11 and nlohmann_json::nlohmann_json, for the whole build.
function(polyfly_find_cli11)
  polyfly_find_headers(CLI11 2.1 cli11 cli11_2.4.1+ds.orig.tar.xz
    0b8fbf2398875f15f30a675c7f412123a2aaa38df2863e991de72004fd5f1292)
endfunction()

function(polyfly_find_json)
  polyfly_find_headers(nlohmann_json 3.9 nlohmann-json3 nlohmann-json3_3.11.3.orig.tar.gz
    0d8ef5af7f9794e3263480193c491549b2ba6cc74bb018906202ada498a79406)
endfunction()

# polyfly_find_headers(PACKAGE VERSION SOURCE ARCHIVE SHA256)
#   PACKAGE::PACKAGE of the system, or, where it has none that is new enough, made from the headers of the archive from which
#   Debian 13 builds its package SOURCE. In the environment, POLYFLY_ARCHIVES may name another place that has
#   c/cli11/ARCHIVE and the like: pool/main of a mirror, or a folder.
function(polyfly_find_headers package version source archive sha256)
  set(target ${package}::${package})
  if(TARGET ${target})
    return()
  endif()
  find_package(${package} ${version} QUIET)
  if(TARGET ${target})
    set_target_properties(${target} PROPERTIES IMPORTED_GLOBAL TRUE)
    return()
  endif()
  set(archives "$ENV{POLYFLY_ARCHIVES}")
  if(NOT archives)
    set(archives "http://snapshot.debian.org/archive/debian/20250901T000000Z/pool/main")
  endif()
  string(SUBSTRING ${source} 0 1 initial)
  set(folder "${CMAKE_BINARY_DIR}/${source}")
  include(FetchContent)
  FetchContent_Populate(${source} QUIET
    URL "${archives}/${initial}/${source}/${archive}" URL_HASH SHA256=${sha256}
    SOURCE_DIR "${folder}/source" BINARY_DIR "${folder}/build" SUBBUILD_DIR "${folder}/download")
  add_library(${target} INTERFACE IMPORTED GLOBAL)
  target_include_directories(${target} INTERFACE "${folder}/source/include")
endfunction()

# polyfly_warnings(TARGET): the project's warnings, as errors where POLYFLY_WERROR is on (.ci/run, ./run lint).
function(polyfly_warnings name)
  target_compile_options(${name} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor)
  if(POLYFLY_WERROR)
    target_compile_options(${name} PRIVATE -Werror)
  endif()
endfunction()

# polyfly_test_options(TARGET): tests are compiled more often than run.
function(polyfly_test_options name)
  target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-O1>)
endfunction()

# polyfly_unity(TARGET)
#   Compiles up to eight files of a target together, so that the templates that they share are compiled once. Names
#   without linkage must differ within such a target. The clang preset compiles each file alone.
function(polyfly_unity name)
  if(NOT CMAKE_DISABLE_PRECOMPILE_HEADERS)
    set_target_properties(${name} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 8)
  endif()
endfunction()

# polyfly_precompiled(TARGET library|tool|test)
#   The plain build parses once what most files include: an object library for each kind of target, whose options are
#   the same, carries the headers. Each file still includes what it uses: catkin and the clang preset build without, and
#   so does a compiler cache, which saves more and cannot look through precompiled headers.
function(polyfly_precompiled name kind)
  if(DEFINED CATKIN_DEVEL_PREFIX OR CMAKE_DISABLE_PRECOMPILE_HEADERS OR CMAKE_CXX_COMPILER_LAUNCHER)
    return()
  endif()
  set(carrier precompiled_for_${kind})
  if(NOT TARGET ${carrier})
    set(source "${CMAKE_BINARY_DIR}/${carrier}.cpp")
    if(NOT EXISTS "${source}")
      file(WRITE "${source}" "")
    endif()
    add_library(${carrier} OBJECT "${source}")
    target_compile_features(${carrier} PRIVATE cxx_std_17)
    find_package(Eigen3 REQUIRED)
    target_link_libraries(${carrier} PRIVATE Eigen3::Eigen)
    polyfly_warnings(${carrier})
    if(kind STREQUAL library)
      set_target_properties(${carrier} PROPERTIES POSITION_INDEPENDENT_CODE ON)
    elseif(kind STREQUAL test)
      target_link_libraries(${carrier} PRIVATE GTest::gtest)
      polyfly_test_options(${carrier})
      target_precompile_headers(${carrier} PRIVATE <gtest/gtest.h>)
    endif()
    target_precompile_headers(${carrier} PRIVATE
      <algorithm> <array> <cmath> <cstdint> <fstream> <functional> <limits> <map> <memory> <optional> <random> <set>
      <sstream> <string> <utility> <vector> <Eigen/Dense>)
  endif()
  target_precompile_headers(${name} REUSE_FROM ${carrier})
endfunction()

# polyfly_import(PACKAGE...)
#   Makes the libraries of other packages of the project usable as targets of the same names. One build of
#   the whole project (plain CMake, catkin_make) has them already; an isolated catkin build finds them in
#   the exported configuration of the package.
function(polyfly_import)
  if(NOT CMAKE_SOURCE_DIR STREQUAL PROJECT_SOURCE_DIR)
    return()
  endif()
  foreach(package ${ARGN})
    find_package(${package} REQUIRED)
    foreach(library ${${package}_LIBRARIES})
      # Only the package's own libraries: what it depends on is found under its own name.
      if("${library}" MATCHES "^${${package}_PREFIX}/lib/lib([^/.]+)")
        set(name ${CMAKE_MATCH_1})
        if(NOT TARGET ${name})
          add_library(${name} INTERFACE IMPORTED GLOBAL)
          target_include_directories(${name} SYSTEM INTERFACE ${${package}_INCLUDE_DIRS})
          target_link_libraries(${name} INTERFACE ${${package}_LIBRARIES})
        endif()
      endif()
    endforeach()
  endforeach()
endfunction()
