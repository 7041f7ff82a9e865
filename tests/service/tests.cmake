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

# The same two for tests whose threads are a crowd's or the daemon's, which conformance_test and daemon_test
# show to the thread sanitizer: these would have it build the whole command.
function(forewalk_unthreaded_test)
  if(NOT FOREWALK_TESTS_MATCHING)
    forewalk_test(${ARGN})
  endif()
endfunction()
function(forewalk_unthreaded_program_test)
  if(NOT FOREWALK_TESTS_MATCHING)
    forewalk_program_test(${ARGN})
  endif()
endfunction()

forewalk_test(service/parallel_test.cpp LIBS service_core)
forewalk_test(service/live_world_test.cpp LIBS service_core)
forewalk_test(service/walk_animation_test.cpp LIBS forewalk::service)
forewalk_test(service/clip_file_test.cpp LIBS forewalk::service)
forewalk_test(service/sweep_test.cpp LIBS forewalk::service)
forewalk_unthreaded_test(service/walk_company_test.cpp LIBS forewalk::service fmt::fmt)
forewalk_unthreaded_test(service/crowd_run_test.cpp LIBS forewalk::service SQLite::SQLite3 nlohmann_json::nlohmann_json)
forewalk_unthreaded_test(service/shared_world_test.cpp LIBS forewalk::service)
forewalk_test(service/rimea_test.cpp LIBS forewalk::service nlohmann_json::nlohmann_json)
forewalk_program_test(service/cli_test.cpp LIBS nlohmann_json::nlohmann_json)

# The C interface.
forewalk_test(service/capi_axes_test.cpp LIBS capi capi_axes forewalk::navmesh_build)
forewalk_test(service/capi_allocation_test.cpp LIBS capi forewalk::rdw forewalk::navmesh_build)
forewalk_test(service/capi_session_test.cpp LIBS capi forewalk::rdw forewalk::navmesh_build)
forewalk_test(service/capi_navmesh_test.cpp LIBS capi forewalk::rdw forewalk::navmesh_build)
forewalk_test(service/capi_world_test.cpp LIBS capi forewalk::rdw forewalk::navmesh_build)
forewalk_test(service/capi_threads_test.cpp LIBS capi forewalk::rdw forewalk::navmesh_build)
forewalk_test(service/capi_recording_test.cpp LIBS capi forewalk::rdw forewalk::navmesh_build session_recording)
foreach(name capi_space_test capi_ways_test capi_log_test capi_live_world_test)
  forewalk_test(service/${name}.cpp LIBS capi forewalk::rdw forewalk::navmesh_build)
endforeach()
forewalk_test(service/capi_example_test.cpp LIBS forewalk::rdw forewalk::navmesh_build)
if(TARGET capi_example_test)
  add_dependencies(capi_example_test frame_example)
  target_compile_definitions(capi_example_test PRIVATE
    FOREWALK_FRAME_EXAMPLE="$<TARGET_FILE:frame_example>")
endif()
forewalk_test(service/capi_guide_test.cpp)
if(TARGET capi_guide_test)
  set(flags)
  if(FOREWALK_SANITIZE)
    set(flags -fsanitize=${FOREWALK_SANITIZE})
  endif()
  add_dependencies(capi_guide_test capi)
  target_compile_definitions(capi_guide_test PRIVATE
    FOREWALK_C_COMPILER="${CMAKE_C_COMPILER}"
    FOREWALK_C_FLAGS="${flags}"
    FOREWALK_LIBRARY="$<TARGET_FILE:capi>"
    FOREWALK_WORK="${CMAKE_CURRENT_BINARY_DIR}/guide")
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

  # Against the last release, where abigail-tools is there.
  add_library(capi_shown SHARED service/abi/shown.c)
  target_include_directories(capi_shown PRIVATE $<TARGET_PROPERTY:capi,INTERFACE_INCLUDE_DIRECTORIES>)
  target_compile_options(capi_shown PRIVATE -std=gnu99 -g -O0 -fno-sanitize=all)
  target_link_options(capi_shown PRIVATE -fno-sanitize=all)
  add_dependencies(tests capi_shown)
  find_program(ABIDIFF abidiff)
  if(ABIDIFF)
    add_test(NAME CapiAbi.IsThatOfTheLastRelease
      COMMAND ${ABIDIFF} --no-added-syms
              --suppressions ${CMAKE_CURRENT_SOURCE_DIR}/service/abi/grows.suppr
              ${CMAKE_CURRENT_SOURCE_DIR}/service/abi/forewalk-0.1.abi $<TARGET_FILE:capi_shown>)
  else()
    add_test(NAME CapiAbi.IsThatOfTheLastRelease
      COMMAND ${CMAKE_COMMAND} -E echo "skipped: there is no abidiff here (Debian: abigail-tools)")
    set_tests_properties(CapiAbi.IsThatOfTheLastRelease PROPERTIES SKIP_REGULAR_EXPRESSION "^skipped")
  endif()

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

