// The layer as the loader meets it: negotiation, the chain of instances, and which functions it
// stands in front of.
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "service/openxr/config.h"
#include "service/openxr/entry_points.h"
#include "service/openxr/log.h"
#include "service/openxr/registry.h"

namespace forewalk::openxr {
namespace {

constexpr const char* kTintExtension = XR_KHR_COMPOSITION_LAYER_COLOR_SCALE_BIAS_EXTENSION_NAME;

XrResult XRAPI_CALL getInstanceProcAddr(XrInstance handle, const char* name,
                                        PFN_xrVoidFunction* function);

struct EntryPoint {
  std::string_view name;
  PFN_xrVoidFunction function;
};

template <typename Function>
EntryPoint entry(std::string_view name, Function* function) {
  return {name, reinterpret_cast<PFN_xrVoidFunction>(function)};
}

/// Null where the layer leaves the function alone.
PFN_xrVoidFunction ourOwn(std::string_view name) {
  static const EntryPoint kOurs[] = {
      entry("xrGetInstanceProcAddr", getInstanceProcAddr),
      entry("xrDestroyInstance", destroyInstance),
      entry("xrPollEvent", pollEvent),
      entry("xrCreateSession", createSession),
      entry("xrDestroySession", destroySession),
      entry("xrBeginSession", beginSession),
      entry("xrCreateReferenceSpace", createReferenceSpace),
      entry("xrGetReferenceSpaceBoundsRect", getReferenceSpaceBoundsRect),
      entry("xrCreateActionSpace", createActionSpace),
      entry("xrDestroySpace", destroySpace),
      entry("xrLocateSpace", locateSpace),
      entry("xrLocateSpaces", locateSpaces),
      entry("xrLocateSpacesKHR", locateSpacesKhr),
      entry("xrLocateViews", locateViews),
      entry("xrLocateHandJointsEXT", locateHandJoints),
      entry("xrWaitFrame", waitFrame),
      entry("xrEndFrame", endFrame),
  };
  const auto found = std::find_if(std::begin(kOurs), std::end(kOurs),
                                  [&](const EntryPoint& ours) { return ours.name == name; });
  return found == std::end(kOurs) ? nullptr : found->function;
}

/// The configuration that the environment names; null, and a line that says why, where poses are to
/// be passed on unchanged.
std::unique_ptr<const LayerConfig> configFor(const XrInstanceCreateInfo& info) {
  const char* file = std::getenv("FOREWALK_OPENXR_CONFIG");
  if (file == nullptr || *file == '\0') {
    say("FOREWALK_OPENXR_CONFIG names no file; poses are passed on unchanged. Set it to a "
        "forewalk.openxr/1 file.");
    return nullptr;
  }
  auto config = loadConfig(std::filesystem::path(file));
  if (!config) {
    say(config.error().message + " Poses are passed on unchanged.");
    return nullptr;
  }
  const char* end = std::find(std::begin(info.applicationInfo.applicationName),
                              std::end(info.applicationInfo.applicationName), '\0');
  const std::string application(info.applicationInfo.applicationName, end);
  if (!isMeant(*config, application)) {
    say(fmt::format("{}: applications does not name \"{}\"; its poses are passed on unchanged.",
                    file, application));
    return nullptr;
  }
  return std::make_unique<const LayerConfig>(std::move(*config));
}

bool wantsTint(const LayerConfig& config) { return config.resetTint != glm::vec3(1.0f); }

bool names(const XrInstanceCreateInfo& info, std::string_view extension) {
  for (std::uint32_t i = 0; i < info.enabledExtensionCount; ++i) {
    if (extension == info.enabledExtensionNames[i]) return true;
  }
  return false;
}

/// Makes the next one's instance, with the extension that tints layers where it has it.
XrResult createNext(const XrApiLayerNextInfo& next, const XrInstanceCreateInfo& info,
                    const XrApiLayerCreateInfo& layerInfo, bool wantTint, bool& tints,
                    XrInstance* instance) {
  XrApiLayerCreateInfo nextLayer = layerInfo;
  nextLayer.nextInfo = next.next;
  tints = wantTint && names(info, kTintExtension);
  if (wantTint && !tints) {
    std::vector<const char*> extensions(info.enabledExtensionNames,
                                        info.enabledExtensionNames + info.enabledExtensionCount);
    extensions.push_back(kTintExtension);
    XrInstanceCreateInfo more = info;
    more.enabledExtensionCount = static_cast<std::uint32_t>(extensions.size());
    more.enabledExtensionNames = extensions.data();
    const XrResult result = next.nextCreateApiLayerInstance(&more, &nextLayer, instance);
    if (XR_SUCCEEDED(result)) {
      tints = true;
      return result;
    }
    // It lacks the extension, or something that it lacks without us, too.
  }
  return next.nextCreateApiLayerInstance(&info, &nextLayer, instance);
}

XrResult XRAPI_CALL createInstance(const XrInstanceCreateInfo* info,
                                   const XrApiLayerCreateInfo* layerInfo, XrInstance* instance) {
  return guarded([&] {
    if (info == nullptr || layerInfo == nullptr || layerInfo->nextInfo == nullptr ||
        layerInfo->nextInfo->nextGetInstanceProcAddr == nullptr ||
        layerInfo->nextInfo->nextCreateApiLayerInstance == nullptr) {
      return XR_ERROR_INITIALIZATION_FAILED;
    }
    openLog();
    const XrApiLayerNextInfo& next = *layerInfo->nextInfo;
    auto made = std::make_shared<LayerInstance>();
    made->config = configFor(*info);
    const bool wantTint = made->config != nullptr && wantsTint(*made->config);
    bool tints = false;
    const XrResult result = createNext(next, *info, *layerInfo, wantTint, tints, instance);
    if (XR_FAILED(result)) return result;
    made->tints = tints;
    if (wantTint && !tints) {
      say(fmt::format("the runtime has no {}; resets are not shown in the picture.",
                      kTintExtension));
    }
    made->handle = *instance;
    made->next = nextOf(*instance, next.nextGetInstanceProcAddr);
    Registry::instance().add(std::move(made));
    return result;
  });
}

XrResult XRAPI_CALL getInstanceProcAddr(XrInstance handle, const char* name,
                                        PFN_xrVoidFunction* function) {
  return guarded([&] {
    const auto instance = Registry::instance().find(handle);
    if (!instance) return XR_ERROR_HANDLE_INVALID;
    const XrResult result = instance->next.getInstanceProcAddr(handle, name, function);
    // What the next one does not have, or has not been asked to enable, is nobody's.
    if (XR_FAILED(result) || *function == nullptr) return result;
    // A layer with nothing to do stays in the chain for the instance's end alone.
    const bool redirects = instance->config != nullptr;
    if (const PFN_xrVoidFunction ours = ourOwn(name);
        ours != nullptr && (redirects || std::strcmp(name, "xrDestroyInstance") == 0)) {
      *function = ours;
    }
    return result;
  });
}

}  // namespace
}  // namespace forewalk::openxr

