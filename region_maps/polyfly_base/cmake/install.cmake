# What `cmake --install` of the plain build leaves: libraries, their public headers, tools, and the files by which CMake
# (find_package) and pkg-config find them. Functions only. catkin packages install by rules of their own.
#
# A library of the build is a component: its name, without a leading `polyfly_`. Each component has a file of exported
# targets and a pkg-config file, so that a user of one needs no package that another one depends on.

# polyfly_component(RESULT LIBRARY): the name of a library's component, and of its target behind `polyfly::`.
function(polyfly_component result library)
  string(REGEX REPLACE "^polyfly_" "" name "${library}")
  set(${result} "${name}" PARENT_SCOPE)
endfunction()

# polyfly_install_library(NAME HEADERS path... FOLDERS folder... LINK target...)
#   Installs a library with its public headers: files and folders, relative to one of FOLDERS. LINK: all that it links.
function(polyfly_install_library name)
  cmake_parse_arguments(ARG "" "" "HEADERS;FOLDERS;LINK" ${ARGN})
  include(GNUInstallDirs)
  polyfly_component(component ${name})
  set_target_properties(${name} PROPERTIES EXPORT_NAME ${component} INSTALL_RPATH "$ORIGIN")
  install(TARGETS ${name} EXPORT polyfly_${component}
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}/polyfly
    LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/polyfly)
  install(EXPORT polyfly_${component} NAMESPACE polyfly:: FILE polyfly_${component}.cmake
    DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/polyfly)
  foreach(header ${ARG_HEADERS})
    polyfly_install_header(${header} ${ARG_FOLDERS})
  endforeach()
  set_property(GLOBAL APPEND PROPERTY POLYFLY_INSTALLED ${name})
  set_property(GLOBAL PROPERTY POLYFLY_LINKS_OF_${name} "${ARG_LINK}")
endfunction()

# polyfly_install_header(PATH FOLDER...): a header, or a folder of headers, of the first FOLDER that holds it.
function(polyfly_install_header path)
  foreach(folder ${ARGN})
    if(IS_DIRECTORY "${folder}/${path}")
      install(DIRECTORY "${folder}/${path}/" DESTINATION include/polyfly/${path} FILES_MATCHING PATTERN "*.hpp")
      return()
    elseif(EXISTS "${folder}/${path}")
      get_filename_component(place "${path}" DIRECTORY)
      install(FILES "${folder}/${path}" DESTINATION include/polyfly/${place})
      return()
    endif()
  endforeach()
  message(FATAL_ERROR "No folder of ${ARGN} holds the public header ${path}")
endfunction()

