// What the application drew, back in the room: the runtime reprojects pictures to where the head
// has come to meanwhile, and has to be told where in its own world they were drawn from.
#include <memory>
#include <vector>

#include "service/openxr/entry_points.h"
#include "service/openxr/log.h"
#include "service/openxr/registry.h"

namespace forewalk::openxr {
namespace {

using Header = XrCompositionLayerBaseHeader;

/// A copy of a layer of any kind that has a pose.
union AnyLayer {
  XrCompositionLayerProjection projection;
  XrCompositionLayerQuad quad;
  XrCompositionLayerCylinderKHR cylinder;
  XrCompositionLayerCubeKHR cube;
  XrCompositionLayerEquirectKHR equirect;
  XrCompositionLayerEquirect2KHR equirect2;
};

/// The copies of one frame. Never moves what it handed out.
struct Copies {
  std::vector<const Header*> layers;
  std::vector<AnyLayer> bodies;
  std::vector<XrCompositionLayerProjectionView> views;
  std::vector<XrCompositionLayerColorScaleBiasKHR> tints;

  void clearFor(const XrFrameEndInfo& info) {
    std::size_t viewCount = 0;
    for (std::uint32_t i = 0; i < info.layerCount; ++i) {
      const Header* layer = info.layers[i];
      if (layer == nullptr || layer->type != XR_TYPE_COMPOSITION_LAYER_PROJECTION) continue;
      viewCount += reinterpret_cast<const XrCompositionLayerProjection*>(layer)->viewCount;
    }
    layers.clear();
    bodies.clear();
    views.clear();
    tints.clear();
    layers.reserve(info.layerCount);
    bodies.reserve(info.layerCount);
    tints.reserve(info.layerCount);
    views.reserve(viewCount);
  }
};

template <typename Layer>
const Header* copied(Copies& copies, Layer AnyLayer::*member, const Header* layer,
                     const Rigid& toRoom) {
  AnyLayer& body = copies.bodies.emplace_back();
  Layer& copy = body.*member = *reinterpret_cast<const Layer*>(layer);
  copy.pose = poseOf(toRoom * rigidOf(copy.pose));
  return reinterpret_cast<const Header*>(&copy);
}

const Header* copiedCube(Copies& copies, const Header* layer, const Rigid& toRoom) {
  AnyLayer& body = copies.bodies.emplace_back();
  XrCompositionLayerCubeKHR& copy = body.cube =
      *reinterpret_cast<const XrCompositionLayerCubeKHR*>(layer);
  copy.orientation = quaternionOf(toRoom.turn * turnOf(copy.orientation));
  return reinterpret_cast<const Header*>(&copy);
}

bool hasTint(const void* chain) {
  for (auto* at = static_cast<const XrBaseInStructure*>(chain); at != nullptr; at = at->next) {
    if (at->type == XR_TYPE_COMPOSITION_LAYER_COLOR_SCALE_BIAS_KHR) return true;
  }
  return false;
}

/// With `toRoom` or a tint, or both.
const Header* copiedProjection(Copies& copies, const Header* layer,
                               const std::optional<Rigid>& toRoom, const glm::vec3* tint) {
  AnyLayer& body = copies.bodies.emplace_back();
  XrCompositionLayerProjection& copy = body.projection =
      *reinterpret_cast<const XrCompositionLayerProjection*>(layer);
  if (toRoom && copy.views != nullptr) {
    const std::size_t first = copies.views.size();
    for (std::uint32_t i = 0; i < copy.viewCount; ++i) {
      copies.views.push_back(copy.views[i]);
      XrPosef& pose = copies.views.back().pose;
      pose = poseOf(*toRoom * rigidOf(pose));
    }
    copy.views = copies.views.data() + first;
  }
  if (tint != nullptr && !hasTint(copy.next)) {
    copies.tints.push_back({XR_TYPE_COMPOSITION_LAYER_COLOR_SCALE_BIAS_KHR,
                            copy.next,
                            {tint->x, tint->y, tint->z, 1.0f},
                            {0.0f, 0.0f, 0.0f, 0.0f}});
    copy.next = &copies.tints.back();
  }
  return reinterpret_cast<const Header*>(&copy);
}

const Header* inRoom(Copies& copies, const Header* layer, const std::optional<Rigid>& toRoom,
                     const glm::vec3* tint) {
  if (layer == nullptr) return layer;
  if (layer->type == XR_TYPE_COMPOSITION_LAYER_PROJECTION) {
    if (!toRoom && tint == nullptr) return layer;
    return copiedProjection(copies, layer, toRoom, tint);
  }
  if (!toRoom) return layer;
  switch (layer->type) {
    case XR_TYPE_COMPOSITION_LAYER_QUAD:
      return copied(copies, &AnyLayer::quad, layer, *toRoom);
    case XR_TYPE_COMPOSITION_LAYER_CYLINDER_KHR:
      return copied(copies, &AnyLayer::cylinder, layer, *toRoom);
    case XR_TYPE_COMPOSITION_LAYER_EQUIRECT_KHR:
      return copied(copies, &AnyLayer::equirect, layer, *toRoom);
    case XR_TYPE_COMPOSITION_LAYER_EQUIRECT2_KHR:
      return copied(copies, &AnyLayer::equirect2, layer, *toRoom);
    case XR_TYPE_COMPOSITION_LAYER_CUBE_KHR:
      return copiedCube(copies, layer, *toRoom);
    default:
      return layer;  // passthrough, and what we do not know
  }
}

}  // namespace

XrResult XRAPI_CALL endFrame(XrSession handle, const XrFrameEndInfo* info) {
  return guarded([&] {
    Registry& registry = Registry::instance();
    const auto session = registry.find(handle);
    const auto instance = session ? session->instance : registry.latest();
    if (!instance) return XR_ERROR_HANDLE_INVALID;
    if (!session || !session->redirected || info == nullptr || info->layers == nullptr) {
      return instance->next.endFrame(handle, info);
    }
    const RedirectedSession& redirected = *session->redirected;
    const bool signals = instance->tints && redirected.signals(info->displayTime);
    const glm::vec3* tint = signals ? &redirected.config().resetTint : nullptr;
    // Drawing threads end frames for as long as they live: their copies grow once.
    static thread_local Copies copies;
    copies.clearFor(*info);
    for (std::uint32_t i = 0; i < info->layerCount; ++i) {
      const Header* layer = info->layers[i];
      std::optional<Rigid> toRoom;
      if (layer != nullptr) {
        const auto space = registry.find(layer->space);
        const auto correction =
            redirected.bodyCorrection(space ? space->space : AppSpace{}, info->displayTime);
        if (correction) toRoom = inverse(*correction);
      }
      copies.layers.push_back(inRoom(copies, layer, toRoom, tint));
    }
    XrFrameEndInfo changed = *info;
    changed.layers = copies.layers.data();
    const XrResult result = instance->next.endFrame(handle, &changed);
    if (result != XR_ERROR_VALIDATION_FAILURE || copies.tints.empty()) return result;
    // The validation layer of 1.0.20 takes the tint for a mistake. The picture matters more.
    instance->tints = false;
    say("what comes after this layer refuses pictures with a tint; resets are not shown any more.");
    return endFrame(handle, info);
  });
}

}  // namespace forewalk::openxr
