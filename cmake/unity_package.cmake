# The Unity package with the library in it, as a tarball that Unity's Package Manager installs:
#   cmake --build build/release --target unity_package
# As a script (-P) it packs; included, it makes that target.
if(NOT CMAKE_SCRIPT_MODE_FILE)
  add_custom_target(unity_package
    COMMAND ${CMAKE_COMMAND}
      -DPACKAGE=${PROJECT_SOURCE_DIR}/service/unity
      -DLIBRARY=$<TARGET_FILE:capi>
      -DLICENCE=${PROJECT_SOURCE_DIR}/LICENSE
      -DWORK=${PROJECT_BINARY_DIR}/unity
      -DVERSION=${PROJECT_VERSION}
      -P ${CMAKE_CURRENT_LIST_FILE}
    DEPENDS capi
    VERBATIM)
  return()
endif()

# Unity wants a .meta beside each file of a package, with a guid that stays the same.
function(write_meta path importer)
  string(MD5 guid "io.forewalk.unity/${path}")
  file(WRITE ${WORK}/package/${path}.meta "fileFormatVersion: 2\nguid: ${guid}\n${importer}")
endfunction()

file(REMOVE_RECURSE ${WORK}/package)
file(COPY ${PACKAGE}/ DESTINATION ${WORK}/package)
configure_file(${LICENCE} ${WORK}/package/LICENSE.md COPYONLY)
write_meta(LICENSE.md "TextScriptImporter:\n  externalObjects: {}\n")

# The file itself under the name that programs ask for, without the links to it.
file(REAL_PATH ${LIBRARY} library)
foreach(folder Runtime/Plugins Runtime/Plugins/x86_64)
  file(MAKE_DIRECTORY ${WORK}/package/${folder})
  write_meta(${folder} "folderAsset: yes\nDefaultImporter:\n  externalObjects: {}\n")
endforeach()
configure_file(${library} ${WORK}/package/Runtime/Plugins/x86_64/libforewalk.so COPYONLY)
write_meta(Runtime/Plugins/x86_64/libforewalk.so "PluginImporter:
  externalObjects: {}
  serializedVersion: 2
  isPreloaded: 0
  isOverridable: 0
  platformData:
  - first:
      Any:
    second:
      enabled: 0
      settings: {}
  - first:
      Editor: Editor
    second:
      enabled: 1
      settings:
        CPU: x86_64
        DefaultValueInitialized: true
        OS: Linux
  - first:
      Standalone: Linux64
    second:
      enabled: 1
      settings:
        CPU: x86_64
")

set(tarball ${WORK}/io.forewalk.unity-${VERSION}.tgz)
execute_process(COMMAND ${CMAKE_COMMAND} -E tar czf ${tarball} package
  WORKING_DIRECTORY ${WORK} COMMAND_ERROR_IS_FATAL ANY)
message(STATUS "${tarball}: in Unity, Window > Package Manager > + > Add package from tarball")