# WebAssembly against this library, where both have been built (./forewalk.sh wasm).
add_executable(native_walk service/wasm/native_walk.cpp)
target_link_libraries(native_walk PRIVATE capi service_core fmt::fmt project_options)
target_compile_options(native_walk PRIVATE $<$<CONFIG:Release>:-O1>)
target_compile_definitions(native_walk PRIVATE
  FOREWALK_SHARED_DATA="${FOREWALK_SHARED_DATA}" FOREWALK_ASSETS="${PROJECT_SOURCE_DIR}/assets")
if(NOT FOREWALK_SANITIZE)
  add_dependencies(tests native_walk)
  add_test(NAME Wasm.AgreesWithTheNativeLibrary
    COMMAND sh ${CMAKE_CURRENT_SOURCE_DIR}/service/wasm/agreement.sh
            ${PROJECT_SOURCE_DIR}/build/wasm/service/wasm/package $<TARGET_FILE:native_walk>
            ${CMAKE_CURRENT_BINARY_DIR}/wasm)
  set_tests_properties(Wasm.AgreesWithTheNativeLibrary PROPERTIES
    SKIP_REGULAR_EXPRESSION "^skipped" TIMEOUT 300)
endif()

# The inspector in a browser, where the page has been built (./forewalk.sh inspector).
add_executable(native_recording service/inspector/native_recording.cpp)
target_link_libraries(native_recording PRIVATE session_recording service_core fmt::fmt project_options)
target_compile_options(native_recording PRIVATE $<$<CONFIG:Release>:-O1>)
target_compile_definitions(native_recording PRIVATE FOREWALK_ASSETS="${PROJECT_SOURCE_DIR}/assets")
if(NOT FOREWALK_SANITIZE)
  set(inspector_page ${PROJECT_SOURCE_DIR}/build/inspector/page)
  function(forewalk_inspector_test name script)
    add_test(NAME Inspector.${name}
      COMMAND sh ${CMAKE_CURRENT_SOURCE_DIR}/service/inspector/inspector.sh ${script} ${inspector_page} ${ARGN})
    set_tests_properties(Inspector.${name} PROPERTIES SKIP_REGULAR_EXPRESSION "^skipped" TIMEOUT 290)
  endfunction()
  set(inspector_out ${CMAKE_CURRENT_BINARY_DIR}/inspector)
  add_dependencies(tests native_recording)
  forewalk_inspector_test(ShowsRecordingsAsTheNativeLibraryPredicts recording.mjs
    $<TARGET_FILE:native_recording> ${inspector_out}/recording $<TARGET_FILE:forewalk>)
  forewalk_inspector_test(PlaysTenMinutesWithinAFrame speed.mjs $<TARGET_FILE:native_recording> ${inspector_out}/speed)
  forewalk_inspector_test(WalksAtTheDaemonThroughItsEnd daemon.mjs $<TARGET_FILE:forewalk>
    ${PROJECT_SOURCE_DIR}/assets/scenes/museum.obj ${inspector_out}/daemon)
  forewalk_inspector_test(IsUsedByKeyboardAndReadInBothThemes keyboard.mjs)
  forewalk_inspector_test(AgreesWithTheNativeLibrary agreement.mjs $<TARGET_FILE:native_walk> ${inspector_out}/agreement)
  # What is measured is measured alone.
  set_tests_properties(Inspector.PlaysTenMinutesWithinAFrame PROPERTIES RUN_SERIAL ON)
endif()

# Enter VR: its parts, and the page with an emulated headset (./forewalk.sh inspector builds it).
if(NOT FOREWALK_SANITIZE)
  foreach(named "WalkersKeepTheirLaws vr_walker.mjs" "RoomsAndPromptsKeepTheirLaws vr_room.mjs"
                "WalksAHundredMetresInAHeadset vr.mjs")
    separate_arguments(named)
    list(GET named 0 name)
    list(GET named 1 script)
    add_test(NAME EnterVr.${name}
      COMMAND sh ${CMAKE_CURRENT_SOURCE_DIR}/service/inspector/vr.sh ${script} ${PROJECT_SOURCE_DIR}/build)
    set_tests_properties(EnterVr.${name} PROPERTIES SKIP_REGULAR_EXPRESSION "^skipped" TIMEOUT 900)
  endforeach()
endif()

find_program(TSC tsc)
if(TSC)
  add_test(NAME Wasm.HasTheTypesThatItSays
    COMMAND ${TSC} --noEmit --strict --target es2020 --module es2020 --moduleResolution node --lib es2020,dom
            ${CMAKE_CURRENT_SOURCE_DIR}/service/wasm/types.ts)
else()
  add_test(NAME Wasm.HasTheTypesThatItSays
    COMMAND ${CMAKE_COMMAND} -E echo "skipped: there is no tsc here (Debian: node-typescript)")
  set_tests_properties(Wasm.HasTheTypesThatItSays PROPERTIES SKIP_REGULAR_EXPRESSION "^skipped")
endif()

# Which way will they take: fitting and judging.
forewalk_test(service/fitting_test.cpp LIBS forewalk::service)
forewalk_test(service/evaluation_test.cpp LIBS forewalk::service nlohmann_json::nlohmann_json)
forewalk_program_test(service/likelihood_cli_test.cpp LIBS nlohmann_json::nlohmann_json)

