// Every reactive controller that forewalk brings along; what each does is in README.md beside this
// file. The ones that plan on the prediction graph are in rdw/predictive.h.
#pragma once

#include <memory>

#include "rdw/controller.h"

namespace forewalk::rdw {

std::unique_ptr<Controller> makeNoController();        ///< none
std::unique_ptr<Controller> makeS2MT(bool centre);     ///< s2mt; with the centre: s2mt+c
std::unique_ptr<Controller> makeZigzag();              ///< zigzag
std::unique_ptr<Controller> makeP2R();                 ///< p2r
std::unique_ptr<Controller> makeMessinger();           ///< messinger
std::unique_ptr<Controller> makeDynamicApf();          ///< dynamic-apf
std::unique_ptr<Controller> makePassiveHaptics();      ///< haptics
std::unique_ptr<Controller> makeArc();                 ///< arc
std::unique_ptr<Controller> makeVisibilityPolygons();  ///< visibility

}  // namespace forewalk::rdw
