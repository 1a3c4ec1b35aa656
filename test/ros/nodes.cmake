# The nodes and nodelets, built by catkin only.
add_library(polyfly_test_ros
  ros/conversions.cpp
  ros/figure_player.cpp
  ros/flight_recorder.cpp
  ros/latency_probe.cpp
  ros/nodelets.cpp
  ros/plant_node.cpp
  ros/probe_times.cpp)
target_include_directories(polyfly_test_ros PUBLIC ${CMAKE_CURRENT_SOURCE_DIR}/ros)
target_include_directories(polyfly_test_ros SYSTEM PUBLIC ${catkin_INCLUDE_DIRS})
target_link_libraries(polyfly_test_ros PUBLIC multirotor_plant online_controller_ros ${catkin_LIBRARIES})
add_dependencies(polyfly_test_ros ${catkin_EXPORTED_TARGETS})
polyfly_warnings(polyfly_test_ros)
polyfly_unity(polyfly_test_ros)

foreach(node multirotor_plant figure_player flight_recorder latency_probe reconfigure_load command_echo)
  add_executable(${node}_node ros/${node}_main.cpp)
  set_target_properties(${node}_node PROPERTIES OUTPUT_NAME ${node})
  target_link_libraries(${node}_node PRIVATE polyfly_test_ros)
  polyfly_warnings(${node}_node)
  install(TARGETS ${node}_node DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
endforeach()
install(TARGETS polyfly_test_ros LIBRARY DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION})
catkin_install_python(PROGRAMS ros/end_of_flight.py DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
install(FILES nodelets.xml DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION})

# End to end, over real topics; POLYFLY_MAPS must name the folder of the solved maps, aslquad_*.map among them.
if(CATKIN_ENABLE_TESTING)
  find_package(rostest REQUIRED)
  find_package(GTest REQUIRED)
  add_executable(node_soak_test EXCLUDE_FROM_ALL ros/node_soak.cpp ros/node_soak_test.cpp src/soak.cpp)
  target_link_libraries(node_soak_test PRIVATE polyfly_test_ros GTest::gtest)
  polyfly_warnings(node_soak_test)
  add_rostest(rostest/soak.test DEPENDENCIES node_soak_test)
  add_rostest(rostest/hostile_stamps.test DEPENDENCIES polyfly_test_ros)
  add_rostest(rostest/lookup_rover.test)
  foreach(test calibration flights launch_files robust_flights safety_filter)
    add_rostest(rostest/${test}.test
      DEPENDENCIES polyfly_test_ros multirotor_plant_node figure_player_node flight_recorder_node)
  endforeach()
endif()
