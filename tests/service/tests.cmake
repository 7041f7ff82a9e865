# Tests of service/, one forewalk_test() a file.

# forewalk_program_test(service/cli_test.cpp LIBS ...): a test that runs the forewalk program.
function(forewalk_program_test source)
  forewalk_test(${source} ${ARGN})
  get_filename_component(name ${source} NAME_WE)
  if(TARGET ${name})
    add_dependencies(${name} forewalk)
    target_compile_definitions(${name} PRIVATE FOREWALK_PROGRAM="$<TARGET_FILE:forewalk>")
  endif()
endfunction()

forewalk_test(service/parallel_test.cpp LIBS forewalk::service)
forewalk_test(service/live_world_test.cpp LIBS forewalk::service)
forewalk_test(service/walk_animation_test.cpp LIBS forewalk::service)
forewalk_test(service/clip_file_test.cpp LIBS forewalk::service)
forewalk_test(service/sweep_test.cpp LIBS forewalk::service)
forewalk_test(service/walk_company_test.cpp LIBS forewalk::service fmt::fmt)
forewalk_test(service/shared_world_test.cpp LIBS forewalk::service)
forewalk_test(service/crowd_run_test.cpp LIBS forewalk::service SQLite::SQLite3 nlohmann_json::nlohmann_json)
forewalk_test(service/rimea_test.cpp LIBS forewalk::service nlohmann_json::nlohmann_json)
forewalk_program_test(service/cli_test.cpp LIBS nlohmann_json::nlohmann_json)

# The C interface.
forewalk_test(service/capi_axes_test.cpp LIBS capi capi_axes forewalk::navmesh_build)
forewalk_test(service/capi_allocation_test.cpp LIBS capi forewalk::rdw forewalk::navmesh_build)
forewalk_test(service/capi_session_test.cpp LIBS capi forewalk::rdw forewalk::navmesh_build)
forewalk_test(service/capi_world_test.cpp LIBS capi forewalk::rdw forewalk::navmesh_build)
forewalk_test(service/capi_threads_test.cpp LIBS capi forewalk::rdw forewalk::navmesh_build)
forewalk_test(service/capi_example_test.cpp LIBS forewalk::rdw forewalk::navmesh_build)
if(TARGET capi_example_test)
  add_dependencies(capi_example_test frame_example)
  target_compile_definitions(capi_example_test PRIVATE
    FOREWALK_FRAME_EXAMPLE="$<TARGET_FILE:frame_example>")
endif()
forewalk_test(service/capi_header_test.cpp LIBS capi)
if(TARGET capi_header_test)
  add_library(capi_header_in_c OBJECT service/capi_header.c)
  target_link_libraries(capi_header_in_c PRIVATE capi)
  target_include_directories(capi_header_in_c PRIVATE ${PROJECT_SOURCE_DIR})
  target_compile_options(capi_header_in_c PRIVATE -std=c99 -pedantic -Wall -Wextra -Wshadow
    -Wstrict-prototypes -Werror)
  target_link_libraries(capi_header_test PRIVATE capi_header_in_c)
  target_compile_definitions(capi_header_test PRIVATE
    FOREWALK_NM="${CMAKE_NM}"
    FOREWALK_LIBRARY="$<TARGET_FILE:capi>"
    FOREWALK_PROJECT_VERSION="${PROJECT_VERSION}")

  find_program(CLANGXX NAMES clang++ clang++-14)
  if(CLANGXX)
    add_test(NAME CapiHeader.ServesCppWithoutExceptionsAndRtti
      COMMAND ${CLANGXX} -std=c++17 -fno-exceptions -fno-rtti -Wall -Wextra -pedantic -Werror
              -fsyntax-only -I${PROJECT_SOURCE_DIR}/service/capi
              ${CMAKE_CURRENT_SOURCE_DIR}/service/capi_header_plain.cpp)
  else()
    add_test(NAME CapiHeader.ServesCppWithoutExceptionsAndRtti
      COMMAND ${CMAKE_COMMAND} -E echo "skipped: there is no clang++ here")
    set_tests_properties(CapiHeader.ServesCppWithoutExceptionsAndRtti PROPERTIES
      SKIP_REGULAR_EXPRESSION "^skipped")
  endif()
endif()

# Which way will they take: fitting and judging.
forewalk_test(service/fitting_test.cpp LIBS forewalk::service)
forewalk_test(service/evaluation_test.cpp LIBS forewalk::service nlohmann_json::nlohmann_json)
forewalk_program_test(service/likelihood_cli_test.cpp LIBS nlohmann_json::nlohmann_json)

# How like people simulated walkers walk.
forewalk_test(service/path_tables_test.cpp LIBS forewalk::service)
forewalk_test(service/path_comparison_test.cpp LIBS forewalk::service nlohmann_json::nlohmann_json)
forewalk_program_test(service/paths_cli_test.cpp LIBS nlohmann_json::nlohmann_json)
forewalk_test(service/trajectory_picture_test.cpp LIBS forewalk::service)

# The daemon. Its clients stand apart: Beast is slow to compile.
add_library(web_client STATIC ${PROJECT_SOURCE_DIR}/tests/support/web_client.cpp)
target_link_libraries(web_client PUBLIC Boost::headers Threads::Threads PRIVATE project_options)
target_include_directories(web_client PUBLIC ${PROJECT_SOURCE_DIR})
forewalk_test(service/daemon_message_test.cpp LIBS forewalk::daemon nlohmann_json::nlohmann_json)
foreach(name daemon_test daemon_limits_test)
  forewalk_test(service/${name}.cpp LIBS forewalk::daemon web_client spdlog::spdlog nlohmann_json::nlohmann_json)
endforeach()
forewalk_program_test(service/serve_cli_test.cpp
  LIBS forewalk::daemon web_client spdlog::spdlog nlohmann_json::nlohmann_json)

# Crowds over a network.
forewalk_program_test(service/crowd_network_test.cpp LIBS forewalk::service)

# Experiments: many walks, their results and report.
forewalk_test(service/experiment_test.cpp LIBS forewalk::service)
forewalk_test(service/experiment_users_test.cpp LIBS forewalk::service)

# A job array on a real cluster of this machine; skipped where slurm-wlm or root is missing. Sanitizers
# have seen what it runs.
if(CMAKE_BUILD_TYPE STREQUAL "Release")
  add_test(NAME Slurm.AnArrayWithAKilledTaskGivesTheBytesOfOneProcess
    COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/service/slurm_test.sh $<TARGET_FILE:forewalk>
            ${PROJECT_SOURCE_DIR}/service/experiment/slurm/forewalk-array.sh ${PROJECT_SOURCE_DIR}/assets)
  set_tests_properties(Slurm.AnArrayWithAKilledTaskGivesTheBytesOfOneProcess PROPERTIES
    SKIP_RETURN_CODE 77 TIMEOUT 180)
endif()
