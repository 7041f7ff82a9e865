# Recast and Detour from Debian's librecast-dev, which ships neither a CMake config nor a pkg-config file.
#
# Defines Recast::Recast, Recast::Detour, Recast_FOUND.
find_path(Recast_INCLUDE_DIR Recast.h PATH_SUFFIXES recastnavigation)
find_library(Recast_LIBRARY Recast)
find_library(Detour_LIBRARY Detour)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(Recast
  REQUIRED_VARS Recast_LIBRARY Detour_LIBRARY Recast_INCLUDE_DIR
  REASON_FAILURE_MESSAGE "install librecast-dev")

if(Recast_FOUND)
  foreach(part Recast Detour)
    if(NOT TARGET Recast::${part})
      add_library(Recast::${part} UNKNOWN IMPORTED)
      set_target_properties(Recast::${part} PROPERTIES
        IMPORTED_LOCATION "${${part}_LIBRARY}"
        INTERFACE_INCLUDE_DIRECTORIES "${Recast_INCLUDE_DIR}")
    endif()
  endforeach()
endif()
mark_as_advanced(Recast_INCLUDE_DIR Recast_LIBRARY Detour_LIBRARY)
