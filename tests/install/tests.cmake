if(FOREWALK_TESTS_MATCHING)
  return()
endif()

# Installs into an empty folder, then configures, builds and runs an outside project against it.
add_test(NAME Install.ServesAnOutsideProject
  COMMAND ${CMAKE_COMMAND}
    -DBUILD=${PROJECT_BINARY_DIR}
    -DOUTSIDE=${CMAKE_CURRENT_SOURCE_DIR}/install/outside
    -DWORK=${CMAKE_CURRENT_BINARY_DIR}/install
    -DSCENE=${PROJECT_SOURCE_DIR}/assets/scenes/office.obj
    -DGENERATOR=${CMAKE_GENERATOR}
    -DCOMPILER=${CMAKE_CXX_COMPILER}
    -DSANITIZE=${FOREWALK_SANITIZE}
    -P ${CMAKE_CURRENT_SOURCE_DIR}/install/outside_test.cmake)
set_tests_properties(Install.ServesAnOutsideProject PROPERTIES TIMEOUT 300)

# The first call in README.md is that project, line by line.
add_test(NAME Readme.ShowsTheOutsideProject
  COMMAND ${CMAKE_COMMAND}
    -DREADME=${PROJECT_SOURCE_DIR}/README.md
    -DOUTSIDE=${CMAKE_CURRENT_SOURCE_DIR}/install/outside
    -P ${CMAKE_CURRENT_SOURCE_DIR}/install/readme_test.cmake)
