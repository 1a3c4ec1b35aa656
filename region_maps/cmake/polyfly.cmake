# Functions shared by the packages. Functions only: a variable set here would be lost to sibling
# packages in one catkin_make run.
#
# A package is built by catkin when CATKIN_DEVEL_PREFIX is defined, else by plain CMake from the
# project's root. ROS code is built by catkin only.
#
# POLYFLY_BUILT, the folder of a plain build, and POLYFLY_BIN_DIR, that of its tools, let catkin use what is built
# there; without them it builds all itself.

# polyfly_library(NAME SOURCES file... [LINK target...] [PRIVATE target...] [INCLUDE folder...] [PRIVATE_INCLUDE folder...])
#   A library with the package's include/ folder, and others of the package.
function(polyfly_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK;PRIVATE;INCLUDE;PRIVATE_INCLUDE" ${ARGN})
  list(TRANSFORM ARG_INCLUDE PREPEND "${CMAKE_CURRENT_SOURCE_DIR}/")
  list(TRANSFORM ARG_PRIVATE_INCLUDE PREPEND "${CMAKE_CURRENT_SOURCE_DIR}/")
  set(headers "${CMAKE_CURRENT_SOURCE_DIR}/include" ${ARG_INCLUDE})
  if(DEFINED POLYFLY_BUILT AND EXISTS "${POLYFLY_BUILT}/lib/lib${name}.a")
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
    PUBLIC "$<BUILD_INTERFACE:${headers}>" $<INSTALL_INTERFACE:include>
    PRIVATE "$<BUILD_INTERFACE:${ARG_PRIVATE_INCLUDE}>")
  target_link_libraries(${name} PUBLIC ${ARG_LINK} PRIVATE ${ARG_PRIVATE})
  polyfly_warnings(${name})
  if(DEFINED CATKIN_DEVEL_PREFIX)
    install(TARGETS ${name} ARCHIVE DESTINATION lib LIBRARY DESTINATION lib)
    if(IS_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR}/include)
      install(DIRECTORY include/ DESTINATION include)
    endif()
  else()
    set_target_properties(${name} PROPERTIES ARCHIVE_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/lib")
    if(TARGET tools)
      add_dependencies(tools ${name})
    endif()
  endif()
endfunction()

# polyfly_tool(NAME SOURCES file... [LINK target...])
#   A command-line tool; plain CMake leaves it in the preset's bin folder, catkin where rosrun looks.
function(polyfly_tool name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  if(DEFINED POLYFLY_BUILT AND DEFINED POLYFLY_BIN_DIR AND EXISTS "${POLYFLY_BIN_DIR}/${name}")
    set(folder "${CATKIN_DEVEL_PREFIX}/lib/${PROJECT_NAME}")
    file(MAKE_DIRECTORY "${folder}")
    file(CREATE_LINK "${POLYFLY_BIN_DIR}/${name}" "${folder}/${name}" SYMBOLIC)
    return()
  endif()
  add_executable(${name}_tool ${ARG_SOURCES})
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
  endif()
  polyfly_warnings(${name}_tool)
endfunction()

# polyfly_test(NAME [THREADS] SOURCES file... [LINK target...])
#   A GoogleTest program, run by ctest. Under catkin the same tests are left to the plain build. With
#   THREADS it starts threads, and is also run under the thread sanitizer.
function(polyfly_test name)
  if(DEFINED CATKIN_DEVEL_PREFIX OR NOT BUILD_TESTING)
    return()
  endif()
  cmake_parse_arguments(ARG "THREADS" "" "SOURCES;LINK" ${ARGN})
  find_package(GTest REQUIRED)
  add_executable(${name} ${ARG_SOURCES})
  target_include_directories(${name} PRIVATE "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/../test/shared")
  target_link_libraries(${name} PRIVATE ${ARG_LINK} GTest::gtest GTest::gtest_main)
  polyfly_warnings(${name})
  target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-O1>)  # compiled more often than run
  add_test(NAME ${name} COMMAND ${name})
  set_tests_properties(${name} PROPERTIES ENVIRONMENT "POLYFLY_ROOT=${CMAKE_SOURCE_DIR}")
  if(ARG_THREADS)
    set_tests_properties(${name} PROPERTIES LABELS threads)
    if(TARGET threaded_tests)
      add_dependencies(threaded_tests ${name})
    endif()
  endif()
endfunction()

# polyfly_warnings(TARGET): the project's warnings, as errors where POLYFLY_WERROR is on.
function(polyfly_warnings name)
  target_compile_options(${name} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor)
  if(POLYFLY_WERROR)
    target_compile_options(${name} PRIVATE -Werror)
  endif()
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