# polyfly_install_tool(TARGET)
function(polyfly_install_tool name)
  include(GNUInstallDirs)
  file(RELATIVE_PATH libraries "${CMAKE_INSTALL_FULL_BINDIR}" "${CMAKE_INSTALL_FULL_LIBDIR}/polyfly")
  set_target_properties(${name} PROPERTIES INSTALL_RPATH "$ORIGIN/${libraries}")
  install(TARGETS ${name} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endfunction()

# polyfly_version(RESULT): the version of the project, from the one place where it stands.
function(polyfly_version result)
  file(STRINGS "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/../include/polyfly_base/version.hpp" line REGEX "kVersion")
  string(REGEX MATCH "[0-9]+\\.[0-9]+\\.[0-9]+" version "${line}")
  set(${result} "${version}" PARENT_SCOPE)
endfunction()

# polyfly_install_package(): polyflyConfig.cmake, its version, and the pkg-config files. Called after the last library.
function(polyfly_install_package)
  include(CMakePackageConfigHelpers)
  include(GNUInstallDirs)
  get_property(libraries GLOBAL PROPERTY POLYFLY_INSTALLED)
  set(components "")
  set(needs "")
  foreach(library ${libraries})
    polyfly_component(component ${library})
    polyfly_needs(siblings packages modules flags ${library})
    list(APPEND components ${component})
    string(APPEND needs "set(polyfly_siblings_${component} ${siblings})\nset(polyfly_packages_${component} ${packages})\n")
    polyfly_write_pc(${component} "${PROJECT_VERSION}" "${siblings}" "${modules}" "-l${library};${flags}")
  endforeach()
  set(destination ${CMAKE_INSTALL_LIBDIR}/cmake/polyfly)
  set(folder "${CMAKE_BINARY_DIR}/package")
  configure_package_config_file("${CMAKE_CURRENT_FUNCTION_LIST_DIR}/polyflyConfig.cmake.in" "${folder}/polyflyConfig.cmake"
    INSTALL_DESTINATION ${destination} NO_SET_AND_CHECK_MACRO)
  write_basic_package_version_file("${folder}/polyflyConfigVersion.cmake" VERSION ${PROJECT_VERSION}
    COMPATIBILITY SameMinorVersion)
  install(FILES "${folder}/polyflyConfig.cmake" "${folder}/polyflyConfigVersion.cmake" DESTINATION ${destination})
endfunction()

# polyfly_needs(SIBLINGS PACKAGES MODULES FLAGS LIBRARY)
#   What a library links: components of ours, CMake packages, modules of pkg-config, and other flags of the linker.
function(polyfly_needs siblings_result packages_result modules_result flags_result library)
  get_property(libraries GLOBAL PROPERTY POLYFLY_INSTALLED)
  get_property(links GLOBAL PROPERTY POLYFLY_LINKS_OF_${library})
  foreach(result siblings packages modules flags)
    set(${result} "")
  endforeach()
  foreach(link ${links})
    if(link IN_LIST libraries)
      polyfly_component(component ${link})
      list(APPEND siblings ${component})
    elseif(link STREQUAL "Eigen3::Eigen")
      list(APPEND packages Eigen3)
      list(APPEND modules eigen3)
    elseif(link STREQUAL "Threads::Threads")
      list(APPEND packages Threads)
      list(APPEND flags -pthread)
    elseif(link STREQUAL "yaml-cpp")
      list(APPEND packages yaml-cpp)
      list(APPEND modules yaml-cpp)
    elseif(link MATCHES "^[a-z0-9_]+$" AND NOT TARGET ${link})
      list(APPEND flags -l${link})
    elseif(NOT link MATCHES "BUILD_INTERFACE")
      message(FATAL_ERROR "${library} is installed and links ${link}, which install.cmake does not know")
    endif()
  endforeach()
  foreach(result siblings packages modules flags)
    list(REMOVE_DUPLICATES ${result})
    set(${${result}_result} "${${result}}" PARENT_SCOPE)
  endforeach()
endfunction()

# polyfly_write_pc(COMPONENT VERSION SIBLINGS MODULES FLAGS): its pkg-config file, with paths relative to the file itself.
function(polyfly_write_pc component version siblings modules flags)
  include(GNUInstallDirs)
  set(folder ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
  file(RELATIVE_PATH prefix "/${folder}" "/")
  string(REGEX REPLACE "/$" "" prefix "${prefix}")
  list(TRANSFORM siblings PREPEND "polyfly_")
  string(JOIN " " requires ${siblings} ${modules})
  string(JOIN " " flags "-L\${prefix}/${CMAKE_INSTALL_LIBDIR}/polyfly" ${flags})
  set(file "${CMAKE_BINARY_DIR}/package/polyfly_${component}.pc")
  file(WRITE "${file}" "prefix=\${pcfiledir}/${prefix}\n\n"
    "Name: polyfly_${component}\n"
    "Description: Explicit and online MPC for unmanned aircraft, component ${component}\n"
    "Version: ${version}\n"
    "Requires: ${requires}\n"
    "Cflags: -I\${prefix}/include/polyfly\n"
    "Libs: ${flags}\n")
  install(FILES "${file}" DESTINATION ${folder})
endfunction()
