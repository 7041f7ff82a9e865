# cmake --install: headers, libraries and a package config for find_package(forewalk).
#
# Headers keep their room: an installed user writes #include "navmesh/nav_graph.h", as we do.
include(CMakePackageConfigHelpers)

set(forewalk_headers ${CMAKE_INSTALL_INCLUDEDIR}/forewalk)
set(forewalk_config ${CMAKE_INSTALL_LIBDIR}/cmake/forewalk)

install(TARGETS navmesh navmesh_build prediction prediction_dump rdw agents agents_clips agents_evaluation
  EXPORT forewalk
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
  FILE_SET HEADERS DESTINATION ${forewalk_headers})
install(TARGETS forewalk RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})

# The C interface: one header and one shared library, for programs that are not C++.
if(TARGET capi)
  target_include_directories(capi INTERFACE $<INSTALL_INTERFACE:${forewalk_headers}>)
  install(TARGETS capi EXPORT forewalk LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
  install(FILES ${PROJECT_SOURCE_DIR}/service/capi/forewalk.h DESTINATION ${forewalk_headers})
endif()

install(DIRECTORY ${PROJECT_SOURCE_DIR}/assets/scenes ${PROJECT_SOURCE_DIR}/assets/scenarios
  ${PROJECT_SOURCE_DIR}/assets/crowds
  DESTINATION ${CMAKE_INSTALL_DATADIR}/forewalk)

install(EXPORT forewalk NAMESPACE forewalk:: FILE forewalkTargets.cmake
  DESTINATION ${forewalk_config})
configure_package_config_file(cmake/forewalkConfig.cmake.in ${PROJECT_BINARY_DIR}/forewalkConfig.cmake
  INSTALL_DESTINATION ${forewalk_config})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/forewalkConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES
  ${PROJECT_BINARY_DIR}/forewalkConfig.cmake
  ${PROJECT_BINARY_DIR}/forewalkConfigVersion.cmake
  ${PROJECT_SOURCE_DIR}/cmake/FindRecast.cmake
  DESTINATION ${forewalk_config})