# How like people simulated walkers walk.
forewalk_test(service/path_tables_test.cpp LIBS forewalk::service)
forewalk_test(service/path_comparison_test.cpp LIBS forewalk::service nlohmann_json::nlohmann_json)
forewalk_test(service/walk_legs_test.cpp LIBS forewalk::service)
forewalk_test(service/likeness_test.cpp LIBS forewalk::service nlohmann_json::nlohmann_json)
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
forewalk_unthreaded_program_test(service/serve_cli_test.cpp
  LIBS forewalk::daemon web_client spdlog::spdlog nlohmann_json::nlohmann_json)

# Crowds over a network.
forewalk_unthreaded_program_test(service/crowd_network_test.cpp LIBS forewalk::service)

# Experiments: many walks, their results and report.
forewalk_test(service/experiment_test.cpp LIBS forewalk::service)
forewalk_unthreaded_test(service/experiment_users_test.cpp LIBS forewalk::service)

# A job array on a real cluster of this machine; skipped where slurm-wlm or root is missing. Sanitizers
# have seen what it runs.
if(CMAKE_BUILD_TYPE STREQUAL "Release")
  add_test(NAME Slurm.AnArrayWithAKilledTaskGivesTheBytesOfOneProcess
    COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/service/slurm_test.sh $<TARGET_FILE:forewalk>
            ${PROJECT_SOURCE_DIR}/service/experiment/slurm/forewalk-array.sh ${PROJECT_SOURCE_DIR}/assets)
  set_tests_properties(Slurm.AnArrayWithAKilledTaskGivesTheBytesOfOneProcess PROPERTIES
    SKIP_RETURN_CODE 77 TIMEOUT 290 RUN_SERIAL ON)
endif()

# The OpenXR layer, under Debian's loader, with a fake runtime and a client of its own.
if(TARGET openxr_layer)
  find_package(OpenXR CONFIG QUIET)
  add_library(openxr_fake_runtime MODULE service/openxr/fake_runtime.cpp)
  target_link_libraries(openxr_fake_runtime PRIVATE OpenXR::headers forewalk::rdw project_options)
  target_include_directories(openxr_fake_runtime PRIVATE ${PROJECT_SOURCE_DIR})
  set_target_properties(openxr_fake_runtime PROPERTIES CXX_VISIBILITY_PRESET hidden)
  add_executable(openxr_walk_client service/openxr/walk_client.cpp)
  target_include_directories(openxr_walk_client PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(openxr_walk_client PRIVATE OpenXR::openxr_loader Threads::Threads project_options)
  find_path(FOREWALK_VALIDATION_FOLDER XrApiLayer_core_validation.${CMAKE_LIBRARY_ARCHITECTURE}.json
    PATHS /usr/share/openxr/1/api_layers/explicit.d)
  foreach(name openxr_layer_test openxr_events_test openxr_threads_test)
    forewalk_test(service/openxr/${name}.cpp LIBS service_core OpenXR::headers)
    if(TARGET ${name})
      add_dependencies(${name} openxr_layer openxr_fake_runtime openxr_walk_client)
      target_compile_definitions(${name} PRIVATE
        FOREWALK_PROGRAM="$<TARGET_FILE:openxr_walk_client>"
        FOREWALK_FAKE_RUNTIME="$<TARGET_FILE:openxr_fake_runtime>"
        FOREWALK_LAYER_FOLDER="$<TARGET_FILE_DIR:openxr_layer>"
        $<$<BOOL:${FOREWALK_VALIDATION_FOLDER}>:FOREWALK_VALIDATION_FOLDER="${FOREWALK_VALIDATION_FOLDER}">)
    endif()
  endforeach()
else()
  add_test(NAME OpenXrLayer.RedirectsAnyApplication
    COMMAND ${CMAKE_COMMAND} -E echo "skipped: there is no libopenxr-dev here")
  set_tests_properties(OpenXrLayer.RedirectsAnyApplication PROPERTIES SKIP_REGULAR_EXPRESSION "^skipped")
endif()

# The Unity package.
include(${CMAKE_CURRENT_LIST_DIR}/unity/tests.cmake)

# The pages of service/guide, followed word for word: they build with the release preset.
if(PROJECT_BINARY_DIR STREQUAL "${PROJECT_SOURCE_DIR}/build/release")
  set(wasm_package ${PROJECT_SOURCE_DIR}/build/wasm/service/wasm/package/forewalk_core.js)
  foreach(page c cpp "browser;node;chromium;${wasm_package}" "daemon;node;npm;curl")
    list(POP_FRONT page name)
    add_test(NAME Guide.${name}
      COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/service/guide/follow.sh ${PROJECT_SOURCE_DIR}/service/guide/${name}.md
              ${PROJECT_SOURCE_DIR} ${CMAKE_CURRENT_BINARY_DIR}/guide/${name} ${page})
    # One at a time: they build.
    set_tests_properties(Guide.${name} PROPERTIES TIMEOUT 300 SKIP_REGULAR_EXPRESSION "^skipped: " RESOURCE_LOCK guide)
  endforeach()
endif()
