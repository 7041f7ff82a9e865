# Several sources compiled as one: the headers that they share (JSON, CLI11, Beast) are most of the work, and a
# whole build takes half the time. A change then rebuilds all that it is compiled with, so it is off unless asked
# for, as ./forewalk.sh does where it configures a build for the first time.
option(FOREWALK_UNITY "Compile the command, service, daemon and C interface a few sources at a time" OFF)

# forewalk_unity(service SKIP live_world.cpp): all sources of a target but those, which stay alone.
function(forewalk_unity target)
  cmake_parse_arguments(arg "" "" "SKIP" ${ARGN})
  if(FOREWALK_UNITY)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 6)
    set_source_files_properties(${arg_SKIP} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  endif()
endfunction()
