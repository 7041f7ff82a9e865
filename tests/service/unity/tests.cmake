# The Unity package under Mono: compiled by Debian's mcs with a stand-in for UnityEngine, and its laws run
# against the library just built.
if(FOREWALK_TESTS_MATCHING)
  return()
endif()
find_program(MCS mcs)
find_program(MONO mono)
if(NOT MCS OR NOT MONO)
  add_test(NAME Unity.KeepsItsLaws
    COMMAND ${CMAKE_COMMAND} -E echo "skipped: there is no mcs and mono here (Debian: mono-mcs mono-runtime)")
  set_tests_properties(Unity.KeepsItsLaws PROPERTIES SKIP_REGULAR_EXPRESSION "^skipped")
  return()
endif()

set(unity_package ${PROJECT_SOURCE_DIR}/service/unity)
set(unity_laws ${CMAKE_CURRENT_LIST_DIR})
set(unity_out ${CMAKE_CURRENT_BINARY_DIR}/unity)
file(MAKE_DIRECTORY ${unity_out})

# unity_assembly(Forewalk.dll FLAGS -unsafe USES Other.dll SOURCES ...): C# 7.2, as the oldest Unity that the
# package is for.
function(unity_assembly name)
  cmake_parse_arguments(arg "" "" "FLAGS;USES;SOURCES" ${ARGN})
  list(TRANSFORM arg_USES PREPEND ${unity_out}/ OUTPUT_VARIABLE used)
  list(TRANSFORM used PREPEND -r: OUTPUT_VARIABLE references)
  add_custom_command(OUTPUT ${unity_out}/${name}
    COMMAND ${MCS} -langversion:7.2 -warnaserror -debug ${arg_FLAGS} ${references} -out:${unity_out}/${name}
            ${arg_SOURCES}
    DEPENDS ${arg_SOURCES} ${used}
    COMMENT "Compiling ${name}"
    VERBATIM)
endfunction()

file(GLOB core CONFIGURE_DEPENDS ${unity_package}/Runtime/Core/*.cs)
file(GLOB rig CONFIGURE_DEPENDS ${unity_package}/Runtime/Rig/*.cs)
file(GLOB editor CONFIGURE_DEPENDS ${unity_package}/Editor/*.cs)
file(GLOB sample CONFIGURE_DEPENDS ${unity_package}/Samples~/FirstWalk/*.cs)
unity_assembly(Forewalk.dll FLAGS -target:library -unsafe SOURCES ${core})
unity_assembly(UnityEngine.dll FLAGS -target:library
  SOURCES ${unity_laws}/UnityEngineStub.cs ${unity_laws}/UnityMathStub.cs)
unity_assembly(UnityEditor.dll FLAGS -target:library USES UnityEngine.dll
  SOURCES ${unity_laws}/UnityEditorStub.cs)
unity_assembly(Forewalk.Unity.dll FLAGS -target:library USES Forewalk.dll UnityEngine.dll
  SOURCES ${rig})
unity_assembly(Forewalk.Unity.Editor.dll FLAGS -target:library
  USES Forewalk.dll UnityEngine.dll UnityEditor.dll Forewalk.Unity.dll SOURCES ${editor})
unity_assembly(FirstWalk.dll FLAGS -target:library USES Forewalk.dll UnityEngine.dll Forewalk.Unity.dll
  SOURCES ${sample})
set(laws Laws Layout Walks Garbage Sessions Rooms Rigs Page)
list(TRANSFORM laws PREPEND ${unity_laws}/)
list(TRANSFORM laws APPEND .cs)
unity_assembly(unity_laws.exe FLAGS -unsafe -r:System.Core.dll
  USES Forewalk.dll UnityEngine.dll UnityEditor.dll Forewalk.Unity.dll Forewalk.Unity.Editor.dll FirstWalk.dll
  SOURCES ${laws})
add_custom_target(unity_assemblies DEPENDS ${unity_out}/unity_laws.exe)

# A program that is not sanitized itself needs the sanitizer's library first, and keeps its own signals.
# Mono does not free all it has: what the library frees is tested in C++.
set(sanitizer "")
if(FOREWALK_SANITIZE MATCHES address)
  execute_process(COMMAND ${CMAKE_CXX_COMPILER} -print-file-name=libasan.so
    OUTPUT_VARIABLE libasan OUTPUT_STRIP_TRAILING_WHITESPACE)
  set(sanitizer "LD_PRELOAD='${libasan}' ASAN_OPTIONS=detect_leaks=0:handle_segv=0:handle_sigfpe=0")
endif()
file(GENERATE OUTPUT ${unity_out}/unity_laws
  CONTENT "#!/bin/sh\n${sanitizer} LD_LIBRARY_PATH=\"\${UNITY_PLUGINS:-$<TARGET_FILE_DIR:capi>}\" exec '${MONO}' --debug '${unity_out}/unity_laws.exe' \"$@\"\n"
  FILE_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)

forewalk_test(service/unity_test.cpp LIBS nlohmann_json::nlohmann_json)
forewalk_test(service/unity_walk_test.cpp LIBS capi capi_axes forewalk::rdw forewalk::navmesh_build)
foreach(name unity_test unity_walk_test)
  add_dependencies(${name} unity_assemblies capi)
  target_compile_definitions(${name} PRIVATE FOREWALK_PROGRAM="${unity_out}/unity_laws")
endforeach()
target_compile_definitions(unity_test PRIVATE
  FOREWALK_CC="${CMAKE_C_COMPILER}"
  FOREWALK_CMAKE="${CMAKE_COMMAND}"
  FOREWALK_LIBRARY="$<TARGET_FILE:capi>"
  FOREWALK_MCS="${MCS}"
  FOREWALK_UNITY="${unity_out}"
  FOREWALK_PROJECT_VERSION="${PROJECT_VERSION}")