extern "C" {

/// What the loader asks first.
__attribute__((visibility("default"))) XrResult XRAPI_CALL
xrNegotiateLoaderApiLayerInterface(const XrNegotiateLoaderInfo* loader, const char* layerName,
                                   XrNegotiateApiLayerRequest* request) {
  using namespace forewalk::openxr;
  const bool knows = loader != nullptr && layerName != nullptr && request != nullptr &&
                     loader->structType == XR_LOADER_INTERFACE_STRUCT_LOADER_INFO &&
                     loader->structVersion == XR_LOADER_INFO_STRUCT_VERSION &&
                     loader->structSize == sizeof(XrNegotiateLoaderInfo) &&
                     request->structType == XR_LOADER_INTERFACE_STRUCT_API_LAYER_REQUEST &&
                     request->structVersion == XR_API_LAYER_INFO_STRUCT_VERSION &&
                     request->structSize == sizeof(XrNegotiateApiLayerRequest) &&
                     loader->minInterfaceVersion <= XR_CURRENT_LOADER_API_LAYER_VERSION &&
                     loader->maxInterfaceVersion >= XR_CURRENT_LOADER_API_LAYER_VERSION &&
                     std::strcmp(layerName, FOREWALK_LAYER_NAME) == 0;
  if (!knows) return XR_ERROR_INITIALIZATION_FAILED;
  request->layerInterfaceVersion = XR_CURRENT_LOADER_API_LAYER_VERSION;
  request->layerApiVersion = XR_CURRENT_API_VERSION;
  request->getInstanceProcAddr = getInstanceProcAddr;
  request->createApiLayerInstance = createInstance;
  return XR_SUCCESS;
}

}  // extern "C"
