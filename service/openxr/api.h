// What an API layer needs of OpenXR and Debian's headers (1.0.20) do not have: the loader's side of
// a layer, and functions and constants of later versions that applications may ask for.
//
// Shapes and numbers are those of the OpenXR specification, 1.0 section "API layer interaction" of
// the loader document, and 1.1 for what came later. Structs of later versions carry names of their
// own, so that they stand beside any header's.
#pragma once

#include <openxr/openxr.h>

#include <cstddef>
#include <cstdint>

#if __has_include(<openxr/openxr_loader_negotiation.h>)
#include <openxr/openxr_loader_negotiation.h>
#else

extern "C" {

enum XrLoaderInterfaceStructs {
  XR_LOADER_INTERFACE_STRUCT_UNINTIALIZED = 0,  // spelled so in the specification
  XR_LOADER_INTERFACE_STRUCT_LOADER_INFO = 1,
  XR_LOADER_INTERFACE_STRUCT_API_LAYER_REQUEST = 2,
  XR_LOADER_INTERFACE_STRUCT_RUNTIME_REQUEST = 3,
  XR_LOADER_INTERFACE_STRUCT_API_LAYER_CREATE_INFO = 4,
  XR_LOADER_INTERFACE_STRUCT_API_LAYER_NEXT_INFO = 5,
  XR_LOADER_INTERFACE_STRUCTS_MAX_ENUM = 0x7FFFFFFF
};

#define XR_CURRENT_LOADER_API_LAYER_VERSION 1
#define XR_CURRENT_LOADER_RUNTIME_VERSION 1
#define XR_LOADER_INFO_STRUCT_VERSION 1
#define XR_API_LAYER_INFO_STRUCT_VERSION 1
#define XR_RUNTIME_INFO_STRUCT_VERSION 1
#define XR_API_LAYER_NEXT_INFO_STRUCT_VERSION 1
#define XR_API_LAYER_CREATE_INFO_STRUCT_VERSION 1
#define XR_API_LAYER_MAX_SETTINGS_PATH_SIZE 512

struct XrApiLayerCreateInfo;
typedef XrResult(XRAPI_PTR* PFN_xrCreateApiLayerInstance)(const XrInstanceCreateInfo* info,
                                                          const XrApiLayerCreateInfo* layerInfo,
                                                          XrInstance* instance);

struct XrNegotiateLoaderInfo {
  XrLoaderInterfaceStructs structType;
  std::uint32_t structVersion;
  std::size_t structSize;
  std::uint32_t minInterfaceVersion;
  std::uint32_t maxInterfaceVersion;
  XrVersion minApiVersion;
  XrVersion maxApiVersion;
};

struct XrNegotiateApiLayerRequest {
  XrLoaderInterfaceStructs structType;
  std::uint32_t structVersion;
  std::size_t structSize;
  std::uint32_t layerInterfaceVersion;
  XrVersion layerApiVersion;
  PFN_xrGetInstanceProcAddr getInstanceProcAddr;
  PFN_xrCreateApiLayerInstance createApiLayerInstance;
};

struct XrNegotiateRuntimeRequest {
  XrLoaderInterfaceStructs structType;
  std::uint32_t structVersion;
  std::size_t structSize;
  std::uint32_t runtimeInterfaceVersion;
  XrVersion runtimeApiVersion;
  PFN_xrGetInstanceProcAddr getInstanceProcAddr;
};

struct XrApiLayerNextInfo {
  XrLoaderInterfaceStructs structType;
  std::uint32_t structVersion;
  std::size_t structSize;
  char layerName[XR_MAX_API_LAYER_NAME_SIZE];
  PFN_xrGetInstanceProcAddr nextGetInstanceProcAddr;
  PFN_xrCreateApiLayerInstance nextCreateApiLayerInstance;
  XrApiLayerNextInfo* next;
};

struct XrApiLayerCreateInfo {
  XrLoaderInterfaceStructs structType;
  std::uint32_t structVersion;
  std::size_t structSize;
  void* loaderInstance;
  char settings_file_location[XR_API_LAYER_MAX_SETTINGS_PATH_SIZE];
  XrApiLayerNextInfo* nextInfo;
};

}  // extern "C"

#endif

namespace forewalk::openxr {

// Reference spaces of later versions and of vendors.
inline constexpr int kReferenceLocalFloor = 1000426000;        // 1.1, XR_EXT_local_floor
inline constexpr int kReferenceUnboundedMsft = 1000038000;     // XR_MSFT_unbounded_reference_space
inline constexpr int kReferenceLocalizationMap = 1000139000;   // XR_ML_localization_map
inline constexpr int kReferenceUnboundedAndroid = 1000467000;  // XR_ANDROID_unbounded_...

// xrLocateSpaces: 1.1, XR_KHR_locate_spaces.
inline constexpr int kTypeSpaceVelocities = 1000471002;

struct SpacesLocateInfo {
  XrStructureType type;
  const void* next;
  XrSpace baseSpace;
  XrTime time;
  std::uint32_t spaceCount;
  const XrSpace* spaces;
};

struct SpaceLocationData {
  XrSpaceLocationFlags locationFlags;
  XrPosef pose;
};

struct SpaceLocations {
  XrStructureType type;
  void* next;
  std::uint32_t locationCount;
  SpaceLocationData* locations;
};

struct SpaceVelocityData {
  XrSpaceVelocityFlags velocityFlags;
  XrVector3f linearVelocity;
  XrVector3f angularVelocity;
};

struct SpaceVelocities {
  XrStructureType type;
  void* next;
  std::uint32_t velocityCount;
  SpaceVelocityData* velocities;
};

using LocateSpacesFunction = XrResult(XRAPI_PTR*)(XrSession session, const SpacesLocateInfo* info,
                                                  SpaceLocations* locations);

}  // namespace forewalk::openxr
